#include <fmt/format.h>

#include "core/failure.h"
#include "stages/import/recording.h"

namespace runcert {
namespace {

constexpr std::string_view little_endian_mark = "\xff\xfe";
constexpr std::string_view big_endian_mark = "\xfe\xff";

/// Which byte of each code unit of the beginning is NUL; nothing where that is not always the same.
std::optional<std::size_t> nul_byte(std::string_view bytes) {
    const std::string_view start = bytes.substr(0, 64);
    if (start.size() < 4) return std::nullopt;
    for (const std::size_t parity : {std::size_t{0}, std::size_t{1}}) {
        bool all = true;
        for (std::size_t i = 0; i < start.size(); ++i)
            all = all && (start[i] == '\0') == (i % 2 == parity);
        if (all) return parity;
    }
    return std::nullopt;
}

void append_utf8(char32_t code, std::string& text) {
    const auto put = [&](char32_t byte) { text.push_back(static_cast<char>(byte)); };
    if (code < 0x80) return put(code);
    if (code < 0x800) {
        put(0xC0 | code >> 6);
    } else {
        if (code < 0x10000) {
            put(0xE0 | code >> 12);
        } else {
            put(0xF0 | code >> 18);
            put(0x80 | (code >> 12 & 0x3F));
        }
        put(0x80 | (code >> 6 & 0x3F));
    }
    put(0x80 | (code & 0x3F));
}

/// The code units of a text, one after the other.
class CodeUnits {
  public:
    explicit CodeUnits(const RecordingBytes& recording)
        : recording_(recording),
          big_endian_(recording.bytes.starts_with(big_endian_mark) ||
                      nul_byte(recording.bytes) == std::size_t{0}) {
        if (recording.bytes.starts_with(big_endian_mark) ||
            recording.bytes.starts_with(little_endian_mark))
            at_ = 2;
    }

    bool at_end() const { return at_ >= recording_.bytes.size(); }

    char32_t next() {
        if (at_ + 2 > recording_.bytes.size()) fail(at_, "the UTF-16 text ends within a character");
        const auto byte = [&](std::size_t i) {
            return static_cast<char32_t>(static_cast<unsigned char>(recording_.bytes[at_ + i]));
        };
        const char32_t unit = byte(big_endian_ ? 0 : 1) << 8 | byte(big_endian_ ? 1 : 0);
        at_ += 2;
        return unit;
    }

    /// The character that begins with the next unit.
    char32_t character() {
        const std::size_t begin = at_;
        const char32_t high = next();
        if (high < 0xD800 || high > 0xDFFF) return high;
        const char32_t low = high < 0xDC00 && !at_end() ? next() : 0;
        if (low < 0xDC00 || low > 0xDFFF)
            fail(begin, "the UTF-16 text holds half a surrogate pair");
        return 0x10000 + ((high - 0xD800) << 10) + (low - 0xDC00);
    }

  private:
    [[noreturn]] void fail(std::size_t byte, const char* what) const {
        throw Failure(place_in(recording_, RecordPlace(byte)), what,
                      "It is cut off or damaged; take the recording as the program wrote it");
    }

    const RecordingBytes& recording_;
    bool big_endian_;
    std::size_t at_ = 0;
};

}  // namespace

bool is_utf16(std::string_view bytes) {
    using namespace std::string_view_literals;
    if (bytes.starts_with("\xff\xfe\0\0"sv)) return false;  // UTF-32
    return bytes.starts_with(little_endian_mark) || bytes.starts_with(big_endian_mark) ||
           nul_byte(bytes).has_value();
}

std::string utf8_of_utf16(const RecordingBytes& recording) {
    std::string text;
    text.reserve(recording.bytes.size() / 2);
    CodeUnits units(recording);
    while (!units.at_end())
        append_utf8(units.character(), text);
    return text;
}

}  // namespace runcert
