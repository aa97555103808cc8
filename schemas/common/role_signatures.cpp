#include "schemas/common/role_signatures.h"

#include <algorithm>

namespace runcert {
std::vector<RoleSignatures> combined(std::vector<RoleSignatures> first,
                                     const std::vector<RoleSignatures>& second) {
    for (const RoleSignatures& one : second) {
        const auto known = std::ranges::find(first, one.role, &RoleSignatures::role);
        if (known == first.end())
            first.push_back(one);
        else
            known->count = std::max(known->count, one.count);
    }
    return first;
}

}  // namespace runcert
