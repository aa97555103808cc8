#include "files/signature_text.h"

#include <sodium.h>

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>

#include "core/failure.h"
#include "files/base64.h"

namespace runcert::signature_text {
namespace {

/// The first code point of a UTF-8 text, taken off it. Nothing where it is not UTF-8: overlong
/// forms, surrogates and values above U+10FFFF are not.
std::optional<std::uint32_t> take_code_point(std::string_view& text) {
    const auto first = static_cast<unsigned char>(text.front());
    const std::size_t length = first < 0x80   ? 1U
                               : first < 0xC2 ? 0U
                               : first < 0xE0 ? 2U
                               : first < 0xF0 ? 3U
                               : first < 0xF5 ? 4U
                                              : 0U;
    if (length == 0 || text.size() < length) return std::nullopt;
    constexpr std::array<std::uint32_t, 5> first_mask{0, 0x7F, 0x1F, 0x0F, 0x07};
    constexpr std::array<std::uint32_t, 5> smallest{0, 0, 0x80, 0x800, 0x10000};
    std::uint32_t value = first & first_mask.at(length);
    for (const char next : text.substr(1, length - 1)) {
        const auto byte = static_cast<unsigned char>(next);
        if ((byte & 0xC0U) != 0x80U) return std::nullopt;
        value = (value << 6U) | (byte & 0x3FU);
    }
    if (value < smallest.at(length) || value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF))
        return std::nullopt;
    text.remove_prefix(length);
    return value;
}

bool is_printable(std::uint32_t code_point) {
    const bool control = code_point < 0x20 || (code_point >= 0x7F && code_point < 0xA0);
    // U+2028 and U+2029 separate lines; the others reorder or hide what is printed around them.
    const bool reorders = (code_point >= 0x2028 && code_point <= 0x202E) ||
                          (code_point >= 0x2066 && code_point <= 0x2069) || code_point == 0x200E ||
                          code_point == 0x200F || code_point == 0x061C || code_point == 0xFEFF;
    return code_point == '\t' || (!control && !reorders);
}

}  // namespace

void start_libsodium() {
    // A negative status means that the system has no random source.
    if (sodium_init() < 0)
        throw Failure("libsodium", "cannot start the cryptographic library",
                      "Check that the system has a random source (/dev/urandom)");
}

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        std::string_view line = text.substr(0, end);
        if (line.ends_with('\r')) line.remove_suffix(1);
        lines.push_back(line);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    while (!lines.empty() && lines.back().empty())
        lines.pop_back();
    return lines;
}

bool is_printable_line(std::string_view text) {
    while (!text.empty()) {
        const std::optional<std::uint32_t> code_point = take_code_point(text);
        if (!code_point || !is_printable(*code_point)) return false;
    }
    return true;
}

std::string base64_of(const unsigned char* bytes, std::size_t count) {
    return base64({reinterpret_cast<const char*>(bytes), count});
}

std::string bytes_of_base64(std::string_view line, std::size_t count, const std::string& what,
                            const std::string& where) {
    const std::string remedy = "Use the file as it was made, whole and unchanged";
    std::string bytes(line.size(), '\0');
    std::size_t decoded = 0;
    const char* end = nullptr;
    if (sodium_base642bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), line.data(),
                          line.size(), nullptr, &decoded, &end,
                          sodium_base64_VARIANT_ORIGINAL) != 0 ||
        end != line.data() + line.size())
        throw Failure(where, "the line of " + what + " is not base64", remedy);
    if (decoded != count)
        throw Failure(where,
                      "the line of " + what + " holds " + std::to_string(decoded) +
                          " bytes where " + std::to_string(count) + " are expected",
                      remedy);
    bytes.resize(decoded);
    return bytes;
}

}  // namespace runcert::signature_text
