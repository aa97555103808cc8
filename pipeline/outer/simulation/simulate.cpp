#include "simulation/simulate.h"

#include <algorithm>
#include <cmath>

#include "core/angle.h"
#include "core/failure.h"
#include "core/random.h"

namespace runcert {
namespace {

void require_valid(const SimulationSpec& spec) {
    require_valid(spec.run);
    if (spec.run.rate_hz <= 0 || interval_ms(spec.run) <= 0 || duration_ms(spec.run) <= 0)
        throw Failure("simulation", "the duration or the interval of the epochs is not positive",
                      "Give both in whole milliseconds");
    for (const double sigma_m :
         {spec.white_noise.horizontal_m, spec.white_noise.vertical_m,
          spec.correlated_error.horizontal_m, spec.correlated_error.vertical_m})
        if (!(sigma_m >= 0.0))
            throw Failure("simulation", "a standard deviation is negative or no number",
                          "Give standard deviations of 0 or more");
    if (!(spec.correlated_error.correlation_time_s > 0.0))
        throw Failure("simulation", "the correlation time is not positive",
                      "Give the time in which the correlation falls by e");
}

/// White noise and first-order Gauss-Markov error, one epoch after the other.
class ErrorSequence {
  public:
    explicit ErrorSequence(const SimulationSpec& spec)
        : random_(static_cast<std::uint64_t>(spec.seed)),
          white_(axes(spec.white_noise)),
          correlated_(axes(spec.correlated_error)) {
        // [YSM22], first-order Gauss-Markov: phi = exp(-dt / tau), q = sigma^2 (1 - phi^2).
        const double steps = static_cast<double>(interval_ms(spec.run)) / 1000.0 /
                             spec.correlated_error.correlation_time_s;
        phi_ = std::exp(-steps);
        root_q_over_sigma_ = std::sqrt(-std::expm1(-2.0 * steps));
    }

    Eigen::Vector3d next() {
        const Eigen::Vector3d white = white_.cwiseProduct(draw());
        const Eigen::Vector3d fresh = draw();
        // The first is of the steady state, so that the sequence has no beginning.
        state_ = first_ ? fresh : Eigen::Vector3d(phi_ * state_ + root_q_over_sigma_ * fresh);
        first_ = false;
        return white + correlated_.cwiseProduct(state_);
    }

  private:
    template <class Error>
    static Eigen::Vector3d axes(const Error& sigmas) {
        return {sigmas.horizontal_m, sigmas.horizontal_m, sigmas.vertical_m};
    }
    Eigen::Vector3d draw() {
        Eigen::Vector3d deviates;
        for (double& deviate : deviates)
            deviate = random_.normal();
        return deviates;
    }

