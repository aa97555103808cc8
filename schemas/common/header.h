#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/gps_time.h"
#include "store/document_schema.h"
#include "store/held_json.h"

namespace runcert {

/// A file that another file was made from.
struct InputFile {
    std::string role;
    std::string file;  ///< name in the run folder
    std::string sha256;
    std::uint64_t bytes = 0;
    std::string original;  ///< the name under which it was handed in; empty if the same
};

/// An external program that a stage called.
struct CalledProgram {
    std::string name;
    std::string version;  ///< as it states; empty if it states none
    std::string sha256;   ///< of its executable file
    /// "no_network" or "limits_only" if it did not run in a sandbox, otherwise empty.
    std::string isolation = {};

    bool operator==(const CalledProgram&) const = default;
};

/// The header of every stage file: `schemas/common/v1.yaml`.
struct Header {
    std::string schema_name;
    std::string schema_version;
    std::string stage;
    std::string program_version;
    std::string source_revision;
    std::vector<CalledProgram> programs;
    std::vector<InputFile> inputs;
    HeldJson parameters = {};
    /// Other parts of the attempt that the stage used, as the attempt has them. Empty if none.
    HeldJson attempt = {};
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
