#include "witness/kinds/wheel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.h"
#include "core/uncertainty.h"
#include "witness/copies.h"
#include "witness/roster.h"
#include "witness/velocity_delay.h"

namespace runcert {
namespace {

/// Least relative uncertainty: no tyre is more repeatable from run to run.
constexpr double least_sigma = 1e-3;
constexpr std::size_t fewest_runs = 2;

/// Two scales of one wheel differ by this much by chance once in a thousand.
constexpr double by_chance = 1e-3;

double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value;
    return sum / static_cast<double>(values.size());
}

constexpr std::size_t fewest_epochs = 30;
constexpr double largest_delay_s = 1.0;
constexpr double delay_step_s = 0.02;

/// Horizontal speed.
double speed_of(const TrackEpoch& epoch) {
    return epoch.velocity_m_s.head<2>().norm();
}

/// How the wheel fits the smoothed speeds at one delay.
struct WheelFit {
    double scale = 1.0;
    double squares = 0.0;  ///< sum of squared residuals, m^2/s^2
    std::size_t epochs = 0;

    double mean_square() const {
        return epochs > 0 ? squares / static_cast<double>(epochs)
                          : std::numeric_limits<double>::infinity();
    }
};

WheelFit fit_at(std::span<const TimedValue> wheel, const Track& track, double delay_s) {
    double cross = 0.0, square = 0.0, smoothed = 0.0;
    WheelFit fit;
    for (const TrackEpoch& epoch : track.epochs) {
        const auto speed = value_at(wheel, epoch.time_s + delay_s, longest_between_speeds_s);
        if (!speed) continue;
        const double of_track = speed_of(epoch);
        cross += *speed * of_track;
        square += *speed * *speed;
        smoothed += of_track * of_track;
        ++fit.epochs;
    }
    if (!(square > 0.0)) return {};
    fit.scale = cross / square;
    fit.squares = std::max(0.0, smoothed - fit.scale * cross);
    return fit;
}

/// The delay of the best fit. It is unknown where the speed hardly changes, or where the best lies
/// at the end of the range. It is then zero, with an uncertainty that covers the range.
velocities::Delay delay_of(std::span<const TimedValue> wheel, const Track& track) {
    // Errors are assumed to last for a second, so the seconds count as independent.
    const double seconds = std::max(
        1.0, static_cast<double>(fit_at(wheel, track, 0.0).epochs) * track.nominal_interval_s);
    const velocities::Delay found = velocities::delay_of(
        [&](double delay_s) { return fit_at(wheel, track, delay_s).mean_square(); }, 0.0,
        largest_delay_s, delay_step_s, seconds);
    const velocities::Delay unknown{.delay_s = 0.0,
                                    .sigma_s = rectangular_uncertainty(largest_delay_s)};
    return found.delay_s && found.sigma_s < unknown.sigma_s ? found : unknown;
}

/// Both path lengths over a span of 3 s or more in which the craft moves fast.
struct FastSpan {
    TimeSpan span;
    Eigen::Vector2d velocities = Eigen::Vector2d::Zero();  ///< sum of the velocities
    double smoothed = 0.0;
    double wheeled = 0.0;

