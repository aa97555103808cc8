#include "make/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>

#include "make/progress_parts.h"
#include "make/progress_text.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

/// Writes lines, those about attempts in the order of the attempts.
class LinesInOrder : public Progress {
  public:
    explicit LinesInOrder(std::FILE* to) : to_(to) {}
    ~LinesInOrder() override { print(order_.rest()); }
    LinesInOrder(const LinesInOrder&) = delete;
    LinesInOrder& operator=(const LinesInOrder&) = delete;

    void attempt_begins(std::size_t, const std::string&) override {}
    void step_begins(std::size_t, const std::string&) override {}
    void step_ends(std::size_t, const StepReport&) override {}
    void attempt_skipped(std::size_t index) override {
        const std::lock_guard lock(mutex_);
        print(order_.end(index));
    }

  protected:
    /// Lines, each ended; they are written one by one, so that no reader waits for the rest of one.
    void print(std::string_view lines) {
        while (!lines.empty()) {
            const std::size_t end = lines.find('\n') + 1;
            std::fwrite(lines.data(), 1, end, to_);
            std::fflush(to_);
            lines.remove_prefix(end);
        }
    }

    std::mutex mutex_;
    ReportOrder order_;

  private:
    std::FILE* to_;
};

/// Plain, and quiet where the options say so.
class PlainProgress : public LinesInOrder {
  public:
    explicit PlainProgress(const ProgressOptions& options)
        : LinesInOrder(options.to),
          options_(options),
          quiet_(options.style == ProgressStyle::quiet) {}

    void attempt_ends(std::size_t index, const AttemptReport& attempt) override {
        const std::lock_guard lock(mutex_);
        if (!quiet_ || attempt.state == "failed")
            print(order_.say(index, attempt_text(attempt, {.index = index,
                                                           .total = options_.total,
                                                           .columns = static_cast<std::size_t>(
                                                               std::max(options_.columns, 1)),
                                                           .explain = options_.explain})));
        print(order_.end(index));
    }

    void note(const std::string& text) override {
        const std::lock_guard lock(mutex_);
        if (!quiet_) print(note_text(text));
    }

    void ends(const DaySummary& summary) override {
        const std::lock_guard lock(mutex_);
        print(order_.rest() + (quiet_ ? closing_text(summary) : summary_text(summary)));
    }

  private:
    ProgressOptions options_;
    bool quiet_;
};

/// One line, in ASCII. Bytes that are not UTF-8 become U+FFFD.
std::string line_of(const Json& event) {
    return event.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n";
}

double in_milliseconds(double seconds) {
    return std::round(seconds * 1000.0) / 1000.0;
}

Json step_event(std::size_t index, const StepReport& step) {
    return {{"event", "step"}, {"index", index},        {"step", step.step},
            {"ran", step.ran}, {"reason", step.reason}, {"seconds", in_milliseconds(step.seconds)}};
}

Json attempt_event(std::size_t index, const AttemptReport& attempt) {
    const std::size_t ran = steps_run(attempt);
    return {{"event", "attempt"},
            {"index", index},
            {"id", attempt.id},
            {"source", attempt.source},
            {"state", attempt.state},
            {"steps_run", ran},
            {"steps_kept", attempt.steps.size() - ran},
            {"said", attempt.said},
            {"signs", attempt.signs},
            {"error", attempt.error},
            {"seconds", in_milliseconds(attempt.seconds)}};
}

Json end_event(const DaySummary& summary) {
    return {{"event", "end"},
            {"attempts", summary.attempts},
            {"done", summary.done},
            {"failed", summary.failed},
            {"not_processed", summary.not_processed},
            {"steps_run", summary.steps_run},
            {"steps_kept", summary.steps_kept},
            {"seconds", in_milliseconds(summary.seconds)},
            {"results", summary.results},
            {"closing", summary.closing}};
}

class JsonProgress : public LinesInOrder {
  public:
    using LinesInOrder::LinesInOrder;

    void attempt_begins(std::size_t index, const std::string& id) override {
        const std::lock_guard lock(mutex_);
        say(index, {{"event", "begin"}, {"index", index}, {"id", id}});
    }

    void step_ends(std::size_t index, const StepReport& step) override {
        const std::lock_guard lock(mutex_);
        steps_said_[index].insert(step.step);
        say(index, step_event(index, step));
    }

    void attempt_ends(std::size_t index, const AttemptReport& attempt) override {
        const std::lock_guard lock(mutex_);
        // Steps that were kept may never have been told by themselves.
        const std::set<std::string> said = std::move(steps_said_[index]);
        steps_said_.erase(index);
        for (const StepReport& step : attempt.steps)
            if (!said.contains(step.step)) say(index, step_event(index, step));
        say(index, attempt_event(index, attempt));
        print(order_.end(index));
    }

    void note(const std::string& text) override {
        const std::lock_guard lock(mutex_);
        print(line_of({{"event", "note"}, {"text", text}}));
    }

    void ends(const DaySummary& summary) override {
        const std::lock_guard lock(mutex_);
        print(order_.rest() + line_of(end_event(summary)));
    }

  private:
    void say(std::size_t index, const Json& event) { print(order_.say(index, line_of(event))); }

    std::map<std::size_t, std::set<std::string>> steps_said_;
};

bool terminal_is_dumb() {
    const char* type = std::getenv("TERM");
    return type == nullptr || *type == '\0' || std::string_view(type) == "dumb";
}

}  // namespace

std::unique_ptr<Progress> make_progress(const ProgressOptions& options) {
    if (options.style == ProgressStyle::json) return std::make_unique<JsonProgress>(options.to);
    if (options.style == ProgressStyle::terminal && !terminal_is_dumb())
        return make_terminal_progress(options);
    return std::make_unique<PlainProgress>(options);
}

ProgressStyle progress_style_for(std::FILE* to) {
    return isatty(fileno(to)) != 0 ? ProgressStyle::terminal : ProgressStyle::plain;
}

}  // namespace runcert
