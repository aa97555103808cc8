#include "core/text.h"
#include "trust/signature.h"
#include "trust/signature_text.h"
#include "trust/ssh_key.h"

namespace runcert {

OtherKey other_key_in(std::string_view text) {
    const std::string make_one =
        "Name a secret key file (NAME.key) that runcert keygen or minisign -G made";
    const std::string_view start = trim(text.substr(0, 4096));
    const std::string_view first_word = start.substr(0, start.find(' '));
    if (start.starts_with("-----BEGIN OPENSSH PRIVATE KEY-----"))
        return {
            "an OpenSSH private key",
            "Sign with it by `ssh-keygen -Y sign -n ROLE@runcert -f KEY report.json` in the run "
            "folder, or name a key that runcert keygen made"};
    if (start.starts_with("-----BEGIN CERTIFICATE")) return {"an X.509 certificate", make_one};
    if (start.starts_with("-----BEGIN PGP")) return {"a PGP key or message", make_one};
    if (start.starts_with("-----BEGIN SSH SIGNATURE"))
        return {"an ssh signature, not a key", make_one};
    if (start.starts_with("-----BEGIN ") && start.find("PRIVATE KEY") != std::string_view::npos)
        return {"a private key in PEM form", make_one};
    if (start.starts_with("-----BEGIN ") && start.find("PUBLIC KEY") != std::string_view::npos)
        return {"a public key in PEM form", make_one};
    if (is_ssh_key_type(first_word))
        return {"a public key of OpenSSH", make_one + "; a public key cannot sign"};
    const auto lines = signature_text::lines_of(text);
    const bool signature =
        lines.size() == 4 && lines[2].starts_with(signature_text::trusted_prefix);
    if (signature) return {"a signature, not a key", make_one};
    // "RW" is how base64 of minisign's "Ed" begins; secret and public keys differ in their length.
    constexpr std::size_t public_line_length = 56;
    if (!lines.empty() && lines.size() <= 2 && lines.back().starts_with("RW") &&
        lines.back().size() == public_line_length)
        return {"a public key", make_one + "; a public key cannot sign"};
    return {};
}

}  // namespace runcert
