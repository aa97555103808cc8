#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "schemas/common/header.h"

namespace runcert {

/// Rounds every real number of a document to the decimals of the field table.
void round_to_table(nlohmann::ordered_json& document, const DocumentSchema& schema);

/// Reads a YAML product: parses it, checks its version and every field against `schema`, as that
/// revision had it.
YamlValue read_document(std::string_view text, const std::string& where,
                        const DocumentSchema& schema);

/// The same of a document that is not read from a text.
void check_document(const YamlValue& document, const DocumentSchema& schema);

/// Parses what a person wrote, whose first line says which schema it follows ("attempt/1.0").
/// Failure with its place where it says none that this program knows, and where a text in it holds
/// a character that cannot be shown (hidden_character), as it is or escaped.
YamlValue parse_input(std::string_view text, const std::string& where,
                      const DocumentSchema& schema);

/// The same, and checks every field against `schema`, as that revision had it.
YamlValue read_input(std::string_view text, const std::string& where, const DocumentSchema& schema);

/// Writes a YAML product: sets `schema` in it, rounds to the field table, checks the whole against
/// the table (a deviation is a fault of the program).
std::string write_document(nlohmann::ordered_json document, const DocumentSchema& schema);

/// Sets `json[key]` where there is a value.
template <class Json, class T>
void set_optional(Json& json, const char* key, const std::optional<T>& value) {
    if (value) json[key] = *value;
}

}  // namespace runcert
