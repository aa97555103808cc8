#pragma once

#include <vector>

#include "schemas/common/declared.h"

namespace runcert {

/// Combines two lists, with the larger count for each role: the first list's roles in its order,
/// then the second's.
std::vector<RoleSignatures> combined(std::vector<RoleSignatures> first,
                                     const std::vector<RoleSignatures>& second);

}  // namespace runcert
