#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "files/utc_second.h"
#include "trust/ssh_key.h"

/// Signatures by `ssh-keygen -Y sign`:
/// https://github.com/openssh/openssh-portable/blob/master/PROTOCOL.sshsig
namespace runcert {

/// What a signature file claims. Nothing of it is checked.
struct SshSignature {
    SshPublicKey key{};
    std::string name_space{};  ///< what it was made for, "measurer@runcert"
    std::string hash_algorithm{};
};

/// Reads the armoured text that `ssh-keygen -Y sign` writes. `where` names it in messages. Failure
/// where it is anything else.
SshSignature parse_ssh_signature(std::string_view text, const std::string& where);

struct SshCheck {
    bool valid = false;
    std::string said{};  ///< by ssh-keygen, where it is not
};

/// Asks `ssh-keygen -Y verify` whether `signature_file` is a signature of the bytes of
/// `signed_file` by a key that the lines of `allowed_signers` allow for `principal` and
/// `name_space` at that time. Failure where there is no ssh-keygen.
SshCheck check_ssh_signature(const std::filesystem::path& signed_file,
                             const std::filesystem::path& signature_file,
                             std::string_view allowed_signers, const std::string& principal,
                             const std::string& name_space, UtcSecond time);

}  // namespace runcert
