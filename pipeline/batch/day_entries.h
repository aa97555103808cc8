#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "batch/day_ids.h"
#include "schemas/day/day.h"

namespace runcert {

/// An attempt that has a file of its own. Where its id does not stand in it plainly the whole is
/// read and checked. Refused where it cannot be read.
ListedAttempt attempt_of_file(const std::filesystem::path& file, const std::string& source);

/// The attempts of a list being made, and what people should know of it.
struct ListedAttempts {
    std::vector<ListedAttempt> attempts = {};
    std::vector<std::string> notes = {};
};

/// The attempts of a day file, each entry one or, where it is a pattern, one for each file that it
/// matches. What is wrong with an entry refuses it, or that one of its attempts, in the words and
/// with the place of the day file.
ListedAttempts attempts_of_day(const DayFile& day, const std::filesystem::path& file);

}  // namespace runcert
