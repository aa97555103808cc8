#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "store/atomic_file.h"
#include "store/process.h"
#include "store/yaml_input.h"

namespace runcert::chain {

namespace fs = std::filesystem;

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define RUNCERT_ADDRESS_SANITIZER  // as clang says it
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(RUNCERT_ADDRESS_SANITIZER)
inline constexpr double slower = 10.0;  ///< with the sanitizers, in time and memory
#else
inline constexpr double slower = 1.0;
#endif

inline const fs::path examples = fs::path(RUNCERT_SOURCE_DIR) / "examples";

using Environment = std::vector<std::pair<std::string, std::string>>;

/// Runs `runcert` with these arguments.
inline ProcessResult runcert(std::vector<std::string> arguments, const Environment& more = {}) {
    arguments.insert(arguments.begin(), RUNCERT_PROGRAMS "/runcert");
    return run_process(arguments, {.environment = more});
}

inline ProcessResult certify(const fs::path& attempt, const fs::path& out,
                             std::vector<std::string> more = {}, const Environment& env = {}) {
    std::vector<std::string> arguments{"certify", attempt.string(), "--out", out.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runcert(arguments, env);
}

/// Name and bytes of every file of a folder.
inline std::map<std::string, std::string> contents_of(const fs::path& folder) {
    std::map<std::string, std::string> contents;
    if (!fs::exists(folder)) return contents;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            contents[fs::relative(entry.path(), folder).string()] = read_file(entry.path());
    return contents;
}

inline YamlValue read_yaml(const fs::path& file) {
    return {parse_yaml(read_file(file), file.string()), file.string()};
}

/// Puts a recording beside an attempt, which can name none outside of its folder, and returns its
/// name.
inline std::string bring(const fs::path& recording, const fs::path& folder) {
    fs::copy_file(recording, folder / recording.filename(), fs::copy_options::overwrite_existing);
    return recording.filename().string();
}

/// The folder of recordings named by RUNCERT_DATA, where it is set.
inline std::optional<fs::path> recordings() {
    const char* folder = std::getenv("RUNCERT_DATA");
    if (folder == nullptr || !fs::is_directory(folder)) return std::nullopt;
    return fs::absolute(folder);
}

}  // namespace runcert::chain
