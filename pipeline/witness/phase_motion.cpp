#include "witness/phase_motion.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "satellites/line_of_sight.h"

namespace runcert {
namespace {

/// Largest drift of a receiver's clock between two epochs some seconds apart. Jumps are whole
/// milliseconds.
constexpr double largest_drift_s = 2e-4;

/// Index of the first axis: east (followed by north), or up.
template <int Axes>
constexpr int first_axis = Axes == 1 ? 2 : 0;

}  // namespace

template <int Axes>
PhaseWitness<Axes>::PhaseWitness(std::shared_ptr<const JudgedPhases> phases, double first_epoch_s,
                                 std::vector<FrameTurn> turns, double jerk_density)
    : phases_(std::move(phases)),
      first_epoch_s_(first_epoch_s),
      turns_(std::move(turns)),
      jerk_density_(jerk_density) {
    const auto& epochs = phases_->record.epochs;
    std::vector<double> steps_s;
    for (std::size_t k = 1; k < epochs.size(); ++k)
        steps_s.push_back(record_time_s(k) - record_time_s(k - 1));
    if (!steps_s.empty()) nominal_step_s_ = median(std::move(steps_s));
}

template <int Axes>
double PhaseWitness<Axes>::record_time_s(std::size_t epoch) const {
    return static_cast<double>(phases_->record.epochs[epoch].time_ns) * 1e-9;
}

template <int Axes>
std::optional<std::size_t> PhaseWitness<Axes>::nearest(double record_s) const {
    const auto& epochs = phases_->record.epochs;
    const auto time_ns = static_cast<std::int64_t>(std::llround(record_s * 1e9));
    const auto after = std::ranges::lower_bound(epochs, time_ns, {}, &PhaseEpoch::time_ns);
    auto found = after;
    if (after == epochs.end() ||
        (after != epochs.begin() && time_ns - (after - 1)->time_ns < after->time_ns - time_ns)) {
        if (after == epochs.begin()) return std::nullopt;
        found = after - 1;
    }
    const double apart_s = std::abs(static_cast<double>(found->time_ns - time_ns)) * 1e-9;
    constexpr double half_and_rounding = 0.51;
    if (apart_s > half_and_rounding * nominal_step_s_) return std::nullopt;
    return static_cast<std::size_t>(found - epochs.begin());
}

template <int Axes>
std::optional<WitnessedDisplacement> PhaseWitness<Axes>::displacement(std::size_t first,
                                                                      std::size_t second) const {
    auto found = displacement_between(phases_->record, phases_->screening, first, second);
    const double by_tags_s = record_time_s(second) - record_time_s(first);
    if (!found || std::abs(found->interval_s - by_tags_s) > largest_drift_s) return std::nullopt;
    // Scales the displacement from the true interval to the time requested.
    found->enu_m *= by_tags_s / found->interval_s;
    return found;
}

template <int Axes>
std::optional<typename PhaseWitness<Axes>::Instant> PhaseWitness<Axes>::instant_at(
    double time_s) const {
    const double at_s = time_s + first_epoch_s_;
    const auto epoch = nearest(at_s);
    if (!epoch) return std::nullopt;
    Instant instant{.epoch = *epoch};
    const double beyond_s = at_s - record_time_s(*epoch);
    constexpr double same_s = 1e-6;
    if (std::abs(beyond_s) <= same_s) return instant;
    if (*epoch == 0 || *epoch + 1 == phases_->record.epochs.size()) return std::nullopt;
    const auto before = displacement(*epoch - 1, *epoch);
    const auto after = displacement(*epoch, *epoch + 1);
    if (!before || !after) return std::nullopt;
    const double h0 = record_time_s(*epoch) - record_time_s(*epoch - 1);
    const double h1 = record_time_s(*epoch + 1) - record_time_s(*epoch);
    const Eigen::Vector3d v0 = before->enu_m / h0, v1 = after->enu_m / h1;
    const Eigen::Vector3d velocity = (v0 * h1 + v1 * h0) / (h0 + h1);
    const Eigen::Vector3d acceleration = 2.0 * (v1 - v0) / (h0 + h1);
    instant.beyond_m = beyond_s * velocity + 0.5 * beyond_s * beyond_s * acceleration;
    // Variance of the velocity from the differences to both neighbours: their noise, and a white
    // jerk in between.
    const double h = std::max(h0, h1);
    constexpr double of_jerk = 1.0 / 20.0;
    const double noise_m2 = (before->covariance_m2.trace() + after->covariance_m2.trace()) / 3.0;
    instant.variance_m2 =
        beyond_s * beyond_s *
        (noise_m2 / (h * h) + jerk_density_ * jerk_density_ * h * h * h * of_jerk);
    return instant;
}

template <int Axes>
Eigen::Matrix3d PhaseWitness<Axes>::turn_at(std::size_t epoch) const {
    const double at_s = record_time_s(epoch) - first_epoch_s_;
    const auto after =
        std::upper_bound(turns_.begin() + 1, turns_.end(), at_s,
                         [](double time_s, const FrameTurn& turn) { return time_s < turn.from_s; });
    return (after - 1)->enu_from_ecef *
           receiver_position(phases_->record.epochs[epoch].receiver_m).enu_from_ecef.transpose();
}

template <int Axes>
std::optional<WitnessedMotion<Axes>> PhaseWitness<Axes>::between(double from_s, double to_s) const {
    const auto from = instant_at(from_s);
    const auto to = instant_at(to_s);
    if (!from || !to || from->epoch >= to->epoch) return std::nullopt;
    const auto found = displacement(from->epoch, to->epoch);
    if (!found) return std::nullopt;
    const Eigen::Matrix3d turn = turn_at(from->epoch);
    const Eigen::Vector3d displacement_m = turn * (found->enu_m + to->beyond_m - from->beyond_m);
    const Eigen::Matrix3d covariance_m2 = turn * found->covariance_m2 * turn.transpose();
    constexpr int first = first_axis<Axes>;
    WitnessedMotion<Axes> motion;
    motion.displacement_m = displacement_m.template segment<Axes>(first);
    motion.covariance_m2 = covariance_m2.template block<Axes, Axes>(first, first) +
                           (from->variance_m2 + to->variance_m2) * PositionMatrix<Axes>::Identity();
    motion.satellites = static_cast<std::int64_t>(found->satellites);
    return motion;
}

template <int Axes>
TimeSpan PhaseWitness<Axes>::covered() const {
    if (phases_->record.epochs.empty()) return {};
    return {.first_s = record_time_s(0) - first_epoch_s_,
            .last_s = record_time_s(phases_->record.epochs.size() - 1) - first_epoch_s_};
}

template <int Axes>
std::optional<double> PhaseWitness<Axes>::path_between(double from_s, double to_s) const {
    const auto from = instant_at(from_s);
    const auto to = instant_at(to_s);
    if (!from || !to || from->epoch >= to->epoch) return std::nullopt;
    constexpr int first = first_axis<Axes>;
    double path_m = 0.0;
    const Eigen::Matrix3d turn = turn_at(from->epoch);
    const auto length_of = [&](const Eigen::Vector3d& enu_m) {
        return (turn * enu_m).eval().template segment<Axes>(first).norm();
    };
    for (std::size_t k = from->epoch; k < to->epoch; ++k) {
        const auto step = displacement(k, k + 1);
        if (!step) return std::nullopt;
        path_m += length_of(step->enu_m);
    }
    const auto ends_m = [&](const Instant& instant, double asked_s) {
        const double sign = asked_s + first_epoch_s_ < record_time_s(instant.epoch) ? -1.0 : 1.0;
        return sign * length_of(instant.beyond_m);
    };
    return path_m + ends_m(*to, to_s) - ends_m(*from, from_s);
}

template <int Axes>
PhaseInterruptions PhaseWitness<Axes>::interruptions(double from_s, double to_s) const {
    const auto from = nearest(from_s + first_epoch_s_);
    const auto to = nearest(to_s + first_epoch_s_);
    if (!from || !to) return {};
    const auto inside = [&](const auto& one) { return one.epoch > *from && one.epoch <= *to; };
    return {.slips = std::ranges::count_if(phases_->screening.slips, inside),
            .refusals = std::ranges::count_if(phases_->screening.refusals, inside)};
}

template class PhaseWitness<1>;
template class PhaseWitness<2>;

}  // namespace runcert