    RandomGenerator random_;
    Eigen::Vector3d white_;
    Eigen::Vector3d correlated_;
    double phi_ = 0.0;
    double root_q_over_sigma_ = 0.0;
    Eigen::Vector3d state_ = Eigen::Vector3d::Zero();  ///< of unit standard deviation
    bool first_ = true;
};

template <class Stretch>
bool any_contains(const std::vector<Stretch>& stretches, double time_s) {
    return std::ranges::any_of(stretches,
                               [&](const Stretch& stretch) { return contains(stretch, time_s); });
}

template <class Offset>
Eigen::Vector3d enu_m(const Offset& offset) {
    return {offset.east_m, offset.north_m, offset.up_m};
}

Eigen::Vector3d displacement_by(const Faults& faults, const SimulatedEpoch& epoch) {
    Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
    for (const OutlierFault& outlier : faults.outliers)
        if (outlier.epoch == epoch.epoch) sum_m += enu_m(outlier);
    for (const StepFault& step : faults.steps)
        if (epoch.time_s() >= step.time_s) sum_m += enu_m(step);
    for (const RampFault& ramp : faults.ramps)
        sum_m += std::clamp(epoch.time_s() - ramp.from_s, 0.0, ramp.to_s - ramp.from_s) *
                 Eigen::Vector3d(ramp.east_m_s, ramp.north_m_s, ramp.up_m_s);
    return sum_m;
}

/// The craft's motion with an IMU that has no errors.
InertialRunSpec craft_run(const SimulationSpec& spec) {
    const SimulatedCraft& craft = spec.craft.value();
    return {.course = craft.course == CraftCourse::oval ? InertialCourse::oval
                                                        : InertialCourse::salt_lake,
            .run = spec.run,
            .origin = spec.place.value(),
            .duration_s = spec.run.duration_s,
            .start_m = craft.start_on_oval_m,
            .roll_deg = craft.roll.amplitude_deg,
            .roll_hz = craft.roll.frequency_hz,
            .pitch_deg = craft.pitch.amplitude_deg,
            .pitch_hz = craft.pitch.frequency_hz,
            .leeway_deg = craft.leeway_deg,
            .antenna_m = vector_of(craft.antenna),
            .reference_point_m = vector_of(craft.reference_point),
            .position_hz = static_cast<int>(spec.run.rate_hz),
            .seed = static_cast<std::uint64_t>(spec.seed)};
}

void add_craft(const InertialTruth& truth, SimulatedEpoch& epoch) {
    epoch.true_enu_m = truth.antenna_m;
    epoch.craft = {.antenna_velocity_m_s = truth.antenna_velocity_m_s,
                   .antenna_acceleration_m_s2 = truth.antenna_acceleration_m_s2,
                   .reference_point_m = truth.reference_point_m,
                   .reference_velocity_m_s = truth.reference_velocity_m_s,
                   .attitude = euler_angles(truth.imu.enu_from_body)};
}

}  // namespace

RunState logistic_run(const LogisticRun& run, double time_s) {
    require_valid(run);
    const double A = run.top_speed_m_s;
    const double t0 = run.half_speed_time_s;
    const double c = A / run.start_speed_m_s - 1.0;  // exp(r t0), as r = ln(A / v0 - 1) / t0
    const double r = std::log(c) / t0;
    const double u = r * (time_s - t0);
    // [DHD22] writes acceleration and jerk with cosh u and sinh u, which overflow far from t0.
    // With e = exp(-|u|): 1 + cosh u = (1 + e)^2 / (2 e), and sinh u / (1 + cosh u) =
    // +-(1 - e) / (1 + e).
    const double e = std::exp(-std::abs(u));
    const double one_over_1_plus_cosh = 2.0 * e / ((1.0 + e) * (1.0 + e));
    const double sinh_over_1_plus_cosh = std::copysign((1.0 - e) / (1.0 + e), u);
    return {
        .distance_m = A * (time_s + std::log((1.0 + c * std::exp(-r * time_s)) / (1.0 + c)) / r),
        .speed_m_s = A / (1.0 + std::exp(-u)),
        .acceleration_m_s2 = A * r / 2.0 * one_over_1_plus_cosh,
        .jerk_m_s3 = -A * r * r / 2.0 * sinh_over_1_plus_cosh * one_over_1_plus_cosh};
}

Eigen::Vector3d direction_of(const LogisticRun& run) {
    const double bearing = Angle::from_degrees(run.bearing_deg).radians();
    return {std::sin(bearing), std::cos(bearing), 0.0};
}

std::vector<SimulatedEpoch> simulate(const SimulationSpec& spec) {
    require_valid(spec);
    const Eigen::Vector3d travel = direction_of(spec.run);
    const Eigen::Vector3d start_m = enu_m(spec.run.start);
    const std::int64_t last_ms = duration_ms(spec.run), step_ms = interval_ms(spec.run);
    const std::vector<InertialTruth> craft =
        spec.craft ? simulate_inertial(craft_run(spec)).truth : std::vector<InertialTruth>{};
    ErrorSequence errors(spec);
    std::vector<SimulatedEpoch> epochs;
    epochs.reserve(static_cast<std::size_t>(last_ms / step_ms) + 1);
    for (std::int64_t time_ms = 0; time_ms <= last_ms; time_ms += step_ms) {
        SimulatedEpoch epoch{.epoch = static_cast<std::int64_t>(epochs.size()) + 1,
                             .time_ms = time_ms};
        epoch.truth = logistic_run(spec.run, epoch.time_s());
        epoch.true_enu_m = start_m + epoch.truth.distance_m * travel;
        if (spec.craft) add_craft(craft.at(epochs.size()), epoch);
        epoch.measured_enu_m =
            epoch.true_enu_m + errors.next() + displacement_by(spec.faults, epoch);
        epoch.fixed = !any_contains(spec.faults.float_fixes, epoch.time_s());
        epoch.recorded = !any_contains(spec.faults.gaps, epoch.time_s());
        epochs.push_back(epoch);
    }
    return epochs;
}

std::vector<ImuSample> simulate_imu(const SimulationSpec& spec, const ImuNoise& noise) {
    require_valid(spec);
    InertialRunSpec run = craft_run(spec);
    run.duration_s += 1.0;  // the IMU is switched off after the receiver
    run.noise = noise;
    run.imu_hz = static_cast<int>(spec.imu.value().rate_hz);
    run.scale_sigma = spec.imu->scale_error;
    std::vector<ImuSample> samples = simulate_inertial(run).samples;
    for (ImuSample& sample : samples)
        sample.time_s += spec.imu->late_s;
    return samples;
}

std::vector<InertialTruth> course_of(const SimulationSpec& spec) {
    require_valid(spec);
    InertialRunSpec run = craft_run(spec);
    run.position_hz = 400;
    return simulate_inertial(run).truth;
}

std::vector<double> simulate_wheel(const SimulatedWheel& wheel, std::uint64_t seed,
                                   std::span<const SimulatedEpoch> epochs) {
    RandomGenerator random(seed + 3'000'003);  // another sequence than those of positions and IMU
    std::vector<double> speeds_m_s;
    for (const SimulatedEpoch& epoch : epochs) {
        const double true_m_s = epoch.craft ? epoch.craft->reference_velocity_m_s.head<2>().norm()
                                            : epoch.truth.speed_m_s;
        const double turning_m_s = true_m_s + wheel.noise_m_s * random.normal();
        speeds_m_s.push_back(std::max(0.0, turning_m_s) / wheel.scale);
    }
    return speeds_m_s;
}

}  // namespace runcert
