#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "batch_table.h"
#include "core/failure.h"
#include "day_support.h"
#include "measured_call.h"
#include "store/atomic_file.h"
#include "store/process.h"

// What a day costs: made of simulated recordings in a temporary folder, certified by the program as
// a user runs it.

namespace runcert {
namespace {

namespace fs = std::filesystem;

const fs::path programs = RUNCERT_PROGRAMS;
const fs::path profiles = fs::path(RUNCERT_SOURCE_DIR) / "stages/check/profiles";

/// NALSA's rule under another name: one of the program's own would be read from the program.
constexpr const char* rules_file = "own-rules.yaml";

/// The text with its one place `from` replaced. Failure where there is not one.
std::string with_replaced(std::string text, std::string_view from, std::string_view to,
                          const std::string& where) {
    const std::size_t place = text.find(from);
    if (place == std::string::npos || text.find(from, place + 1) != std::string::npos)
        throw Failure(where, fmt::format("\"{}\" is not in it once", from),
                      "Bring the benchmark up to date with it");
    return text.replace(place, from.size(), to);
}

/// A day in a folder of its own, claimed under a profile that stands beside it, and its results.
class BenchmarkDay {
  public:
    BenchmarkDay(const fs::path& folder, int attempts, int epochs)
        : folder_(folder), day_(chain::make_day(folder / "day", attempts, epochs)) {
        write_file_atomically(day_.parent_path() / rules_file,
                              with_replaced(read_file(profiles / "nalsa.yaml"), "id: nalsa\n",
                                            "id: own-rules\n", "nalsa.yaml"));
        write_file_atomically(day_, with_replaced(read_file(day_), "[nalsa]",
                                                  fmt::format("[{}]", rules_file), day_.string()));
    }

    /// Makes it from nothing: the runs of calls before are removed first.
    MeasuredCall first_call(std::size_t jobs, const std::vector<std::string>& options,
                            std::size_t stop_after = 0) const {
        fs::remove_all(folder_ / "out");
        return call(jobs, options, stop_after);
    }

    MeasuredCall call(std::size_t jobs, const std::vector<std::string>& options,
                      std::size_t stop_after = 0) const {
        std::vector<std::string> command{
            (programs / "runcert").string(), "batch",  day_.string(), "--out",
            (folder_ / "out").string(),      "--json", "--jobs",      std::to_string(jobs)};
        command.insert(command.end(), options.begin(), options.end());
        return measured_call(std::move(command), stop_after);
    }

    /// A figure that the decision rests on, and no window: the margin over the standing record.
    void change_profile_figure() const {
        const fs::path file = day_.parent_path() / rules_file;
        write_file_atomically(file, with_replaced(read_file(file), "{kind: absolute, value: 1,",
                                                  "{kind: absolute, value: 2,", file.string()));
    }

  private:
    fs::path folder_;
    fs::path day_;
};

struct Options {
    int attempts = 200;
    int epochs = 3000;
    int calls = 1;
    int rendered = 20;
    int many = 2000;
    int many_epochs = 100;
    int many_ended = 0;
    bool json = false;
};

const std::vector<std::string> no_pages{"--no-render"};

/// The call of the median wall time; of two, the faster.
MeasuredCall median_of(std::vector<MeasuredCall> calls) {
    std::ranges::sort(calls, {}, &MeasuredCall::wall_s);
    return calls[(calls.size() - 1) / 2];
}

void measure_the_day(const Options& options, const fs::path& folder, BatchFigures& figures) {
    const BenchmarkDay day(folder / "whole", options.attempts, options.epochs);
    std::vector<MeasuredCall> one, two;
    for (int i = 0; i < options.calls; ++i) {
        // On one processor, as each of two jobs has one.
        ::setenv("RUNCERT_THREADS", "1", 1);
        one.push_back(day.first_call(1, no_pages));
        ::unsetenv("RUNCERT_THREADS");
        two.push_back(day.first_call(2, no_pages));
    }
    figures.one_job = median_of(std::move(one));
    figures.two_jobs = median_of(std::move(two));
    std::vector<MeasuredCall> again;
    for (int i = 0; i < options.calls; ++i)
        again.push_back(day.call(2, no_pages));
    figures.nothing_changed = median_of(std::move(again));
    day.change_profile_figure();
    figures.figure_changed = day.call(2, no_pages);
}

BatchFigures measure(const Options& options) {
    const TemporaryFolder folder;
    BatchFigures figures;
    figures.attempts = options.attempts;
    figures.epochs = options.epochs;
    figures.calls = options.calls;
    figures.load_before = load_average();
    measure_the_day(options, folder.path(), figures);
    fs::remove_all(folder.path() / "whole");
    if (options.rendered > 0) {
        const BenchmarkDay day(folder.path() / "pages", options.rendered, options.epochs);
        figures.rendered = options.rendered;
        figures.with_pages = day.first_call(2, {});
    }
    if (options.many > 0) {
        const BenchmarkDay day(folder.path() / "many", options.many, options.many_epochs);
        figures.many = options.many;
        figures.many_epochs = options.many_epochs;
        figures.many_runs =
            day.first_call(2, no_pages, static_cast<std::size_t>(options.many_ended));
        if (options.many_ended == 0) figures.many_unchanged = day.call(2, no_pages);
    }
    figures.load_after = load_average();
    return figures;
}

void add_options(CLI::App& app, Options& options) {
    app.add_option("--attempts", options.attempts, "of the day (default: 200)")
        ->check(CLI::Range(1, 9999));
    app.add_option("--epochs", options.epochs, "of each recording, at 10 Hz (default: 3000, 5 min)")
        ->check(CLI::Range(100, 1'000'000));
    app.add_option("--calls", options.calls,
                   "medians of so many, 1 job and 2 jobs in turns (default: 1)")
        ->check(CLI::Range(1, 99));
    app.add_option("--rendered", options.rendered,
                   "attempts of a day with pages and PDFs; 0 for none (default: 20)")
        ->check(CLI::Range(0, 9999));
    app.add_option("--many", options.many,
                   "attempts of a day that shows the memory; 0 for none (default: 2000)")
        ->check(CLI::Range(0, 9999));
    app.add_option("--many-epochs", options.many_epochs, "of each of these (default: 100)")
        ->check(CLI::Range(100, 1'000'000));
    app.add_option("--many-ended", options.many_ended,
                   "interrupt that day when so many have ended; 0 for none (default: 0)")
        ->check(CLI::Range(0, 9999));
    app.add_flag("--json", options.json, "the figures as JSON, and no table");
}

int run(int argc, char** argv) {
    CLI::App app(
        "Times runcert batch on days of simulated attempts, made in a temporary folder (TMPDIR "
        "says where): build/tests/runcert-batch-benchmark, without any option, is all.");
    Options options;
    add_options(app, options);
    app.footer(
        "Takes about 20 minutes on two cores, and 1 GB of disk. Other programs at work at the same "
        "time spoil the times; the load average is printed for that.\n"
        "Exit status: 0 all that is asked of a batch is met; 1 something is not, and the table "
        "says what; 2 it could not be measured.");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const BatchFigures figures = measure(options);
    fmt::print("{}", options.json ? json_of(figures).dump(1) + "\n" : table_of(figures));
    return std::ranges::all_of(requirements_of(figures), &Requirement::is_met) ? 0 : 1;
}

}  // namespace
}  // namespace runcert

int main(int argc, char** argv) {
    try {
        return runcert::run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "runcert-batch-benchmark: {}\n", error.what());
        return 2;
    }
}
