#include "make/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "core/failure.h"
#include "core/text.h"
#include "make/progress_text.h"
#include "store/atomic_file.h"
#include "store/yaml_input.h"

namespace runcert {
namespace {

using Clock = std::chrono::steady_clock;

bool is_set(const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr && *value != '\0';
}

void print(std::string_view text, std::FILE* to) {
    std::fwrite(text.data(), 1, text.size(), to);
    std::fflush(to);
}

/// Writes lines as soon as they may be said.
class LineWriter {
  public:
    explicit LineWriter(const ProgressOptions& options) : options_(options), lines_(options) {}
    ~LineWriter() { print_each(lines_.rest()); }
    void take(const Event& event) {
        const std::lock_guard lock(mutex_);
        print_each(lines_.after(event, options_.columns));
    }

  private:
    /// One by one, so that no reader waits for the rest of one.
    void print_each(const std::string& lines) {
        for (const std::string& line : lines_of(lines))
            print(line + "\n", options_.to);
    }

    ProgressOptions options_;
    std::mutex mutex_;
    EventLines lines_;
};

/// One thread draws; all others only change what it draws. The cursor is never hidden and rests at
/// the end of the line, so that a program that is killed leaves nothing to repair.
class TerminalWriter {
  public:
    explicit TerminalWriter(const ProgressOptions& options)
        : options_(options), lines_(options, !is_set("NO_COLOR")), moving_(options) {
        drawer_ = std::jthread([this](const std::stop_token& stop) { draw_until(stop); });
    }
    ~TerminalWriter() {
        drawer_ = {};
        print(erasure(columns()) + said_ + lines_.rest(), options_.to);
    }

    void take(const Event& event) {
        const std::lock_guard lock(mutex_);
        said_ += lines_.after(event, columns() - 1);
        moving_.take(event, now_s());
    }

  private:
    double now_s() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

    std::size_t columns() const {
        winsize window{};
        const bool is_said = ioctl(fileno(options_.to), TIOCGWINSZ, &window) == 0;
        return is_said && window.ws_col > 1 ? window.ws_col
                                            : std::max<std::size_t>(options_.columns, 2);
    }

    void draw_until(const std::stop_token& stop) {
        constexpr std::chrono::milliseconds redraw_interval{100};
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
            const std::string text = next_drawing();
            // A terminal that is held up must not hold up the work.
            lock.unlock();
            print(text, options_.to);
            lock.lock();
            wakes_.wait_for(lock, stop, redraw_interval, [] { return false; });
        }
    }

    /// Erases the line. A terminal that was made narrower has broken it into several.
    std::string erasure(std::size_t columns) const {
        if (drawn_.empty()) return {};
        std::string text = "\r";
        for (std::size_t row = 1; row * columns < columns_of(drawn_); ++row)
            text += "\x1b[A";
        return text + "\x1b[J";
    }

    /// Erases the line that is drawn, says what goes above it and draws the next; empty if nothing
    /// changed.
    std::string next_drawing() {
        // Longer lines are harder to read, and are broken when the terminal is made narrower.
        constexpr std::size_t widest = 79;
        const std::size_t across = columns();
        std::string line = fitted(moving_.text(now_s()), std::min(across - 1, widest));
        if (said_.empty() && line == drawn_) return {};
        std::string text = erasure(across) + std::exchange(said_, {}) + line;
        drawn_ = std::move(line);
        return text;
    }

    ProgressOptions options_;
    Clock::time_point began_ = Clock::now();
    std::mutex mutex_;
    std::condition_variable_any wakes_;
    EventLines lines_;
    MovingLine moving_;
    std::string drawn_;  ///< the line on the terminal
    std::string said_;   ///< what goes above it with the next drawing
    std::jthread drawer_;
};

template <class Writer>
Progress progress_of(const ProgressOptions& options) {
    return
        [writer = std::make_shared<Writer>(options)](const Event& event) { writer->take(event); };
}

}  // namespace

Progress make_progress(const ProgressOptions& options) {
    return options.style == ProgressStyle::terminal ? progress_of<TerminalWriter>(options)
                                                    : progress_of<LineWriter>(options);
}

ProgressStyle progress_style_for(std::FILE* to) {
    const bool moves = isatty(fileno(to)) != 0 && is_set("TERM") &&
                       std::string_view(std::getenv("TERM")) != "dumb";
    return moves ? ProgressStyle::terminal : ProgressStyle::plain;
}

std::map<std::string, double> seconds_of_steps(const std::filesystem::path& run_times) {
    std::map<std::string, double> seconds;
    try {
        const YamlValue times(parse_yaml(read_file(run_times), run_times.string()),
                              run_times.string());
        for (const YamlValue& stage : times["stages"].list())
            seconds[stage["stage"].text()] = stage["seconds"].real();
    } catch (const Failure&) {
        seconds.clear();
    }
    return seconds;
}

}  // namespace runcert