    double ratio() const { return smoothed / wheeled; }
};

std::vector<FastSpan> fast_spans(std::span<const TimedValue> wheel, const Track& track,
                                 double delay_s, double scale) {
    constexpr double span_s = 3.0;
    double fastest = 0.0;
    for (const TrackEpoch& epoch : track.epochs)
        fastest = std::max(fastest, speed_of(epoch));
    std::vector<FastSpan> spans;
    FastSpan open;
    bool is_open = false;
    for (const TrackEpoch& epoch : track.epochs) {
        const auto speed = value_at(wheel, epoch.time_s + delay_s, longest_between_speeds_s);
        if (!speed || speed_of(epoch) < 0.5 * fastest) {
            is_open = false;
            continue;
        }
        if (!is_open) open = {.span = {.first_s = epoch.time_s}};
        is_open = true;
        open.span.last_s = epoch.time_s;
        open.velocities += epoch.velocity_m_s.head<2>();
        open.smoothed += speed_of(epoch);
        open.wheeled += scale * *speed;
        if (epoch.time_s - open.span.first_s < span_s || !(open.wheeled > 0.0)) continue;
        spans.push_back(open);
        is_open = false;
    }
    return spans;
}

std::vector<WheelRun> runs_of(const std::vector<FastSpan>& spans) {
    std::vector<WheelRun> runs;
    FastSpan sum;
    for (const FastSpan& one : spans) {
        if (runs.empty() || one.span.first_s - sum.span.last_s >= between_runs_s) {
            sum = {.span = one.span};
            runs.emplace_back();
        }
        sum.span.last_s = one.span.last_s;
        sum.velocities += one.velocities;
        sum.smoothed += one.smoothed;
        sum.wheeled += one.wheeled;
        runs.back() = {.span = sum.span, .direction = sum.velocities, .scale = sum.ratio()};
    }
    return runs;
}

/// Samples scaled by the fit to the nearest run. A drift of that run's positions proportional to
/// the speed then does not count as an error of the wheel.
std::vector<TimedVelocity<2>> as_fitted(std::vector<TimedVelocity<2>> samples,
                                        const std::vector<WheelRun>& runs) {
    const auto apart_s = [](const WheelRun& run, double time_s) {
        return std::max({0.0, run.span.first_s - time_s, time_s - run.span.last_s});
    };
    if (runs.empty()) return samples;
    for (TimedVelocity<2>& one : samples)
        one.velocity *= std::ranges::min_element(runs, {}, [&](const WheelRun& run) {
                            return apart_s(run, one.time_s);
                        })->scale;
    return samples;
}

/// Standard uncertainty of the scale fitted to all, from the ratios of both path lengths over spans
/// that do not overlap.
double sigma_of_scale(const std::vector<FastSpan>& spans) {
    constexpr double least = 1e-4;
    if (spans.size() < 3) return 0.01;
    std::vector<double> ratios;
    for (const FastSpan& one : spans)
        ratios.push_back(one.ratio());
    const double middle = median(ratios);
    for (double& ratio : ratios)
        ratio = std::abs(ratio - middle);
    const auto count = static_cast<double>(ratios.size());
    const double sd = median(std::move(ratios)) / normal_quantile(0.75);
    return std::max(least, 1.2533 * sd / std::sqrt(count));
}

}  // namespace

WheelMotion::WheelMotion(VelocityWitness<2> motion, std::vector<WheelRun> runs, double sigma_scale,
                         bool calibrated)
    : motion_(std::move(motion)),
      runs_(std::move(runs)),
      sigma_scale_(sigma_scale),
      calibrated_(calibrated) {}

WheelScale WheelMotion::scale_for(double from_s, double to_s,
                                  const PositionVector<2>& displacement_m) const {
    const WheelScale given{.value = 1.0, .sigma = sigma_scale_, .independent = calibrated_};
    if (calibrated_) return given;
    std::vector<double> all, along, against;
    for (const WheelRun& run : runs_) {
        if (run.span.last_s > from_s - between_runs_s && run.span.first_s < to_s + between_runs_s)
            continue;
        all.push_back(run.scale);
        (run.direction.dot(displacement_m) > 0.0 ? along : against).push_back(run.scale);
    }
    if (all.size() < fewest_runs) return given;
    const double middle = mean(all);
    double square = 0.0;
    for (const double scale : all)
        square += (scale - middle) * (scale - middle);
    const auto count = static_cast<double>(all.size());
    const double differ = std::sqrt(square / (count - 1.0) * (1.0 + 1.0 / count)) *
                          student_t_quantile(0.975, count - 1.0) / normal_quantile(0.975);
    const bool both_ways = !along.empty() && !against.empty();
    return {.value = both_ways ? 0.5 * (mean(along) + mean(against)) : middle,
            .sigma = std::hypot(least_sigma, differ),
            .independent = true};
}

