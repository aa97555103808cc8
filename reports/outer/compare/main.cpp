#include <fmt/format.h>

#include <filesystem>

#include "core/failure.h"
#include "reports/compare/compare.h"
#include "reports/document/document_text.h"
#include "run/attempt_files.h"
#include "run/stage_main.h"
#include "store/atomic_file.h"
#include "trust/bundle.h"

using namespace runcert;

int main(int argc, char** argv) {
    std::string run_dir, truth_file, receiver_id;
    const auto compare = [&](const std::filesystem::path& folder) {
        StageRun run = open_run("compare", folder);
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
    };
    return reader_main(
        argc, argv, compare_program.summary,
        [&](CommandLine& line) {
            line.text("RUN_DIR", run_dir, "folder that certify wrote", CommandLine::required);
            line.text("--truth", truth_file,
                      "the true run: CSV with time_s, east_m, north_m, speed_m_s, as simulate "
                      "writes truth.csv");
            line.text("--receiver", receiver_id,
                      "id of the receiver (default: the first of the attempt)");
            line.footer(
                "For each profile claimed and each method: its best window, its speed in the "
                "certified\nwindow and, with --truth, its errors. Methods: raw positions; v1, v2 "
                "and Kalman filter of\n[DHD22]; fixed-lag smoothers; smoothers with constant and "
                "with Singer acceleration; the\ntrajectory's smoother, batch and robust solution; "
                "where the recording has velocities,\nthese and the enhanced Kalman filter [EKF]; "
                "the measured speed. Nothing is written.");
        },
        [&] { return read_given(run_dir, compare); });
}
