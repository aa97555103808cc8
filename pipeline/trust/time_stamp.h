#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "store/utc_second.h"

/// Time stamps of RFC 3161, by the program openssl: an authority signs the hash of a file together
/// with the time at which it saw it.

namespace runcert {

/// What a query asks for, and what a stamp is for.
struct StampedHash {
    std::string algorithm{};  ///< "sha512"
    std::string imprint{};    ///< the hash, lower-case hexadecimal
    std::string nonce{};      ///< ties a reply to its query; empty where there is none

    bool operator==(const StampedHash&) const = default;
};

/// The bytes of a new query for a file: SHA-512, with a random nonce, asking for the authority's
/// certificate. Failure where there is no openssl.
std::string make_time_stamp_query(const std::filesystem::path& file);

/// What a query asks for. Failure where the file is none.
StampedHash read_time_stamp_query(const std::filesystem::path& query);

struct TimeStamp {
    StampedHash hash{};
    UtcSecond time{};  ///< whole seconds; fractions are cut off
};

/// What the token in a reply says. Nothing of it is checked. Failure where the file is no reply, or
/// one that refuses: it then says what the authority said.
TimeStamp read_time_stamp_reply(const std::filesystem::path& reply);

struct TimeStampCheck {
    bool valid = false;
    UtcSecond time{};      ///< that the stamp states
    std::string reason{};  ///< why it is not valid
};

/// Checks that a reply is a stamp of that very file by an authority certified under one of `cas`
/// (PEM files), as they were at the stamp's own time. Whether a certificate was revoked is not
/// looked at. A reply that cannot be read is a finding. Failure where there is no openssl, and
/// where a file of `cas` holds no certificate.
TimeStampCheck check_time_stamp(const std::filesystem::path& file,
                                const std::filesystem::path& reply,
                                const std::vector<std::filesystem::path>& cas);

/// What a token says, from the output of `openssl ts -text`; nothing where it has no time or hash.
std::optional<TimeStamp> stamp_from_words(std::string_view text);

/// The line of openssl's error output that says what was wrong, fit to be shown.
std::string said_by_openssl(std::string_view errors);

}  // namespace runcert
