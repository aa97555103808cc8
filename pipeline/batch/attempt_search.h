#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace runcert {

/// What a folder holds of a day.
struct AttemptSearch {
    std::vector<std::string> files;  ///< attempts, relative to the folder, sorted by their bytes
    std::vector<std::string> notes;
};

/// Searches a folder, at any depth, for attempts: files *.yaml or *.yml whose schema is attempt,
/// and files named attempt.yaml whatever they hold. Hidden files and folders, run folders and `out`
/// are passed over; each folder is searched once, by whatever links it can be reached. The notes
/// say what was passed over and what could not be read.
AttemptSearch find_attempts(const std::filesystem::path& folder, const std::filesystem::path& out);

}  // namespace runcert
