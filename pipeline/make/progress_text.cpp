#include "make/progress_text.h"

#include <fmt/format.h>
#include <locale.h>
#include <wchar.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/prose.h"
#include "core/text.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view indent = "    ";

std::string plain_lines(const std::string& text) {
    std::string lines;
    for (const std::string& line : lines_of(text))
        lines += plain_text(line) + "\n";
    return lines;
}

std::size_t steps_run(const AttemptReport& attempt) {
    return static_cast<std::size_t>(std::ranges::count_if(attempt.steps, &StepReport::ran));
}

std::string_view colour_of(std::string_view state) {
    if (state == "done") return "\x1b[32m";
    if (state == "failed") return "\x1b[31m";
    return "\x1b[33m";
}

/// Of "nalsa: Record beaten (232.17 km/h ± 0.17 km/h). The measured speed ..." the first sentence.
std::string headline(const std::string& said) {
    return plain_text(said.substr(0, said.find(". ")));
}

/// The line of a finished attempt, cut to the width.
std::string first_line(std::size_t index, const AttemptReport& attempt,
                       const ProgressOptions& options, bool colour) {
    const std::size_t digits = std::to_string(options.total).size();
    const std::size_t for_id = std::max<std::size_t>(options.columns / 3, 8);
    const std::string state = plain_text(attempt.state);
    const std::string before = fmt::format("[{:>{}}/{}] {}  ", index + 1, digits, options.total,
                                           fitted(plain_text(attempt.id), for_id));
    std::string line = before + state;
    if (!attempt.steps.empty())
        line += fmt::format("  {} of {} ran", steps_run(attempt),
                            counted(static_cast<std::int64_t>(attempt.steps.size()), "step"));
    line += "  " + duration_text(attempt.seconds);
    std::string_view between = "  ";
    for (const std::string& said : attempt.said)
        line.append(std::exchange(between, "; ")).append(headline(said));
    line = fitted(line, options.columns);
    if (colour && line.starts_with(before + state))
        line.insert(before.size() + state.size(), "\x1b[0m")
            .insert(before.size(), colour_of(state));
    return line + "\n";
}

/// Below the first line, indented, why the attempt failed, what was signed, and with `explain` why
/// each step ran or was kept.
std::string attempt_lines(std::size_t index, const AttemptReport& attempt,
                          const ProgressOptions& options, bool colour) {
    std::string text = first_line(index, attempt, options, colour);
    for (const std::string& line : lines_of(attempt.error))
        if (!trim(line).empty()) text += fmt::format("{}{}\n", indent, plain_text(line));
    if (!attempt.superseded.empty())
        text += fmt::format("{}the earlier run is in {}\n", indent, plain_text(attempt.superseded));
    for (const std::string& line : attempt.signs)
        text += fmt::format("{}signed {}\n", indent, plain_text(line));
    if (!options.explain) return text;
    for (const StepReport& step : attempt.steps)
        text += fmt::format("{}{} {}: {}{}\n", indent, plain_text(step.step),
                            step.ran ? "ran" : "kept", plain_text(step.reason),
                            step.ran ? fmt::format(" ({})", duration_text(step.seconds)) : "");
    return text;
}

/// How many attempts and steps there were, and where the results are.
std::string summary_lines(const DaySummary& summary) {
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
    return text;
}

std::string json_line(const Json& event) {
    return event.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n";
}

double in_milliseconds(double seconds) {
    return std::round(seconds * 1000.0) / 1000.0;
}

std::string json_line(std::size_t index, const StepReport& step) {
    return json_line({{"event", "step"},
                      {"index", index},
                      {"step", step.step},
                      {"ran", step.ran},
                      {"reason", step.reason},
                      {"seconds", in_milliseconds(step.seconds)}});
}

struct Prefix {
    std::size_t bytes = 0, columns = 0;
};

/// The longest beginning of a text that takes no more columns than that, of whole characters with
/// those that combine with them.
Prefix prefix_of(std::string_view text, std::size_t columns) {
    // The C library's table of widths is that of a locale: C.UTF-8, which is always there on
    // Debian, for this thread and as long as it is needed, whatever the program's own is.
    static const locale_t utf8 = newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
    const locale_t before = uselocale(utf8);
    Prefix all;
    while (all.bytes < text.size()) {
        mbstate_t state{};
        wchar_t code = 0;
        const std::size_t taken = mbrtowc(&code, &text[all.bytes], text.size() - all.bytes, &state);
        const bool known = taken > 0 && taken <= text.size();
        // Too wide by one does no harm; too narrow would break the line.
        const int width = known ? wcwidth(code) : 2;
        const std::size_t wide = width < 0 ? 2 : static_cast<std::size_t>(width);
        if (all.columns + wide > columns) break;
        all.columns += wide;
        all.bytes += known ? taken : 1;
    }
    uselocale(before);
    return all;
}

}  // namespace

std::string EventLines::for_people(const Event& event) const {
    const bool quiet = options_.style == ProgressStyle::quiet;
    if (const auto* attempt = std::get_if<AttemptReport>(&event.what);
        attempt && (!quiet || attempt->state == "failed"))
        return attempt_lines(event.attempt, *attempt, options_, colour_);
    if (const auto* note = std::get_if<Note>(&event.what); note && !quiet)
        return plain_lines(note->text);
    if (const auto* summary = std::get_if<DaySummary>(&event.what)) {
        std::string text = quiet ? "" : summary_lines(*summary);
        for (const std::string& line : summary->closing)
            text += plain_lines(line);
        return text;
    }
    return {};
}

