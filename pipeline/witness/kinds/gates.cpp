#include "witness/kinds/gates.h"

#include <algorithm>
#include <cmath>

#include "witness/copies.h"
#include "witness/roster.h"

namespace runcert {
namespace {

constexpr double farthest_s = 0.25;
/// Standard uncertainty of the speed that the positions give at a gate.
constexpr double sigma_speed_m_s = 0.1;
/// Large, because gates do not observe motion across the course.
constexpr double sigma_across_m = 100.0;

/// The craft's displacement along its way a time after a passage, or before it.
double way_after(const GatePassage& passage, double time_s) {
    return passage.speed_m_s * time_s + 0.5 * passage.acceleration_m_s2 * time_s * time_s;
}
double variance_after(double time_s) {
    return std::pow(sigma_speed_m_s * time_s, 2) +
           std::pow(sigma_jerk_m_s3 * time_s * time_s * time_s / 6.0, 2);
}

}  // namespace

GateWitness::GateWitness(std::vector<GatePassage> passages, const GateErrors& errors)
    : passages_(std::move(passages)), errors_(errors) {}

const GatePassage* GateWitness::nearest(double time_s) const {
    const auto found = std::ranges::min_element(
        passages_, {}, [&](const GatePassage& one) { return std::abs(one.time_s - time_s); });
    if (found == passages_.end() || std::abs(found->time_s - time_s) > farthest_s) return nullptr;
    return &*found;
}

std::optional<WitnessedMotion<2>> GateWitness::between(double from_s, double to_s) const {
    const GatePassage *from = nearest(from_s), *to = nearest(to_s);
    if (from == nullptr || to == nullptr || from >= to || from->stretch != to->stretch)
        return std::nullopt;
    const Eigen::Vector2d way = to->position_m - from->position_m;
    if (!(way.norm() > 0.0)) return std::nullopt;
    const double after_s = to_s - to->time_s, before_s = from_s - from->time_s;
    const double length_m =
        to->distance_m - from->distance_m + way_after(*to, after_s) - way_after(*from, before_s);
    const double variance_m2 = std::pow(errors_.sigma_distance_m, 2) +
                               std::pow(to->lasting_sigma_m - from->lasting_sigma_m, 2) +
                               to->variance_m2 - from->variance_m2 +
                               std::pow(errors_.sigma_time_s, 2) *
                                   (std::pow(from->speed_m_s, 2) + std::pow(to->speed_m_s, 2)) +
                               variance_after(after_s) + variance_after(before_s);
    const Eigen::Vector2d along = way.normalized();
    const Eigen::Vector2d across(-along.y(), along.x());
    WitnessedMotion<2> motion;
    motion.displacement_m = length_m * along;
    motion.covariance_m2 = variance_m2 * along * along.transpose() +
                           sigma_across_m * sigma_across_m * across * across.transpose();
    return motion;
}

bool GateWitness::agrees_too_well() const {
    constexpr double least_of_positions_m = 0.01;
    std::vector<TimedPosition<2>> ends;
    for (const GatePassage& one : passages_)
        ends.push_back({.time_s = one.time_s, .position = one.position_m});
    std::vector<Way> ways;
    for (std::size_t i = 1; i < passages_.size(); ++i) {
        const GatePassage &from = passages_[i - 1], &to = passages_[i];
        ways.push_back({.span = {.first_s = from.time_s, .last_s = to.time_s},
                        .length_m = to.distance_m - from.distance_m,
                        .sigma_m = std::hypot(
                            errors_.sigma_distance_m, least_of_positions_m,
                            errors_.sigma_time_s * std::hypot(from.speed_m_s, to.speed_m_s))});
    }
    return made_from(ways, ends);
}

TimeSpan GateWitness::covered() const {
    if (passages_.empty()) return {};
    return {.first_s = passages_.front().time_s, .last_s = passages_.back().time_s};
}

std::optional<TimeSpan> GateWitness::enclosing(double from_s, double to_s) const {
    const auto after = std::ranges::upper_bound(passages_, from_s, {}, &GatePassage::time_s);
    const auto last = std::ranges::lower_bound(passages_, to_s, {}, &GatePassage::time_s);
    if (after == passages_.begin() || last == passages_.end()) return std::nullopt;
    const GatePassage& first = *std::prev(after);
    if (first.stretch != last->stretch) return std::nullopt;
    return TimeSpan{first.time_s, last->time_s};
}

std::optional<double> GateWitness::path_between(double from_s, double to_s) const {
    const auto motion = between(from_s, to_s);
    if (!motion) return std::nullopt;
    return motion->displacement_m.norm();
}

std::optional<GatePassage> passage_at(const Track& track, double time_s) {
    const TrackEpoch* const at = epoch_near(track, time_s);
    if (at == nullptr) return std::nullopt;
    const double since_s = time_s - at->time_s;
    const Eigen::Vector2d acceleration = at->acceleration_m_s2.head<2>();
    const Eigen::Vector2d velocity = at->velocity_m_s.head<2>() + since_s * acceleration;
    const double speed_m_s = velocity.norm();
    return GatePassage{
        .time_s = time_s,
        .position_m = at->position_m.head<2>() + since_s * at->velocity_m_s.head<2>(),
        .speed_m_s = speed_m_s,
        .acceleration_m_s2 = speed_m_s > 0.0 ? acceleration.dot(velocity) / speed_m_s : 0.0};
}

std::vector<Way> ways_between(const std::vector<GatePassage>& passages) {
    std::vector<Way> ways;
    for (std::size_t i = 1; i < passages.size(); ++i) {
        const GatePassage &from = passages[i - 1], &to = passages[i];
        if (from.stretch == to.stretch)
            ways.push_back({.span = {.first_s = from.time_s, .last_s = to.time_s},
                            .length_m = to.distance_m - from.distance_m});
    }
    return ways;
}

std::optional<GateWitness> gate_witness(std::span<const TimedValue> passages,
                                        const GateErrors& errors, const Track& track) {
    std::vector<GatePassage> passed;
    for (const TimedValue& one : passages)
        if (const auto passage = passage_at(track, one.time_s))
            passed.emplace_back(*passage).distance_m = one.value;
    if (passed.size() < 2) return std::nullopt;
    return GateWitness(std::move(passed), errors);
}

namespace witnesses {
namespace {

std::optional<AssessedWitness<2>> make_gates(const HandedInSeries& given) {
    const GateSeries& said = given.attempt.gates.value();
    const std::vector<TimedValue> passages_m = timed_values(given.series);
    auto gates = gate_witness(passages_m,
                              {.sigma_distance_m = 0.5 * said.expanded_uncertainty_m,
                               .sigma_time_s = 0.5 * said.expanded_uncertainty_s},
                              given.track);
    if (!gates) return std::nullopt;
    std::vector<Way> ways;
    for (std::size_t i = 1; i < passages_m.size(); ++i)
        ways.push_back(
            {.span = {.first_s = passages_m[i - 1].time_s, .last_s = passages_m[i].time_s},
             .length_m = passages_m[i].value - passages_m[i - 1].value});
    const bool made = gates->agrees_too_well() || made_from(ways, given.positions);
    const auto original = source_of(ways, given.sources);
    return AssessedWitness<2>{
        .kind = WitnessKind::gates,
        .motion = std::make_shared<const GateWitness>(*std::move(gates)),
        .note = made ? "The gates agree with the positions better than the errors of either allow: "
                       "they were made from them, and were not heard."
                : original ? copy_text("passages of the gates", *original)
                           : "",
        .is_copy = made || original};
}

FaultPrior fault_of_gates(const FaultPrior& positions) {
    return {.probability = 0.001, .largest_m_s = positions.largest_m_s};
}

}  // namespace

extern const WitnessEntry gates{
    .kind = WitnessKind::gates,
    .fault = fault_of_gates,
    .silent = "fewer than two were passed while the craft's motion was estimated",
    .remedy = "Check the surveyed distances of the gates, and their clock.",
    .make = make_gates};

}  // namespace witnesses
}  // namespace runcert
