#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace runcert {

/// How a day's progress is shown.
enum class ProgressStyle {
    terminal,  ///< a line for each finished attempt; below, what runs, a bar and the time left
    plain,     ///< a line for each finished attempt
    quiet,     ///< only failures and the closing lines
    json,      ///< one event a line, for programs
};

/// What became of one step of a run.
struct StepReport {
    std::string step;
    bool ran = false;
    std::string reason = {};  ///< why it ran, or was kept
    double seconds = 0.0;
};

/// What became of one attempt.
struct AttemptReport {
    std::string id;
    std::string source = {};  ///< its file
    std::string state;        ///< "done", "failed", "interrupted"
    std::vector<StepReport> steps = {};
    std::vector<std::string> said = {};   ///< a line for each profile
    std::vector<std::string> signs = {};  ///< what was signed, a line for each profile
    std::string superseded = {};          ///< where an earlier run went, within the run folder
    std::string error = {};               ///< lines
    double seconds = 0.0;
};

/// What became of the day.
struct DaySummary {
    std::size_t attempts = 0, done = 0, failed = 0, not_processed = 0;
    std::size_t steps_run = 0, steps_kept = 0;
    double seconds = 0.0;
    std::string results = {};               ///< the path of day.html
    std::vector<std::string> closing = {};  ///< lines, e.g. how to go on
};

struct ProgressOptions {
    ProgressStyle style = ProgressStyle::plain;
    bool explain = false;   ///< also a line for each step: why it ran or was kept
    int columns = 80;       ///< a line's width; a terminal that says its own is believed
    std::size_t total = 0;  ///< attempts
    std::FILE* to = stdout;
};

/// Shows how the attempts of a day go. An attempt is named by its index, from 0 up to the total,
/// and ends or is skipped at most once. What is said of an attempt is held back until all before it
/// have ended or were skipped, so that two calls give the same text but for times, whatever the
/// order of finishing; notes are said at once. Every function may be called from any thread. Texts
/// may be anything: what would steer a terminal is taken out.
class Progress {
  public:
    virtual ~Progress() = default;
    virtual void attempt_begins(std::size_t index, const std::string& id) = 0;
    virtual void step_begins(std::size_t index, const std::string& step) = 0;
    virtual void step_ends(std::size_t index, const StepReport& step) = 0;
    virtual void attempt_ends(std::size_t index, const AttemptReport& attempt) = 0;
    /// The attempt is not run, and nothing is said of it.
    virtual void attempt_skipped(std::size_t index) = 0;
    virtual void note(const std::string& text) = 0;
    /// The last call: says what was still held back, and the summary.
    virtual void ends(const DaySummary& summary) = 0;
};

/// `terminal` is shown as `plain` where TERM says that the terminal can do no more ("dumb").
std::unique_ptr<Progress> make_progress(const ProgressOptions& options);

/// The style that suits a file: `terminal` for a terminal, `plain` for any other.
ProgressStyle progress_style_for(std::FILE* to);

}  // namespace runcert
