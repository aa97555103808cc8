#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "trust/time_stamp.h"

// What `openssl ts -text` says of queries, replies and tokens, read. For trust/time_stamp.cpp.

namespace runcert {

/// What follows "NAME:" on the first line that begins with it; empty where there is none.
std::string value_in_words(std::string_view text, std::string_view name);

/// What a query or token is for; fields that are not there are empty.
StampedHash stamped_hash_from_words(std::string_view text);

/// What a token says; nothing where it has no time or no hash.
std::optional<TimeStamp> stamp_from_words(std::string_view text);

/// The line of openssl's errors that says what was wrong, fit to be shown.
std::string said_by_openssl(std::string_view errors);

}  // namespace runcert
