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

int main(int argc, char** argv) {
    std::string run_dir, truth_file, receiver_id;
    return reader_main(
        argc, argv, "compare",
        "All estimators' best windows side by side, for every profile of a run",
        [&](CommandLine& line) {
            line.text("RUN_DIR", run_dir, "folder of a certified run", CommandLine::Need::required);
            line.text("--truth", truth_file, "the true run (CSV, as runcert simulate writes)");
            line.text("--receiver", receiver_id, "which receiver (default: the first)");
        },
        [&]() -> int {
            StageRun run = open_run("compare", run_dir);
            const Attempt& attempt = run.attempt();
            const Receiver& receiver = receiver_of(attempt, receiver_id);
            const auto screened = run.read(products::screened, receiver, read_screened);
            const auto trajectory = run.read(products::trajectory, receiver, read_trajectory);
            const auto windows = run.read(products::windows, receiver, read_windows);
            std::vector<MethodEpoch> truth;
            if (!truth_file.empty())
                truth = truth_at_rows(read_truth(read_file(truth_file), truth_file), trajectory);
            const Comparison comparison =
                compare_methods(screened, trajectory, windows, compare_config(attempt), truth);
            fmt::print("{}",
                       document_text(comparison_document(comparison, attempt), terminal_columns()));
            return 0;
        });
}
