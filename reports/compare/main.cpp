#include <fmt/format.h>

#include <filesystem>

#include "core/failure.h"
#include "reports/compare/compare.h"
#include "reports/document/document_text.h"
#include "run/attempt_files.h"
#include "run/stage_main.h"
#include "store/atomic_file.h"
#include "store/program.h"

using namespace runcert;

namespace {

struct Options {
    std::string run_dir;
    std::string truth;
    std::string receiver;
};

std::string compare_run(const Options& options) {
    StageRun run = open_run("compare", options.run_dir);
    const Attempt& attempt = run.attempt();
    const Receiver& receiver = receiver_of(attempt, options.receiver);
    const ScreenedTable screened = run.read(products::screened, receiver, read_screened);
    const TrajectoryTable trajectory = run.read(products::trajectory, receiver, read_trajectory);
    const Windows windows = run.read(products::windows, receiver, read_windows);
    std::vector<MethodEpoch> truth;
    if (!options.truth.empty())
        truth = truth_at_rows(read_truth(read_file(options.truth), options.truth), trajectory);
    const Comparison comparison =
        compare_methods(screened, trajectory, windows, compare_config(attempt), truth);
    return document_text(comparison_document(comparison, attempt), terminal_columns());
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    return reader_main(
        argc, argv, "compare",
        "All estimators' best windows side by side, for every profile of a run",
        [&](CommandLine& line) {
            line.text("RUN_DIR", options.run_dir, "folder of a certified run",
                      CommandLine::Need::required);
            line.text("--truth", options.truth, "the true run (CSV, as runcert simulate writes)");
            line.text("--receiver", options.receiver, "which receiver (default: the first)");
        },
        [&]() -> int {
            fmt::print("{}", compare_run(options));
            return 0;
        });
}
