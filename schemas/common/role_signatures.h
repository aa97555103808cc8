#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "store/yaml_input.h"

namespace runcert {

/// Whether a text can be a role: 1 to 64 letters, digits, - and _ (ASCII).
bool is_role(std::string_view text);

/// Reads a role from a document. Failure at its place where the text is not a role.
std::string read_role(const YamlValue& value);

/// The number of signatures of one role that a report needs.
struct RoleSignatures {
    std::string role;
    std::int64_t count = 1;  ///< each with its own key

    bool operator==(const RoleSignatures&) const = default;
};

/// The list `signatures` of an attempt or a profile. Empty where it is absent. Failure at its place
/// where a role is not letters, digits, - and _, or occurs twice.
std::vector<RoleSignatures> read_role_signatures(const YamlValue& list);

/// Combines two lists, with the larger count for each role: the first list's roles in its order,
/// then the second's.
std::vector<RoleSignatures> combined(std::vector<RoleSignatures> first,
                                     const std::vector<RoleSignatures>& second);

}  // namespace runcert
