#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "schemas/common/header.h"

namespace runcert {

/// Rounds every real number of a document to the decimals of the field table.
void round_to_table(nlohmann::ordered_json& document, const DocumentSchema& schema);

/// Reads a YAML product: parses it, and checks its version and every field against `schema`.
YamlValue read_document(std::string_view text, const std::string& where,
                        const DocumentSchema& schema);

/// The checks of `read_document`, for a document that is not read from text.
void check_document(const YamlValue& document, const DocumentSchema& schema);

/// Parses a file written by a person, whose first line names its schema ("attempt/1.0"). Failure,
/// with its place, where it names another. Failure also where a text in it
/// contains a character that cannot be shown (hidden_character), literally or escaped.
YamlValue parse_input(std::string_view text, const std::string& where,
                      const DocumentSchema& schema);

/// Does what `parse_input` does, and checks every field against `schema`.
YamlValue read_input(std::string_view text, const std::string& where, const DocumentSchema& schema,
                     Completeness completeness = Completeness::whole);

/// Writes a YAML product: sets its `schema`, rounds to the field table and checks the whole
/// document against the table. A deviation is a bug in the program.
std::string write_document(nlohmann::ordered_json document, const DocumentSchema& schema);

}  // namespace runcert
