// The readers of public keys, signature files, secret keys, rosters and ssh signatures, each on the
// same text.

#include "core/failure.h"
#include "fuzz_target.h"
#include "trust/roster.h"
#include "trust/signature.h"
#include "trust/ssh_signature.h"

namespace runcert::fuzz {
namespace {

/// The pair of RFC 8032, section 7.1, test 1, with an id of zeros.
PublicKey published_key() {
    PublicKey key;
    key.key = {0xd7, 0x5a, 0x98, 0x01, 0x82, 0xb1, 0x0a, 0xb7, 0xd5, 0x4b, 0xfe,
               0xd3, 0xc9, 0x64, 0x07, 0x3a, 0x0e, 0xe1, 0x72, 0xf3, 0xda, 0xa6,
               0x23, 0x25, 0xaf, 0x02, 0x1a, 0x68, 0xf7, 0x07, 0x51, 0x1a};
    return key;
}

void read_public_key(std::string_view bytes) {
    const PublicKey key = parse_public_key(bytes, "key.pub");
    require(parse_public_key(public_key_file(key), "key.pub") == key,
            "a public key written and read again: equal");
}

/// Without a password: deriving a key from one takes seconds, by design.
void read_secret_key(std::string_view bytes) {
    const bool encrypted = secret_key_is_encrypted(bytes);
    const SecretKey key = parse_secret_key(bytes, std::nullopt, "key.key");
    require(!encrypted, "an encrypted key needs a password");
    const std::string text = secret_key_file({public_key_of(key), key}, std::nullopt);
    require(parse_secret_key(text, std::nullopt, "key.key").bytes() == key.bytes(),
            "a secret key written and read again: equal");
}

void read_signature(std::string_view bytes) {
    const SignatureCheck check =
        check_signature("message", bytes, published_key(), "report.json.minisig");
    require(check.valid == check.reason.empty(), "a reason where it is not valid");
    require(check.valid || check.trusted_comment.empty(), "no comment that nobody vouches for");
}

void read_roster(std::string_view bytes) {
    const Roster roster = parse_roster(bytes, "roster");
    require(!roster.entries.empty(), "a roster without keys is refused");
    for (const RosterEntry& entry : roster.entries) {
        const Roster alone = parse_roster("* " + ssh_key_text(entry.key) + "\n", "roster");
        require(alone.entries.front().key == entry.key, "a key written and read again: equal");
        (void)entry.allows("measurer");
    }
}

void read_ssh_signature(std::string_view bytes) {
    const SshSignature signature = parse_ssh_signature(bytes, "report.json.sig");
    require(is_ssh_key_type(signature.key.type), "a key of a type that is known");
}

}  // namespace

void read_input(std::string_view bytes) {
    for (const auto read : {read_public_key, read_secret_key, read_roster, read_ssh_signature})
        try {
            read(bytes);
        } catch (const Failure&) {
        }
    read_signature(bytes);
}

}  // namespace runcert::fuzz
