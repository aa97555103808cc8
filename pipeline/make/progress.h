#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace runcert {

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

struct AttemptBegins {
    std::string id;
};
struct StepBegins {
    std::string step;
};
/// The attempt is not run, and nothing is said of it.
struct AttemptSkipped {};
/// Lines for whoever looks on.
struct Note {
    std::string text;
};

/// Something that happens in a day. A report says that the step, the attempt or the day has ended.
struct Event {
    std::size_t attempt = 0;  ///< its place in the day, from 0; of a note and the day none
    std::variant<AttemptBegins, StepBegins, StepReport, AttemptReport, AttemptSkipped, Note,
                 DaySummary>
        what;
};

/// Shows the events of a day as they come, from any thread. An attempt ends or is skipped at most
/// once, and the day at the end. What is said of an attempt is held back until all before it have
/// ended or were skipped, so that two calls give the same text but for times, whatever the order of
/// finishing; notes are said at once. Texts may be anything: what would steer a terminal is taken
/// out. What is still held back is said when the last copy of the function goes.
using Progress = std::function<void(const Event& event)>;

/// How a day's progress is shown.
enum class ProgressStyle {
    terminal,  ///< plain, and below a line that moves: how far it is, what runs, the time left
    plain,     ///< a line for each finished attempt
    quiet,     ///< only failures and the closing lines
    json,      ///< one event a line, for programs
};

/// The style that suits a file: `terminal` for a terminal that can move its cursor, else `plain`.
ProgressStyle progress_style_for(std::FILE* to);

struct ProgressOptions {
    ProgressStyle style = ProgressStyle::plain;
    bool explain = false;      ///< also a line for each step: why it ran or was kept
    std::size_t columns = 80;  ///< a line's width; a terminal that says its own is believed
    std::size_t total = 0;     ///< attempts
    std::FILE* to = stdout;
    /// Seconds that steps took before, by name, as far as known.
    std::map<std::string, double> took = {};
};

Progress make_progress(const ProgressOptions& options);

/// Seconds of each step in a run.yaml, by its name; none if there is no such file, or it cannot be
/// read.
std::map<std::string, double> seconds_of_steps(const std::filesystem::path& run_times);

}  // namespace runcert
