#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "make/progress_parts.h"
#include "make/progress_text.h"

namespace runcert {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds redraw_interval{100};

bool wants_colour() {
    const char* none = std::getenv("NO_COLOR");  // https://no-color.org
    return none == nullptr || *none == '\0';
}

/// One thread draws; all others only change what it draws. The cursor is never hidden and rests at
/// the end of the bar, so that a program that is killed leaves nothing to repair.
class TerminalProgress : public Progress {
  public:
    explicit TerminalProgress(const ProgressOptions& options)
        : options_(options), colour_(wants_colour()), began_(Clock::now()) {
        contents_.total = options.total;
        drawer_ = std::thread([this] { draw_until_end(); });
    }
    ~TerminalProgress() override {
        end_drawing();
        finish("");
    }
    TerminalProgress(const TerminalProgress&) = delete;
    TerminalProgress& operator=(const TerminalProgress&) = delete;

    void attempt_begins(std::size_t index, const std::string& id) override {
        const std::lock_guard lock(mutex_);
        const double now = now_s();
        running_[index] = {.id = id, .step = "", .seconds = now};
        pace_.begins(index, now);
    }

    void step_begins(std::size_t index, const std::string& step) override {
        const std::lock_guard lock(mutex_);
        const auto found = running_.find(index);
        if (found == running_.end()) return;
        found->second.step = step;
        found->second.seconds = now_s();
    }

    void step_ends(std::size_t, const StepReport&) override {}

    void attempt_ends(std::size_t index, const AttemptReport& attempt) override {
        const std::lock_guard lock(mutex_);
        running_.erase(index);
        pace_.ends(index, steps_run(attempt) > 0, now_s());
        ++contents_.ended;
        if (attempt.state == "failed") ++contents_.failed;
        said_ += order_.say(index, attempt_text(attempt, {.index = index,
                                                          .total = options_.total,
                                                          .columns = size().columns - 1,
                                                          .explain = options_.explain,
                                                          .colour = colour_}));
        said_ += order_.end(index);
    }

    void attempt_skipped(std::size_t index) override {
        const std::lock_guard lock(mutex_);
        running_.erase(index);
        ++contents_.ended;
        said_ += order_.end(index);
    }

    void note(const std::string& text) override {
        const std::lock_guard lock(mutex_);
        said_ += note_text(text);
    }

    void ends(const DaySummary& summary) override {
        end_drawing();
        finish(summary_text(summary));
    }

  private:
    double now_s() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

    TerminalSize size() const {
        winsize window{};
        TerminalSize size{.columns = static_cast<std::size_t>(std::max(options_.columns, 2))};
        if (ioctl(fileno(options_.to), TIOCGWINSZ, &window) != 0) return size;
        if (window.ws_col > 1) size.columns = window.ws_col;
        if (window.ws_row > 0) size.rows = window.ws_row;
        return size;
    }

    void draw_until_end() {
        std::unique_lock lock(mutex_);
        while (!ended_) {
            const std::string text = next_frame();
            // A terminal that is held up must not hold up the work.
            lock.unlock();
            print(text);
            lock.lock();
            wakes_.wait_for(lock, redraw_interval, [this] { return ended_; });
        }
    }

    void end_drawing() {
        {
            const std::lock_guard lock(mutex_);
            ended_ = true;
        }
        wakes_.notify_all();
        if (drawer_.joinable()) drawer_.join();
    }

    /// Moves to where the frame begins and erases it. A terminal that was made narrower has broken
    /// lines of the frame.
    std::string erasure(const TerminalSize& terminal) const {
        if (drawn_.empty()) return {};
        std::string text = "\r";
        for (std::size_t up = rows_of(drawn_, terminal.columns); up > 1; --up)
            text += "\x1b[A";
        return text + "\x1b[J";
    }

    /// What erases the frame that is drawn and draws the next one; empty if nothing changed.
    std::string next_frame() {
        const TerminalSize terminal = size();
        const double now = now_s();
        contents_.running.clear();
        for (const auto& [index, attempt] : running_)
            contents_.running.push_back(
                {.id = attempt.id, .step = attempt.step, .seconds = now - attempt.seconds});
        contents_.runs_per_minute = pace_.runs_per_minute(now);
        const std::size_t begun = contents_.ended + running_.size();
        contents_.seconds_left =
            pace_.seconds_left(contents_.total - std::min(begun, contents_.total), now);
        std::vector<std::string> lines = frame_lines(contents_, terminal);
        if (said_.empty() && lines == drawn_) return {};
        std::string text = erasure(terminal) + std::exchange(said_, {});
        for (std::size_t i = 0; i < lines.size(); ++i)
            text += (i == 0 ? "" : "\n") + lines[i];
        drawn_ = std::move(lines);
        return text;
    }

    /// Erases the frame for good and says what was held back. Only when nobody draws any more.
    void finish(const std::string& last) {
        const std::lock_guard lock(mutex_);
        print(erasure(size()) + std::exchange(said_, {}) + order_.rest() + last);
        drawn_.clear();
    }

    /// In one piece, so that no half of a frame is seen.
    void print(const std::string& text) {
        if (text.empty()) return;
        std::fwrite(text.data(), 1, text.size(), options_.to);
        std::fflush(options_.to);
    }

    ProgressOptions options_;
    bool colour_;
    Clock::time_point began_;
    std::mutex mutex_;
    std::condition_variable wakes_;
    bool ended_ = false;
    ReportOrder order_;
    Pace pace_;
    std::map<std::size_t, RunningAttempt> running_;  ///< with the moment its step began as seconds
    FrameContents contents_;
    std::vector<std::string> drawn_;  ///< the frame on the terminal
    std::string said_;                ///< what goes above it with the next frame
    std::thread drawer_;
};

}  // namespace

std::unique_ptr<Progress> make_terminal_progress(const ProgressOptions& options) {
    return std::make_unique<TerminalProgress>(options);
}

}  // namespace runcert
