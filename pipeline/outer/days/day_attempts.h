#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "make/given_attempt.h"

namespace runcert {

struct Day {
    /// Of letters, digits, - and _: the day file's id, else made of the name of the folder.
    std::string name;
    std::vector<GivenAttempt> attempts;
    std::vector<std::string> notes;  ///< what people should know of the list, each a sentence
};

/// Lists the attempts of a day. `given` is one folder (its `day.yaml`, where that follows the
/// schema day; else every attempt in it, at any depth), one day file, or attempt files; `out` is
/// the folder of the results, which is not searched. The list is in the order of the day file, else
/// of the bytes of the paths.
///
/// What is wrong with one attempt is in its `refused`: a file that cannot be read, an entry of the
/// day file that no attempt can be made of, an id that two attempts have (regardless of case, as on
/// some file systems). An attempt's own file is read only as far as its id needs: the caller must
/// compare the id that `read_attempt` finds. Failure if there is no day: nothing given, no
/// attempt found, a day file that is not one, the results' folder being the day's own.
Day read_day(const std::vector<std::filesystem::path>& given, const std::filesystem::path& out);

}  // namespace runcert
