#pragma once

#include <string>
#include <vector>

#include "trust/verification.h"

namespace runcert {

/// What became of one role that the report needs signatures in.
struct RoleState {
    std::string role{};
    std::size_t needed = 0;
    std::size_t there = 0;  ///< valid ones by different keys that do not count for another role
};

/// The same text for the same key, whether a signature is in minisign's or in OpenSSH's form.
std::string key_identity(const Signer& signer);

/// Gives valid signatures to the roles that need them, each key to one role, so that as many as
/// possible are filled.
std::vector<RoleState> fill_roles(const std::vector<RequiredSignatures>& required,
                                  const std::vector<Signer>& signers);

}  // namespace runcert