std::optional<WitnessedMotion<2>> WheelMotion::between(double from_s, double to_s) const {
    auto motion = motion_.between(from_s, to_s);
    if (!motion) return std::nullopt;
    const WheelScale scale = scale_for(from_s, to_s, motion->displacement_m);
    motion->displacement_m *= scale.value;
    motion->covariance_m2 +=
        scale.sigma * scale.sigma * motion->displacement_m * motion->displacement_m.transpose();
    motion->confirms = scale.independent;
    motion->calibrated_by_positions = !calibrated_;
    return motion;
}

std::optional<double> WheelMotion::path_between(double from_s, double to_s) const {
    const auto path_m = motion_.path_between(from_s, to_s);
    const auto motion = path_m ? motion_.between(from_s, to_s) : std::nullopt;
    if (!motion) return std::nullopt;
    return *path_m * scale_for(from_s, to_s, motion->displacement_m).value;
}

std::optional<WheelWitness> wheel_witness(const WheelSpeeds& speeds,
                                          std::span<const TimedPosition<2>> positions,
                                          const Track& track, double jerk_density) {
    const std::span<const TimedValue> wheel = speeds.m_s;
    const velocities::Delay delay = delay_of(wheel, track);
    const double delay_s = *delay.delay_s;
    const WheelFit fit = fit_at(wheel, track, delay_s);
    if (fit.epochs < fewest_epochs || !(fit.scale > 0.0)) return std::nullopt;
    const double scale = speeds.calibrated_scale.value_or(fit.scale);
    const std::vector<FastSpan> spans = fast_spans(wheel, track, delay_s, scale);
    std::vector<TimedVelocity<2>> samples;
    for (const TimedValue& one : wheel) {
        const TrackEpoch* const at = epoch_near(track, one.time_s - delay_s);
        if (at == nullptr) continue;
        const Eigen::Vector2d velocity = at->velocity_m_s.head<2>();
        if (!(velocity.norm() > 0.0)) continue;
        const std::int64_t stretch =
            samples.empty()
                ? 0
                : samples.back().stretch +
                      (one.time_s - samples.back().time_s > longest_between_speeds_s ? 1 : 0);
        samples.push_back({.time_s = one.time_s,
                           .velocity = scale * one.value * velocity.normalized(),
                           .stretch = stretch});
    }
    if (samples.size() < fewest_epochs) return std::nullopt;
    VelocityErrorModel delay_alone;
    delay_alone.delay_s = delay_s;
    delay_alone.sigma_delay_s = delay.sigma_s;
    delay_alone.density = 0.0;
    std::vector<WheelRun> runs = runs_of(spans);
    const VelocityWitness<2> undisturbed(as_fitted(samples, runs), delay_alone, jerk_density);
    const auto estimated = estimate_velocity_errors<2>(undisturbed, positions, std::nullopt);
    if (!estimated.model.is_known()) return std::nullopt;
    const double rounding_m_s = rectangular_uncertainty(0.5 * scale * resolution_m_s(wheel, 0.0));
    const double step_s =
        (wheel.back().time_s - wheel.front().time_s) / static_cast<double>(wheel.size() - 1);
    const bool made = made_from(wheel, positions, delay_s) == VelocityOrigin::positions ||
                      made_from(undisturbed, rounding_m_s, step_s, positions);
    const bool calibrated = speeds.calibrated_scale.has_value();
    const double sigma_scale = sigma_of_scale(spans);
    return WheelWitness{
        .motion = WheelMotion(VelocityWitness<2>(std::move(samples), estimated.model, jerk_density),
                              std::move(runs), calibrated ? speeds.sigma_calibrated : sigma_scale,
                              calibrated),
        .scale = fit.scale,
        .sigma_scale = sigma_scale,
        .delay_s = delay_s,
        .sigma_delay_s = delay.sigma_s,
        .made_from_positions = made};
}

