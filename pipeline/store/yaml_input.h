#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "store/yaml_node.h"

namespace runcert {

/// Parses one YAML document. Refused with line and column: what is not YAML or not UTF-8 text, two
/// equal keys in one map, keys that are not text, anchors and aliases, tags (but !!map, !!seq and
/// astropy's !!omap), control characters, nesting deeper than 32, more than one document.
YamlNode parse_yaml(std::string_view text, const std::string& where);

/// What to do where a file that the program wrote is another than it writes.
inline constexpr const char* take_the_original =
    "The file is not as the program writes it; take the original, or run the stage again";

/// "file:line:column" of a node, for messages; "file" where the node has no place.
std::string yaml_place(const std::string& where, const YamlNode& node);

/// One value in a document, that knows its file and its path and reads itself strictly.
///
/// Every accessor throws a Failure that names file, line, column and path if the value is missing
/// or of another type: a quoted number is text, `yes` is no boolean.
class YamlValue {
  public:
    YamlValue(YamlNode node, std::string where, std::string path = {});

    /// The member of that name; `exists()` is false where there is none or it is null.
    YamlValue operator[](std::string_view key) const;
    bool exists() const { return !node_.is_null(); }
    bool is_map() const { return node_.is_map(); }
    bool is_list() const { return node_.is_list(); }

    std::string text() const;
    double real() const;
    std::int64_t integer() const;
    bool boolean() const;
    std::vector<YamlValue> list() const;
    std::vector<std::string> keys() const;

    std::string text_or(std::string fallback) const { return exists() ? text() : fallback; }
    std::optional<double> optional_real() const;
    std::optional<std::int64_t> optional_integer() const;

    const std::string& path() const { return path_; }
    const YamlNode& node() const { return node_; }
    const std::string& where() const { return *where_; }
    /// "file:line:column".
    std::string place() const { return yaml_place(*where_, node_); }
    [[noreturn]] void fail(const std::string& what, const std::string& remedy) const;

  private:
    YamlValue(YamlNode node, std::shared_ptr<const std::string> where, std::string path);
    std::string_view scalar(const char* expected) const;

    YamlNode node_;
    std::shared_ptr<const std::string> where_;
    std::string path_;
};

}  // namespace runcert
