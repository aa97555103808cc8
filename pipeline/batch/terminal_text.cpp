#include "batch/terminal_text.h"

#include <locale.h>
#include <wchar.h>

#include <algorithm>
#include <cstdint>

namespace runcert {
namespace {

constexpr std::string_view cut_mark = "...";
constexpr std::uint32_t emoji_form = 0xFE0F;  ///< makes the character before it a wide picture

/// The C library's table of widths is that of a locale: C.UTF-8, which is always there on Debian,
/// for this thread and the life of this object, whatever the program's own is.
class WidthTable {
  public:
    WidthTable() : before_(table() ? uselocale(table()) : nullptr) {}
    ~WidthTable() {
        if (before_) uselocale(before_);
    }
    WidthTable(const WidthTable&) = delete;
    WidthTable& operator=(const WidthTable&) = delete;

    std::size_t width(std::uint32_t code) const {
        if (code < 0x80) return 1;
        if (code == emoji_form) return 1;
        // Too wide by one does no harm; too narrow would break the line.
        if (!before_) return 2;
        const int width = wcwidth(static_cast<wchar_t>(code));
        return width < 0 ? 2 : static_cast<std::size_t>(width);
    }

  private:
    static locale_t table() {
        static const locale_t utf8 = newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
        return utf8;
    }
    locale_t before_;
};

/// The next character of a text of UTF-8, taken from it.
std::uint32_t take_character(std::string_view& text) {
    const auto byte = [&text](std::size_t at) {
        return static_cast<std::uint32_t>(static_cast<unsigned char>(text[at]));
    };
    const std::uint32_t lead = byte(0);
    const std::size_t wanted = lead < 0xC0 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
    const std::size_t bytes = std::min(wanted, text.size());
    std::uint32_t code = bytes == 1 ? lead : lead & (0xFFU >> (bytes + 1));
    for (std::size_t at = 1; at < bytes; ++at)
        code = code << 6U | (byte(at) & 0x3FU);
    text.remove_prefix(bytes);
    return code;
}

}  // namespace

std::size_t columns_of(std::string_view text) {
    const WidthTable table;
    std::size_t columns = 0;
    while (!text.empty())
        columns += table.width(take_character(text));
    return columns;
}

std::string fitted(std::string_view text, std::size_t columns) {
    if (columns_of(text) <= columns) return std::string(text);
    const std::string_view mark = cut_mark.substr(0, columns);
    const std::size_t room = columns - mark.size();
    const WidthTable table;
    std::size_t used = 0;
    std::size_t kept = 0;
    // A character is kept with all that combine with it, so its own width is not enough to know.
    std::size_t whole = 0;
    for (std::string_view left = text; !left.empty();) {
        const std::uint32_t code = take_character(left);
        const std::size_t width = table.width(code);
        const bool begins = width > 0 && code != emoji_form;
        if (begins && used <= room) whole = kept;
        used += width;
        kept = text.size() - left.size();
        if (used > room) break;
    }
    return std::string(text.substr(0, whole)).append(mark);
}

}  // namespace runcert
