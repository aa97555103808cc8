#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/gps_time.h"
#include "schemas/common/declared.h"
#include "store/document_schema.h"
#include "store/opaque_json.h"

namespace runcert {

/// The header of every stage file: `schemas/common/v1.yaml`.
struct Header {
    std::string schema_name;
    std::string schema_version;
    std::string stage;
    std::string program_version;
    std::string source_revision;
    std::vector<CalledProgram> programs;
    std::vector<InputFile> inputs;
    OpaqueJson parameters = {};
    /// Other parts of the attempt that the stage used, as the attempt has them. Empty if none.
    OpaqueJson attempt = {};
};

/// The field table of the header, which all products share.
const DocumentSchema& header_schema();

/// The header as the first members of a document.
nlohmann::ordered_json header_json(const Header& header);

/// Reads the header from a validated document.
Header read_header(const YamlValue& document);

/// Checks that a document follows the schema `expected`, in the one version that there is of it.
/// Another schema or version is a Failure.
void check_version(const YamlValue& document, const DocumentSchema& expected);

/// A GPS time in ISO form, empty where the value is missing. Failure with the value's place.
std::optional<GpsTime> read_gps_time(const YamlValue& value);

/// A YAML value as the same JSON value. Unquoted numbers become numbers.
nlohmann::ordered_json json_from_yaml(const YamlValue& value);

/// What a product that is a document (YAML) says, without its header. Failure where it is none;
/// `where` names it.
nlohmann::ordered_json body_of(std::string_view text, const std::string& where);

}  // namespace runcert
