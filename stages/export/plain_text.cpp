#include "stages/export/plain_text.h"

#include <cstdint>
#include <optional>

namespace runcert {
namespace {

constexpr std::string_view replacement = "\xef\xbf\xbd";  // U+FFFD

struct CodePoint {
    char32_t value = 0;
    std::size_t bytes = 1;
};

/// The first code point; nothing where the bytes are not UTF-8 (RFC 3629).
std::optional<CodePoint> first_code_point(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char lead = byte(0);
    if (lead < 0x80) return CodePoint{lead, 1};
    const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return std::nullopt;
    char32_t value = lead & (0x7fu >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return std::nullopt;
        value = value << 6 | (byte(i) & 0x3fu);
    }
    const char32_t least = bytes == 2 ? 0x80 : bytes == 3 ? 0x800 : 0x10000;
    if (value < least || value > 0x10ffff || (value >= 0xd800 && value <= 0xdfff))
        return std::nullopt;
    return CodePoint{value, bytes};
}

bool turns_writing(char32_t c) {
    return c == 0x61c || c == 0x200e || c == 0x200f || (c >= 0x202a && c <= 0x202e) ||
           (c >= 0x2066 && c <= 0x2069);
}

bool is_control(char32_t c) {
    return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x2028 || c == 0x2029 || c == 0xfffe ||
           c == 0xffff;
}

}  // namespace

std::string plain_text(std::string_view text) {
    std::string plain;
    while (!text.empty()) {
        const auto point = first_code_point(text);
        const std::size_t bytes = point ? point->bytes : 1;
        if (point && (point->value == '\n' || point->value == '\t'))
            plain += ' ';
        else if (!point || turns_writing(point->value) || is_control(point->value))
            plain += replacement;
        else
            plain += text.substr(0, bytes);
        text.remove_prefix(bytes);
    }
    return plain;
}

std::string html_text(std::string_view text) {
    std::string html;
    for (const char c : plain_text(text)) {
        switch (c) {
            case '&':
                html += "&amp;";
                break;
            case '<':
                html += "&lt;";
                break;
            case '>':
                html += "&gt;";
                break;
            case '"':
                html += "&quot;";
                break;
            case '\'':
                html += "&#39;";
                break;
            default:
                html += c;
        }
    }
    return html;
}

}  // namespace runcert