std::string EventLines::json(const Event& event) {
    const std::size_t index = event.attempt;
    if (const auto* begins = std::get_if<AttemptBegins>(&event.what))
        return json_line({{"event", "begin"}, {"index", index}, {"id", begins->id}});
    if (const auto* step = std::get_if<StepReport>(&event.what)) {
        ++attempts_[index].steps_told;
        return json_line(index, *step);
    }
    if (const auto* attempt = std::get_if<AttemptReport>(&event.what)) {
        const std::size_t ran = steps_run(*attempt);
        std::string lines;
        // A step that failed has not been told by itself.
        for (std::size_t step = attempts_[index].steps_told; step < attempt->steps.size(); ++step)
            lines += json_line(index, attempt->steps[step]);
        return lines + json_line({{"event", "attempt"},
                                  {"index", index},
                                  {"id", attempt->id},
                                  {"source", attempt->source},
                                  {"state", attempt->state},
                                  {"steps_run", ran},
                                  {"steps_kept", attempt->steps.size() - ran},
                                  {"said", attempt->said},
                                  {"signs", attempt->signs},
                                  {"error", attempt->error},
                                  {"seconds", in_milliseconds(attempt->seconds)}});
    }
    if (const auto* note = std::get_if<Note>(&event.what))
        return json_line({{"event", "note"}, {"text", note->text}});
    if (const auto* summary = std::get_if<DaySummary>(&event.what))
        return json_line({{"event", "end"},
                          {"attempts", summary->attempts},
                          {"done", summary->done},
                          {"failed", summary->failed},
                          {"not_processed", summary->not_processed},
                          {"steps_run", summary->steps_run},
                          {"steps_kept", summary->steps_kept},
                          {"seconds", in_milliseconds(summary->seconds)},
                          {"results", summary->results},
                          {"closing", summary->closing}});
    return {};
}

std::string EventLines::after(const Event& event, std::size_t columns) {
    options_.columns = columns;
    const std::string text =
        options_.style == ProgressStyle::json ? json(event) : for_people(event);
    if (std::holds_alternative<Note>(event.what)) return text;
    if (std::holds_alternative<DaySummary>(event.what)) return rest() + text;
    assert(event.attempt >= next_);
    Attempt& own = attempts_[event.attempt];
    own.held += text;
    own.ended = std::holds_alternative<AttemptReport>(event.what) ||
                std::holds_alternative<AttemptSkipped>(event.what);
    std::string sayable;
    for (auto first = attempts_.find(next_); first != attempts_.end();
         first = attempts_.find(next_)) {
        sayable += std::exchange(first->second.held, {});
        if (!first->second.ended) break;
        attempts_.erase(first);
        ++next_;
    }
    return sayable;
}

std::string EventLines::rest() {
    std::string all;
    for (auto& [index, attempt] : attempts_)
        all += std::exchange(attempt.held, {});
    return all;
}

void MovingLine::take(const Event& event, double now_s) {
    if (const auto* begins = std::get_if<AttemptBegins>(&event.what)) {
        if (!began_s_) began_s_ = now_s;
        running_[event.attempt] = {.id = plain_text(begins->id), .since_s = now_s};
    } else if (const auto* step = std::get_if<StepBegins>(&event.what)) {
        Running& own = running_[event.attempt];
        own.step = plain_text(step->step);
        own.since_s = now_s;
    } else if (const auto* done = std::get_if<StepReport>(&event.what)) {
        if (done->ran) took_[plain_text(done->step)] = done->seconds;
    } else if (const auto* attempt = std::get_if<AttemptReport>(&event.what)) {
        running_.erase(event.attempt);
        ++ended_;
        if (attempt->state == "failed") ++failed_;
        if (steps_run(*attempt) == 0) return;
        ++ran_;
        last_ended_s_ = now_s;
    } else if (std::holds_alternative<AttemptSkipped>(event.what)) {
        ++ended_;
    }
}

std::string MovingLine::text(double now_s) const {
    std::string text;
    if (total_ > 1) text = fmt::format("{} of {}", ended_, total_);
    if (total_ > 1 && failed_ > 0) text += fmt::format(", {} failed", failed_);
    if (total_ > 1 && ran_ > 0 && last_ended_s_ > began_s_) {
        const double each_s = (last_ended_s_ - *began_s_) / static_cast<double>(ran_);
        const double left_s =
            std::ceil(last_ended_s_ - now_s + each_s * static_cast<double>(total_ - ended_));
        if (left_s > 0.0)
            text += left_s < 99.0 ? fmt::format(", {:.0f} s left", left_s)
                                  : fmt::format(", {} left", duration_text(left_s));
        text += fmt::format(", {:.{}f} a minute", 60.0 / each_s, each_s > 6.0 ? 1 : 0);
    }
    if (running_.empty()) return text;
    // The first of those that run is the one that others wait for.
    const Running& first = running_.begin()->second;
    if (total_ > 1) text += fmt::format("; {}: ", first.id);
    // Whole seconds: a figure that changes ten times a second cannot be read.
    text += fmt::format("{} {:.0f} s", first.step, std::floor(now_s - first.since_s));
    if (const auto took = took_.find(first.step); took != took_.end() && took->second >= 1.0)
        text += fmt::format(" of about {:.0f} s", took->second);
    if (running_.size() > 1) text += fmt::format(", {} more", running_.size() - 1);
    return text;
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
    return prefix_of(text, std::string_view::npos).columns;
}

std::string fitted(std::string_view text, std::size_t columns) {
    if (prefix_of(text, columns).bytes == text.size()) return std::string(text);
    const std::string_view mark = std::string_view("...").substr(0, columns);
    const std::size_t kept = prefix_of(text, columns - mark.size()).bytes;
    return std::string(text.substr(0, kept)).append(mark);
}

}  // namespace runcert
