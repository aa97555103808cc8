#include "witness/phase_witness.h"

#include <algorithm>
#include <vector>

#include "satellites/phase_displacement.h"
#include "satellites/point_solution.h"

namespace runcert {

std::optional<Eigen::Vector3d> position_by_pseudoranges(const PhaseRecord& record,
                                                        const PhaseEpoch& epoch,
                                                        const Eigen::Vector3d& near_m) {
    std::vector<CodeMeasurement> code;
    for (const PhaseSatellite& satellite : record.of(epoch)) {
        if (!satellite.has_orbit() || !satellite.healthy) continue;
        for (const PhaseSignal& signal : record.of(satellite)) {
            if (!(signal.pseudorange_m == signal.pseudorange_m)) continue;
            code.push_back({.system = satellite.id.system,
                            .satellite_m = satellite.position_m,
                            .pseudorange_m = signal.pseudorange_m + satellite.clock_m -
                                             double{satellite.group_delay_m}});
            break;
        }
    }
    const auto solution = point_solution(code, near_m);
    if (!solution) return std::nullopt;
    return solution->position_m;
}

void locate_by_pseudoranges(PhaseRecord& record) {
    Eigen::Vector3d last_m = Eigen::Vector3d::Zero();
    for (PhaseEpoch& epoch : record.epochs) {
        if (epoch.has_position()) continue;
        if (const auto place_m = position_by_pseudoranges(record, epoch, last_m)) last_m = *place_m;
        epoch.receiver_m = last_m;
    }
}

std::optional<std::size_t> epoch_after(const PhaseRecord& record, std::size_t first,
                                       std::int64_t length_ns) {
    constexpr std::int64_t tolerance_ns = 20'000'000;
    const std::int64_t end_ns = record.epochs[first].time_ns + length_ns;
    const auto found =
        std::ranges::lower_bound(record.epochs, end_ns - tolerance_ns, {}, &PhaseEpoch::time_ns);
    if (found == record.epochs.end() || found->time_ns > end_ns + tolerance_ns) return std::nullopt;
    return static_cast<std::size_t>(found - record.epochs.begin());
}

namespace {

/// The changes of the first-band phases whose arcs span two epochs.
struct SpanningPhases {
    std::vector<PhaseChange> changes;
    std::vector<Satellite> satellites;
};

SpanningPhases phases_between(const PhaseRecord& record, const PhaseScreening& screening,
                              const PhaseEpoch& from, const PhaseEpoch& to) {
    SpanningPhases result;
    const auto later = record.of(to);
    auto other = later.begin();
    for (const PhaseSatellite& one : record.of(from)) {
        while (other != later.end() && other->id < one.id)
            ++other;
        if (other == later.end()) break;
        if (other->id != one.id) continue;
        for (std::size_t i = 0; i < one.signals; ++i) {
            const std::size_t before = one.first_signal + i;
            const PhaseFinding& finding = screening.findings[before];
            if (finding.arc == 0 || finding.supports) continue;
            for (std::size_t j = 0; j < other->signals; ++j) {
                const std::size_t now = other->first_signal + j;
                const PhaseFinding& found = screening.findings[now];
                if (record.signals[now].code != record.signals[before].code ||
                    found.arc != finding.arc)
                    continue;
                const double cycles = record.signals[now].phase_cycles -
                                      record.signals[before].phase_cycles -
                                      (found.correction - finding.correction);
                result.changes.push_back(
                    {.satellite_m = {one.position_m, other->position_m},
                     .clock_m = {one.clock_m, other->clock_m},
                     .phase_m = cycles * wavelength_m(one.id, record.signals[now].code)});
                result.satellites.push_back(one.id);
            }
        }
    }
    return result;
}

double seconds_between(const PhaseEpoch& from, const PhaseEpoch& to) {
    return static_cast<double>(to.time_ns - from.time_ns) * 1e-9;
}

std::optional<PhaseDisplacement> solved(const SpanningPhases& phases,
                                        const PhaseScreening& screening, const PhaseEpoch& from,
                                        const PhaseEpoch& to) {
    const std::size_t count = phases.changes.size();
    if (!from.has_position() || count < least_witnesses || count > most_phase_changes)
        return std::nullopt;
    return phase_displacement(phases.changes, receiver_position(from.receiver_m),
                              seconds_between(from, to), {.white_m = screening.noise.white_m});
}

}  // namespace

std::vector<PhaseResidual> residuals_between(const PhaseRecord& record,
                                             const PhaseScreening& screening, std::size_t first,
                                             std::size_t second) {
    const PhaseEpoch &from = record.epochs[first], &to = record.epochs[second];
    const SpanningPhases phases = phases_between(record, screening, from, to);
    const auto solution = solved(phases, screening, from, to);
    std::vector<PhaseResidual> residuals;
    if (!solution) return residuals;
    for (std::size_t i = 0; i < phases.satellites.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        residuals.push_back({.satellite = phases.satellites[i],
                             .residual_m = solution->residuals_m[k],
                             .sigma_m = solution->sigma_m[k]});
    }
    return residuals;
}

std::optional<WitnessedDisplacement> displacement_between(const PhaseRecord& record,
                                                          const PhaseScreening& screening,
                                                          std::size_t first, std::size_t second) {
    const PhaseEpoch &from = record.epochs[first], &to = record.epochs[second];
    const SpanningPhases phases = phases_between(record, screening, from, to);
    const auto solution = solved(phases, screening, from, to);
    if (!solution) return std::nullopt;
    WitnessedDisplacement result;
    result.enu_m = solution->enu_m;
    const double by_tags_s = seconds_between(from, to);
    const double slow_m = systematic_rate_m_s(phases.changes.size()) * by_tags_s;
    // Residuals reveal phases that are disturbed at either end.
    const double excess = solution->statistic / solution->redundancy;
    result.covariance_m2 = solution->covariance_m2 * std::max(1.0, excess);
    result.covariance_m2.diagonal().head<2>().array() += slow_m * slow_m;
    const double clock_m = screening.clock_m[second] - screening.clock_m[first];
    result.interval_s = clock_m == clock_m ? by_tags_s - clock_m / speed_of_light_m_s : by_tags_s;
    result.satellites = phases.changes.size();
    result.statistic = solution->statistic;
    result.redundancy = solution->redundancy;
    return result;
}

}  // namespace runcert
