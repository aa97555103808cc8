#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "core/failure.h"
#include "files/atomic_file.h"
#include "files/program.h"
#include "run/evidence.h"
#include "run/stage_main.h"
#include "stages/compare/compare.h"

using namespace runcert;

namespace {

struct Options {
    std::string run_dir;
    std::string truth;
    std::string receiver;
};

const Receiver& chosen_receiver(const Attempt& attempt, const Options& options) {
    if (options.receiver.empty()) return attempt.receivers.front();
    std::string known;
    for (const Receiver& receiver : attempt.receivers) {
        if (receiver.id == options.receiver) return receiver;
        known += (known.empty() ? "" : ", ") + receiver.id;
    }
    throw Failure("--receiver", "the attempt has no receiver \"" + options.receiver + "\"",
                  "Choose one of: " + known);
}

std::string compare_run(const Options& options) {
    if (!std::filesystem::is_directory(options.run_dir))
        throw Failure(options.run_dir, "there is no such run folder",
                      "Name a folder that `runcert certify` wrote");
    StageRun run("compare", std::filesystem::path(options.run_dir) / evidence_attempt_file,
                 options.run_dir);
    const Attempt& attempt = run.attempt();
    const Receiver& receiver = chosen_receiver(attempt, options);
    const auto file = [&](std::string_view stem, std::string_view extension) {
        return product_file(attempt, receiver, stem, extension);
    };
    const ScreenedTable screened = run.read("screened", file("3-screened", "ecsv"), read_screened);
    const TrajectoryTable trajectory =
        run.read("trajectory", file("4-trajectory", "ecsv"), read_trajectory);
    const Windows windows = run.read("windows", file("5-windows", "yaml"), read_windows);
    std::optional<std::vector<std::optional<TruthEpoch>>> truth;
    if (!options.truth.empty())
        truth = truth_at_rows(read_truth(read_file(options.truth), options.truth), trajectory);
    return comparison_text(compare_methods(screened, trajectory, windows, compare_config(attempt),
                                           truth ? &*truth : nullptr),
                           attempt.id);
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main([&]() -> int {
        CLI::App app("All estimators' best windows side by side, for every profile of a run",
                     "runcert-compare");
        Options options;
        app.add_option("RUN_DIR", options.run_dir, "folder of a certified run")->required();
        app.add_option("--truth", options.truth, "the true run (CSV, as runcert simulate writes)");
        app.add_option("--receiver", options.receiver, "which receiver (default: the first)");
        app.set_version_flag("--version",
                             fmt::format("{} {}", program_version(), source_revision()));
        try {
            app.parse(argc, argv);
        } catch (const CLI::Success& help) {
            return app.exit(help);
        }
        fmt::print("{}", compare_run(options));
        return 0;
    });
}