namespace {

constexpr std::string_view recalibrate =
    "Calibrate the wheel again, with the tyre, pressure and load of the run, and state that scale.";

/// A sentence on a calibrated scale that is not the one with which the wheel fits the positions of
/// the whole recording. Empty if chance alone may part them.
std::string wrong_scale_text(const WheelWitness& wheel, const WheelSpeeds& speeds) {
    const double apart = *speeds.calibrated_scale / wheel.scale - 1.0;
    if (std::abs(apart) <= normal_quantile(1.0 - 0.5 * by_chance) *
                               std::hypot(wheel.sigma_scale, speeds.sigma_calibrated, least_sigma))
        return {};
    return fmt::format(
        " That is {:.1f} % {} than fits the positions of the whole recording, which chance does "
        "not explain. {}",
        100.0 * std::abs(apart), apart > 0.0 ? "more" : "less", recalibrate);
}

/// A sentence on the parameters estimated for a wheel and the scale in use.
std::string wheel_note(const WheelWitness& wheel, const WheelSpeeds& speeds) {
    if (wheel.made_from_positions)
        return "The wheel's speeds keep to the positions more closely than a wheel can: they were "
               "made from them, and were not heard.";
    std::string note = fmt::format(
        "The wheel's speeds, taken {:.3f} s {} (standard uncertainty {:.3f} s), fit the positions "
        "of the recording best when multiplied by {:.5f} (standard uncertainty {:.5f}). ",
        std::abs(wheel.delay_s), wheel.delay_s < 0.0 ? "earlier" : "later", wheel.sigma_delay_s,
        wheel.scale, wheel.sigma_scale);
    if (speeds.calibrated_scale)
        return note +
               fmt::format(
                   "They were multiplied by the calibrated {:.5f} (standard uncertainty {:.5f}).",
                   *speeds.calibrated_scale, speeds.sigma_calibrated) +
               wrong_scale_text(wheel, speeds);
    return note +
           "For a window they count by the scale of the other runs. A wrong scale that "
           "lasts they cannot show.";
}

}  // namespace

namespace witnesses {
namespace {

std::optional<AssessedWitness<2>> make_wheel(const HandedInSeries& given) {
    const WheelSeries& said = given.attempt.wheel.value();
    const WheelSpeeds speeds{
        .m_s = timed_values(given.series),
        .calibrated_scale = said.scale,
        .sigma_calibrated = 0.5 * said.expanded_uncertainty_scale.value_or(0.0)};
    auto wheel = wheel_witness(speeds, given.of_craft, given.track, given.jerk_density);
    if (!wheel) return std::nullopt;
    if (given.of_craft.data() != given.positions.data() &&
        made_from(speeds.m_s, given.positions, wheel->delay_s) == VelocityOrigin::positions)
        wheel->made_from_positions = true;
    const auto original = source_of(speeds.m_s, given.sources, wheel->delay_s);
    return AssessedWitness<2>{
        .kind = WitnessKind::wheel,
        .motion = std::make_shared<const WheelMotion>(std::move(wheel->motion)),
        .note = original ? copy_text("wheel's speeds", *original) : wheel_note(*wheel, speeds),
        .is_copy = wheel->made_from_positions || original};
}

FaultPrior fault_of_wheel(const FaultPrior& /*positions*/) {
    return faults_of_speeds;
}

}  // namespace

extern const WitnessEntry wheel{
    .kind = WitnessKind::wheel,
    .fault = fault_of_wheel,
    .silent =
        "too few of them are at times at which the craft's motion was estimated, or nothing "
        "bounds their errors",
    .remedy = recalibrate,
    .unconfirming =
        "their scale was fitted to the run that it lies in, and takes in whatever drifts there in "
        "proportion to the speed. Hand in two more runs, or state a calibrated scale",
    .screening = ScreeningTest{.reason = Reason::wheel,
                               .hypothesis = Hypothesis::wheel,
                               .single_epochs = false,
                               .only_fast = true},
    .make = make_wheel};

}  // namespace witnesses
}  // namespace runcert
