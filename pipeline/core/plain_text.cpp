#include "core/plain_text.h"

#include <fmt/format.h>

#include <cstdint>

namespace runcert {
namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";

struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 1;
};

/// The first character of a text that is not empty. Nothing where it is not UTF-8.
std::optional<Character> first_character(std::string_view text) {
    const auto byte = [&](std::size_t at) {
        return static_cast<std::uint32_t>(static_cast<unsigned char>(text[at]));
    };
    const std::uint32_t lead = byte(0);
    if (lead < 0x80) return Character{lead, 1};
    const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return std::nullopt;
    std::uint32_t code = lead & (0xFFU >> (bytes + 1));
    for (std::size_t at = 1; at < bytes; ++at) {
        if ((byte(at) & 0xC0U) != 0x80U) return std::nullopt;
        code = code << 6U | (byte(at) & 0x3FU);
    }
    constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
    if (code < least[bytes] || code > 0x10FFFF || surrogate) return std::nullopt;
    return Character{code, bytes};
}

bool is_shown(std::uint32_t code) {
    const bool control = code < 0x20 || (code >= 0x7F && code < 0xA0);
    const bool separator = code == 0x2028 || code == 0x2029;
    const bool direction = code == 0x061C || code == 0x200E || code == 0x200F ||
                           (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
    const bool no_character = (code & 0xFFFEU) == 0xFFFE || (code >= 0xFDD0 && code <= 0xFDEF);
    return !control && !separator && !direction && !no_character;
}

}  // namespace

std::string plain_text(std::string_view text) {
    std::string plain;
    plain.reserve(text.size());
    while (!text.empty()) {
        const auto character = first_character(text);
        const std::size_t bytes = character ? character->bytes : 1;
        if (text.front() == '\n' || text.front() == '\r' || text.front() == '\t')
            plain += ' ';
        else if (character && is_shown(character->code))
            plain += text.substr(0, bytes);
        else
            plain += replacement;
        text.remove_prefix(bytes);
    }
    return plain;
}

std::optional<std::string> hidden_character(std::string_view text) {
    constexpr std::uint32_t byte_order_mark = 0xFEFF;
    while (!text.empty()) {
        const auto character = first_character(text);
        if (!character) return "a byte that is not UTF-8";
        const std::uint32_t code = character->code;
        if (code != '\t' && code != '\n' && (!is_shown(code) || code == byte_order_mark))
            return fmt::format("U+{:04X}", code);
        text.remove_prefix(character->bytes);
    }
    return std::nullopt;
}

bool is_printable_line(std::string_view text) {
    return text.find('\n') == std::string_view::npos && !hidden_character(text);
}

}  // namespace runcert
