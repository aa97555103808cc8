#include "store/base64.h"

#include <sodium.h>

#include "core/failure.h"

namespace runcert {

std::string base64(std::string_view bytes) {
    constexpr int variant = sodium_base64_VARIANT_ORIGINAL;
    std::string text(sodium_base64_encoded_len(bytes.size(), variant), '\0');
    sodium_bin2base64(text.data(), text.size(),
                      reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), variant);
    text.pop_back();  // the terminating null
    return text;
}

std::optional<std::string> decode_base64(std::string_view text) {
    std::string bytes(text.size(), '\0');
    std::size_t decoded = 0;
    const char* end = nullptr;
    if (sodium_base642bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), text.data(),
                          text.size(), nullptr, &decoded, &end,
                          sodium_base64_VARIANT_ORIGINAL) != 0 ||
        end != text.data() + text.size())
        return std::nullopt;
    bytes.resize(decoded);
    return bytes;
}

std::string base64_of_hex(std::string_view digits) {
    std::string bytes(digits.size() / 2, '\0');
    std::size_t count = 0;
    if (sodium_hex2bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), digits.data(),
                       digits.size(), nullptr, &count, nullptr) != 0 ||
        2 * count != digits.size())
        throw Failure("base64", "these are not pairs of hexadecimal digits", "Give the hash whole");
    return base64(bytes);
}

}  // namespace runcert
