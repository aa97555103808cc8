#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace runcert {

/// A file that an attempt's keys name.
struct NamedFile {
    std::string pointer;  ///< RFC 6901, in the keys
    std::string key;      ///< "recording"
    std::string name;
};

/// The files that an attempt's keys name, receivers' first, in their order; what is not text is
/// passed over.
std::vector<NamedFile> named_files(const nlohmann::ordered_json& keys);

/// Why a name, or pattern, cannot be that of a file inside of the day's folder, by its letters
/// alone; empty where it can.
std::string fault_of_name(const std::string& name);

/// Why a name is not that of a file in the folder, or of one outside of it by a symbolic link;
/// empty where all is well.
std::string fault_of_file(const std::filesystem::path& folder, const std::string& name);

}  // namespace runcert
