#include "core/prose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace runcert {
namespace {

bool begins_character(char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
}

/// The number of bytes in the first `count` characters.
std::size_t bytes_of(std::string_view text, std::size_t count) {
    std::size_t at = 0;
    while (at < text.size()) {
        if (begins_character(text[at]) && count-- == 0) break;
        ++at;
    }
    return at;
}

std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words{""};
    for (const char c : plain_text(text)) {
        if (c == ' ')
            words.emplace_back();
        else
            words.back() += c;
    }
    std::erase(words, "");
    return words;
}

}  // namespace

std::size_t characters_in(std::string_view text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, begins_character));
}

std::string wrapped(std::string_view text, std::size_t indent, std::size_t used,
                    std::size_t columns) {
    std::string lines;
    const auto begin_line = [&] {
        lines += '\n';
        lines.append(indent, ' ');
        used = indent;
    };
    bool first_word = true;
    for (const std::string& whole : words_of(text)) {
        std::string_view word = whole;
        if (!first_word && used + 1 + characters_in(word) > columns) {
            begin_line();
        } else if (!first_word) {
            lines += ' ';
            ++used;
        }
        first_word = false;
        while (used + characters_in(word) > columns) {
            const std::size_t fits = bytes_of(word, columns - used);
            lines += word.substr(0, fits);
            word.remove_prefix(fits);
            begin_line();
        }
        lines += word;
        used += characters_in(word);
    }
    return lines + "\n";
}

std::string counted(std::int64_t count) {
    std::string digits = fmt::format("{}", count);
    const std::ptrdiff_t sign = count < 0 ? 1 : 0;
    for (auto at = std::ssize(digits) - 3; at > sign; at -= 3)
        digits.insert(static_cast<std::size_t>(at), 1, ',');
    return digits;
}

std::string counted(std::int64_t count, std::string_view noun) {
    return fmt::format("{} {}{}", counted(count), noun, count == 1 ? "" : "s");
}

std::string listed(const std::vector<std::string>& items) {
    std::string text;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i > 0) text += i + 1 == items.size() ? " and " : ", ";
        text += items[i];
    }
    return text;
}

std::string probability_text(double probability) {
    if (probability > 1.0 - 1e-6) return "more than 99.9999 %";
    if (probability < 1e-6) return "less than 0.0001 %";
    // Probabilities required of several attempts have four decimals: 99.9375 % for 40.
    const int decimals = probability > 0.99 || probability < 0.01 ? 4 : 2;
    const double scale = std::pow(10.0, decimals + 2);
    const double steps = probability * scale;
    constexpr double binary_noise = 1e-9;
    const double whole =
        probability >= 0.5 ? std::floor(steps + binary_noise) : std::ceil(steps - binary_noise);
    return format_fixed(whole / scale * 100.0, decimals) + " %";
}

std::string level_text(double level) {
    const std::string text = fmt::format("{:.6g}", level * 100.0);
    // A level below 1 never shows as 100 %.
    return (text == "100" && level < 1.0 ? fmt::format("{:.9g}", level * 100.0) : text) + " %";
}

}  // namespace runcert
