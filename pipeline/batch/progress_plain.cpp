#include <algorithm>
#include <mutex>
#include <string>

#include "batch/progress_order.h"
#include "batch/progress_styles.h"
#include "batch/progress_text.h"

namespace runcert {
namespace {

class PlainProgress : public Progress {
  public:
    explicit PlainProgress(const ProgressOptions& options)
        : options_(options), quiet_(options.style == ProgressStyle::quiet) {}
    ~PlainProgress() override { print(order_.rest()); }
    PlainProgress(const PlainProgress&) = delete;
    PlainProgress& operator=(const PlainProgress&) = delete;

    void attempt_begins(std::size_t, const std::string&) override {}
    void step_begins(std::size_t, const std::string&) override {}
    void step_ends(std::size_t, const StepReport&) override {}

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

    void attempt_skipped(std::size_t index) override {
        const std::lock_guard lock(mutex_);
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
    void print(const std::string& text) {
        if (text.empty()) return;
        std::fwrite(text.data(), 1, text.size(), options_.to);
        std::fflush(options_.to);
    }

    ProgressOptions options_;
    bool quiet_;
    std::mutex mutex_;
    ReportOrder order_;
};

}  // namespace

std::unique_ptr<Progress> make_plain_progress(const ProgressOptions& options) {
    return std::make_unique<PlainProgress>(options);
}

}  // namespace runcert
