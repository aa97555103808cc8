#include "make/progress_text.h"

#include <fmt/format.h>
#include <locale.h>
#include <wchar.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "core/prose.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr std::string_view indent = "    ";

/// Every line of a text that has any letter, indented.
std::string lines_below(std::string_view text, std::string_view before) {
    std::string lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        if (!trim(line).empty()) lines += fmt::format("{}{}\n", before, plain_text(line));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

std::string_view colour_of(std::string_view state) {
    if (state == "done") return "\x1b[32m";
    if (state == "failed") return "\x1b[31m";
    return "\x1b[33m";
}

std::string step_text(const StepReport& step) {
    const std::string reason = plain_text(step.reason);
    if (!step.ran) return fmt::format("{}{} kept: {}\n", indent, plain_text(step.step), reason);
    return fmt::format("{}{} ran: {} ({})\n", indent, plain_text(step.step), reason,
                       duration_text(step.seconds));
}

/// Of "nalsa: Record beaten (232.17 km/h ± 0.17 km/h). The measured speed ..." the first sentence.
std::string_view headline(std::string_view said) {
    return said.substr(0, said.find(". "));
}

std::string first_line(const AttemptReport& attempt, const AttemptTextOptions& options) {
    const std::size_t digits = std::to_string(options.total).size();
    const std::size_t for_id = std::max<std::size_t>(options.columns / 3, 8);
    const std::string state = plain_text(attempt.state);
    const std::string before = fmt::format("[{:>{}}/{}] {}  ", options.index + 1, digits,
                                           options.total, fitted(plain_text(attempt.id), for_id));
    std::string line = before + state;
    if (!attempt.steps.empty())
        line += fmt::format("  {} of {} ran", steps_run(attempt),
                            counted(static_cast<std::int64_t>(attempt.steps.size()), "step"));
    line += "  " + duration_text(attempt.seconds);
    std::string_view between = "  ";
    for (const std::string& said : attempt.said) {
        line += fmt::format("{}{}", between, plain_text(std::string(headline(said))));
        between = "; ";
    }
    line = fitted(line, options.columns);
    const std::string coloured = before + state;
    if (options.colour && line.starts_with(coloured))
        line = fmt::format("{}{}{}\x1b[0m{}", before, colour_of(state), state,
                           line.substr(coloured.size()));
    return line + "\n";
}

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

std::size_t steps_run(const AttemptReport& attempt) {
    return static_cast<std::size_t>(std::count_if(attempt.steps.begin(), attempt.steps.end(),
                                                  [](const StepReport& step) { return step.ran; }));
}

std::string attempt_text(const AttemptReport& attempt, const AttemptTextOptions& options) {
    std::string text = first_line(attempt, options);
    text += lines_below(attempt.error, indent);
    if (!attempt.superseded.empty())
        text += fmt::format("{}the earlier run is in {}\n", indent, plain_text(attempt.superseded));
    for (const std::string& line : attempt.signs)
        text += fmt::format("{}signed {}\n", indent, plain_text(line));
    if (options.explain)
        for (const StepReport& step : attempt.steps)
            text += step_text(step);
    return text;
}

std::string note_text(const std::string& note) {
    return lines_below(note, "");
}

std::string closing_text(const DaySummary& summary) {
    std::string text;
    for (const std::string& line : summary.closing)
        text += lines_below(line, "");
    return text;
}

std::string summary_text(const DaySummary& summary) {
    const auto number = [](std::size_t count) { return counted(static_cast<std::int64_t>(count)); };
    std::string text =
        fmt::format("{}: {} done", counted(static_cast<std::int64_t>(summary.attempts), "attempt"),
                    number(summary.done));
    if (summary.failed > 0) text += fmt::format(", {} failed", number(summary.failed));
    if (summary.not_processed > 0)
        text += fmt::format(", {} not processed", number(summary.not_processed));
    text += fmt::format("; {} run, {} kept; {}\n",
                        counted(static_cast<std::int64_t>(summary.steps_run), "step"),
                        number(summary.steps_kept), duration_text(summary.seconds));
    if (!summary.results.empty()) text += fmt::format("Results: {}\n", plain_text(summary.results));
    return text + closing_text(summary);
}

std::string duration_text(double seconds) {
    // Rounded before it is cut into parts: never "60 s".
    if (seconds < 99.95) return format_fixed(std::max(seconds, 0.0), 1) + " s";
    const auto whole = static_cast<std::int64_t>(std::llround(std::min(seconds, 1e9)));
    if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
    const std::int64_t minutes = (whole + 30) / 60;
    return fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

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
