#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace runcert {

/// Base64 of bytes (RFC 4648 section 4, padded), on one line.
std::string base64(std::string_view bytes);

/// The same of bytes that are given in hexadecimal digits, as of a hash. Failure where they are
/// not.
std::string base64_of_hex(std::string_view digits);

/// The bytes that base64 holds (padded); nothing where it is not base64.
std::optional<std::string> decode_base64(std::string_view text);

}  // namespace runcert
