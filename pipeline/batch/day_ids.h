#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "batch/day_attempts.h"

namespace runcert {

/// An id made of a name: letters, digits, - and _ stay, every other character (of UTF-8) becomes -,
/// none of these in front, cut to 64. "run" where nothing is left.
std::string id_from_name(std::string_view name);

/// An attempt of a list being made, with whether its id is one that was read or made, or a label.
struct ListedAttempt {
    DayAttempt attempt;
    bool has_id = true;
};

/// Refuses attempts that have one id, or ids that differ in the case of letters alone, each naming
/// the others: which of them is meant nobody can know. Changes labels that an attempt is known as.
std::vector<DayAttempt> with_own_ids(std::vector<ListedAttempt> attempts);

}  // namespace runcert
