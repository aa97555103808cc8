#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "days/day_attempts.h"
#include "schemas/day/day.h"

// The parts of `read_day`, which finds the attempts of a day.

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

/// The schema that a YAML text names: "attempt/1.0", "day/1.0"; empty if it names none or cannot
/// be parsed. Quick: parsed only where the schema does not stand on a line of its own.
std::string written_schema(std::string_view text);

/// An id made of a name, at most 64 characters: letters, digits, - and _ stay, every other
/// character (of UTF-8) becomes -, and none of these stands in front. "run" where nothing is left.
std::string id_from_name(std::string_view name);

/// An attempt of a list in the making.
struct ListedAttempt {
    GivenAttempt attempt;
    bool has_id = true;  ///< its id was read or made; else it is a label
};

/// An attempt that has a file of its own; the whole of it is read and checked only where its id
/// does not stand on a line of its own. Refused if it cannot be read.
ListedAttempt attempt_of_file(const std::filesystem::path& file, const std::string& source);

/// A list in the making, and what people should know of it.
struct ListedAttempts {
    std::vector<ListedAttempt> attempts = {};
    std::vector<std::string> notes = {};
};

/// The attempts of a day file, one for each entry. What is wrong with an entry refuses it, in the
/// words and with the place of the day file.
ListedAttempts attempts_of_day(const DayFile& day, const std::filesystem::path& file);

}  // namespace runcert
