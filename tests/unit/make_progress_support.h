#pragma once

#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "make/progress.h"

namespace runcert::test {

/// A file without a name that progress is written to.
class Output {
  public:
    Output() : file_(std::tmpfile()) {}
    ~Output() { std::fclose(file_); }
    Output(const Output&) = delete;
    Output& operator=(const Output&) = delete;
    std::FILE* file() const { return file_; }
    std::string text() const {
        std::string text;
        std::rewind(file_);
        for (int byte = std::fgetc(file_); byte != EOF; byte = std::fgetc(file_))
            text += static_cast<char>(byte);
        return text;
    }

  private:
    std::FILE* file_;
};

inline std::string id_of(std::size_t index) {
    return "attempt-" + std::to_string(index);
}

/// The attempt of an index: every fifth fails, every third was kept.
inline AttemptReport report_of(std::size_t index) {
    AttemptReport report{.id = id_of(index), .source = id_of(index) + ".yaml", .state = "done"};
    if (index % 5 == 4) {
        report.state = "failed";
        report.error = "rover.pos, line 7: it holds no number\nCorrect the line\n";
    } else {
        report.said = {"nalsa: beaten by 1.25 km/h", "fisly: not proven"};
    }
    const bool kept = index % 3 == 0;
    report.steps = {{.step = "import", .ran = false, .reason = "nothing changed"},
                    {.step = "smooth",
                     .ran = !kept,
                     .reason = kept ? "nothing changed" : "parameters.smooth.robust_scale 2 -> 2.5",
                     .seconds = 1.5}};
    report.seconds = 2.0;
    return report;
}

/// Tells all of an attempt.
inline void tell(const Progress& progress, std::size_t index) {
    if (index % 7 == 6) {
        progress({index, AttemptSkipped{}});
        return;
    }
    progress({index, AttemptBegins{id_of(index)}});
    for (const StepReport& step : report_of(index).steps) {
        progress({index, StepBegins{step.step}});
        progress({index, step});
    }
    progress({index, report_of(index)});
}

inline DaySummary day_of(std::size_t attempts) {
    return {.attempts = attempts,
            .done = attempts - 2,
            .failed = 1,
            .not_processed = 1,
            .steps_run = 7,
            .steps_kept = 9,
            .seconds = 125.0,
            .results = "out/day.html",
            .closing = {"Go on with: runcert batch day"}};
}

}  // namespace runcert::test
