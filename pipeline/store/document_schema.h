#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "store/yaml_input.h"

namespace runcert {

/// Where the value of a field of an input comes from, and what depends on it.
struct FieldOrigin {
    std::string origin;                ///< "observed", "handed_in", "claimed"
    std::vector<std::string> changes;  ///< "speed", "outcome", ...; empty for nothing
    std::vector<std::string> decides;  ///< computations of clauses that rest on it
    std::string clause;  ///< in which an official answers for it where no clause rests on it
};

/// Whether all of a document must be there. Of one that is still being written nothing is missed.
enum class Completeness { whole, begun };

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
    /// How somebody who writes an input is asked for it, a sentence why, and what a line of it
    /// looks like that cannot stand as it is; empty where it is not asked for.
    std::string question{}, why{}, example{};
    bool always_asked = false;            ///< whatever the recordings are
    bool names_file = false;              ///< its texts are names of files
    bool apart = false;                   ///< `validate` leaves it to `validate_part`
    std::optional<FieldOrigin> origin{};  ///< its own; else that of what it is in holds
    /// Of a map with the key `file`: what the series there gives (`SeriesQuantities`).
    std::vector<std::string> series{};
    bool before_rule =
        false;  ///< one that is stated counts before the rule's own, its default after
    /// The stages that read it; where it does not say, those of what it is in.
    std::optional<std::vector<std::string>> read_by{};
};

/// The field table of one product or input: `schemas/NAME/v1.yaml`, the normative text, from which
/// documents are checked.
class DocumentSchema {
  public:
    /// Reads a table that was parsed (compiled into the program; a fault in it is a Failure). The
    /// fields of `common`, if given, are added in front.
    static DocumentSchema read(const YamlNode& table, const std::string& where,
                               const DocumentSchema* common = nullptr);
    /// The same of a table's text.
    static DocumentSchema parse(std::string_view text, const std::string& where,
                                const DocumentSchema* common = nullptr);

    const std::string& name() const { return name_; }
    const std::string& version() const { return version_; }
    const std::vector<FieldRule>& fields() const { return fields_; }
    /// The parsed text, for what is not a field table in it.
    const YamlValue& source() const { return source_; }

    /// The rule of that path, or null.
    const FieldRule* find(std::string_view path) const;

    /// The origin of that field: its own declaration, or that of the nearest field around it. Null
    /// where none declares it.
    const FieldOrigin* origin_of(std::string_view path) const;

    /// Whether that stage reads that field, by its own declaration or that of the nearest field
    /// around it; false where none declares it.
    bool is_read_by(std::string_view path, std::string_view stage) const;

    /// The part of a valid document that a stage reads, with its places in the document. Lists of
    /// maps keep their number of items.
    YamlNode part_read_by(const YamlValue& document, std::string_view stage) const;

    /// Checks every key, type, range and required field of a document, and its rules across keys.
    /// The first deviation is a Failure with file, line and column; an unknown key's names the
    /// nearest known one.
    void validate(const YamlValue& document, Completeness completeness = Completeness::whole) const;
    /// Checks the fields of one map of a document, which stands at that path and is `apart`: what
    /// is wrong with it is nothing wrong with the rest.
    void validate_part(const YamlValue& map, const std::string& path) const;

    /// The table as text, one field a line, for help.
    std::string field_table() const;

  private:
    class Validation;
    void add(FieldRule rule);
    void check_rules(const YamlValue& document, Completeness completeness) const;
    std::vector<std::string_view> children(std::string_view path) const;
    bool has_part(const YamlNode& node, const std::string& path, std::string_view stage) const;
    void add_part(const YamlNode& node, const std::string& path, std::string_view stage,
                  YamlBuilder& builder) const;

    std::string name_;
    std::string version_;
    std::vector<FieldRule> fields_;
    std::map<std::string, std::size_t, std::less<>> by_path_;
    /// Of each path, the fields that are keys of the map there.
    std::map<std::string, std::vector<std::size_t>, std::less<>> children_;
    YamlValue source_{YamlNode(), ""};
};

/// Every value that a document has at a path of its field table ("receivers[].imu.file"), in the
/// order of the document; what is missing or null is none.
std::vector<YamlValue> values_at(const YamlValue& document, std::string_view path);

}  // namespace runcert
