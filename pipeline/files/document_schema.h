#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/yaml_input.h"

namespace runcert {

/// One line of a schema's field table.
struct FieldRule {
    std::string path;                  ///< "window.start_time_s", "profiles[].profile", "map.*"
    std::vector<std::string> types{};  ///< of text, integer, real, boolean, map, list, any
    std::string unit{};
    bool required = false;
    std::vector<std::string> values{};  ///< the only values allowed; empty for no such list
    std::optional<double> minimum{};
    std::optional<double> maximum{};
    int decimals = 6;  ///< of a real, as written by the program
    YamlValue default_value;
    std::string description{};
};

/// The field table of one product or input: `schemas/NAME/v1.yaml`, the normative text, from which
/// documents are checked.
class DocumentSchema {
  public:
    /// Parses a table's text (compiled into the program; a fault in it is a Failure). The fields of
    /// `common`, if given, are added in front.
    static DocumentSchema parse(std::string_view text, const std::string& where,
                                const DocumentSchema* common = nullptr);

    const std::string& name() const { return name_; }
    const std::string& version() const { return version_; }
    const std::vector<FieldRule>& fields() const { return fields_; }
    /// The parsed text, for what is not a field table in it.
    const YamlValue& source() const { return source_; }

    /// The rule of that path, or null.
    const FieldRule* find(std::string_view path) const;

    /// Checks every key, type, range and required field of a document. The first deviation is a
    /// Failure with file, line and column; an unknown key's names the nearest known one. Keys
    /// that are unknown are passed over where `newer_revision` says that the document follows a
    /// later revision of the same model.
    void validate(const YamlValue& document, bool newer_revision = false) const;

    /// The table as text, one field a line, for help.
    std::string field_table() const;

  private:
    void validate_node(const YamlValue& value, const std::string& path, bool newer) const;
    void validate_map(const YamlValue& value, const std::string& path, bool newer) const;
    std::vector<std::string_view> children(const std::string& path) const;

    std::string name_;
    std::string version_;
    std::vector<FieldRule> fields_;
    YamlValue source_{YAML::Node(), ""};
};

}  // namespace runcert
