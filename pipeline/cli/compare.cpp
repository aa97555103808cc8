#include <CLI/CLI.hpp>

#include "commands.h"

namespace runcert {
namespace {

struct CompareOptions {
    std::string run_dir;
    std::string truth;
    std::string receiver;
};

int compare(const CompareOptions& options) {
    return run_companion("compare", options.run_dir, {},
                         {{"--truth", options.truth}, {"--receiver", options.receiver}});
}

}  // namespace

void add_compare(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand(
        "compare",
        "All estimators' best windows side by side, and against truth where it is known");
    command->add_option("RUN_DIR", options->run_dir, "folder that certify wrote")->required();
    command->add_option("--truth", options->truth,
                        "the true run: CSV with time_s, east_m, north_m, speed_m_s, as simulate "
                        "writes truth.csv");
    command->add_option("--receiver", options->receiver,
                        "id of the receiver (default: the first of the attempt)");
    command->footer(
        "For each profile claimed and each method: its best window, its speed in the certified\n"
        "window and, with --truth, its errors. Methods: raw positions; v1, v2 and Kalman filter "
        "of\n"
        "[DHD22]; fixed-lag smoothers; smoothers with constant and with Singer acceleration; the\n"
        "trajectory's smoother, batch and robust solution; where the recording has velocities,\n"
        "these and the enhanced Kalman filter [EKF]; the measured speed. Nothing is written.");
    command->callback([&chosen, options] { chosen = [options] { return compare(*options); }; });
}

}  // namespace runcert
