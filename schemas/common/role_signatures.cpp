#include "schemas/common/role_signatures.h"

#include <algorithm>

#include "schemas/common/codec.h"

namespace runcert {
bool is_role(std::string_view text) {
    constexpr std::size_t longest = 64;
    return !text.empty() && text.size() <= longest && std::ranges::all_of(text, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_';
    });
}

std::string read_role(const YamlValue& value) {
    if (!is_role(value.text()))
        value.fail("a role is letters, digits, - and _, at most 64 of them",
                   "Write it so, \"measurer\": signatures name it");
    return value.text();
}

template <>
RoleSignatures read_members(const YamlValue& entry) {
    return {.role = read_role(entry["role"]),
            .count = entry["count"].optional_integer().value_or(1)};
}

std::vector<RoleSignatures> read_role_signatures(const YamlValue& list) {
    std::vector<RoleSignatures> needed;
    if (!list.exists()) return needed;
    for (const YamlValue& entry : list.list()) {
        auto one = read_members<RoleSignatures>(entry);
        if (std::ranges::find(needed, one.role, &RoleSignatures::role) != needed.end())
            entry["role"].fail("the role is there twice", "Give one count for it");
        needed.push_back(std::move(one));
    }
    return needed;
}

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
