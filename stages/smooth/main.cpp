#include <fmt/format.h>

#include "run/stage_main.h"
#include "stages/smooth/attitude_table.h"
#include "stages/smooth/smooth.h"
#include "witness/surface_input.h"

using namespace runcert;

namespace {

std::string summary_line(const EstimationSummary& estimation) {
    if (estimation.arcs == 0) return "nothing to estimate: no usable stretch";
    const NoiseSummary& noise = estimation.horizontal.noise;
    return fmt::format("noise {} {:.3g} x stated; batch agrees within {:.0e} m",
                       noise.status == NoiseBasis::fitted ? "fitted:" : "not fitted:",
                       noise.measurement_scale.value, estimation.largest_position_difference_m);
}

/// The surface that the receiver's craft runs on; an IMU's attitude is on the Earth, or nowhere.
std::optional<Triangulation> read_surface_of(StageRun& run, const Receiver& receiver,
                                             const std::optional<FrameOrigin>& origin) {
    if (!has_surface(receiver)) return std::nullopt;
    const SurfaceTable table = run.read(products::surface, receiver, read_surface);
    return origin ? std::optional(surface_of(table, origin)) : std::nullopt;
}

/// Writes what the IMU says, and returns whether it agrees with the positions.
std::string write_attitude_of(StageRun run, const Receiver& receiver,
                              const TrajectoryTable& trajectory) {
    const ScreenedTable screened = run.read(products::screened, receiver, read_screened);
    const ImuTable imu = run.read(products::imu, receiver, read_imu);
    const Receiver* other = second_on_craft(run.attempt());
    std::optional<ScreenedTable> second;
    if (other && receiver.id != other->id)
        second = run.read(products::screened, *other, read_screened);
    const std::optional<Triangulation> surface = read_surface_of(run, receiver, screened.origin);
    AttitudeTable attitude = attitude_table(
        imu, screened, trajectory,
        second ? std::optional(SecondAntenna{*second, *other->lever_arm}) : std::nullopt,
        surface ? &*surface : nullptr);
    attitude.header = run.header();
    run.write(products::attitude, receiver, write_attitude(attitude));
    return attitude.consistency.reason.empty() ? "IMU and positions agree"
                                               : attitude.consistency.reason;
}

}  // namespace

int main(int argc, char** argv) {
    return stage_main(argc, argv, "smooth",
                      "Position, velocity and acceleration by RTS smoothing and by batch "
                      "least squares, which must agree",
                      [](StageRun& run) {
                          const Attempt& attempt = run.attempt();
                          for (const Receiver& receiver : attempt.receivers) {
                              StageRun one = run;
                              const ScreenedTable screened =
                                  one.read(products::screened, receiver, read_screened);
                              TrajectoryTable table =
                                  smooth_trajectory(screened, smooth_config(attempt));
                              table.header = one.header();
                              one.write(products::trajectory, receiver, write_trajectory(table));
                              run.say(summary_line(table.estimation));
                              if (has_imu(receiver))
                                  run.say(write_attitude_of(run, receiver, table));
                          }
                      });
}
