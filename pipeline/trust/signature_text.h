#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "store/base64.h"

/// What minisign's key and signature files have in common. For the sources of this folder alone.
namespace runcert::signature_text {

inline constexpr std::string_view untrusted_prefix = "untrusted comment: ";
inline constexpr std::string_view trusted_prefix = "trusted comment: ";

/// What libsodium wants to see of a text.
inline const unsigned char* data_of(std::string_view bytes) {
    return reinterpret_cast<const unsigned char*>(bytes.data());
}

/// Makes libsodium ready; every function that draws random bytes calls it first.
void start_libsodium();

/// The lines of a text, without "\n" or "\r\n" and without the empty ones at its end.
std::vector<std::string_view> lines_of(std::string_view text);

/// Base64 (RFC 4648 section 4, padded) of bytes.
inline std::string base64_of(const unsigned char* bytes, std::size_t count) {
    return base64({reinterpret_cast<const char*>(bytes), count});
}

/// The bytes that a line of base64 holds. `what` names them in the messages.
/// Failure where it is not base64, or not of `count` bytes.
std::string bytes_of_base64(std::string_view line, std::size_t count, const std::string& what,
                            const std::string& where);

}  // namespace runcert::signature_text
