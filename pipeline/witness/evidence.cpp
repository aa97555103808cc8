#include "witness/evidence.h"

#include <algorithm>
#include <cmath>

namespace runcert {

std::vector<SpeedBySource> speeds_of(const SpeedEvidence& evidence, double speed_m_s,
                                     WitnessSet set) {
    const double slow_m_s = evidence.slow_standard_uncertainty_m_s;
    const double own_square =
        std::pow(evidence.position_standard_uncertainty_m_s, 2) - slow_m_s * slow_m_s;
    std::vector<SpeedBySource> speeds{{.speed_m_s = speed_m_s,
                                       .own_m_s = std::sqrt(std::max(0.0, own_square)),
                                       .slow_m_s = slow_m_s,
                                       .fault = {.probability = evidence.chosen_fault_probability,
                                                 .largest_m_s = evidence.fault_m_s,
                                                 .upwards_alone = evidence.fault_upwards_alone}}};
    for (const WitnessEvidence& one : evidence.witnesses)
        if (set == WitnessSet::all || origin_of(one.kind).front() == "observed")
            speeds.push_back(
                {.speed_m_s = speed_m_s - one.difference_m_s,
                 .own_m_s = one.own_standard_uncertainty_m_s,
                 .slow_m_s = one.slow_standard_uncertainty_m_s,
                 // Phases come from the positions' own antenna.
                 .slow_differs = one.kind != WitnessKind::phases,
                 .fault_is_common = one.calibrated_by_positions,
                 .fault = {.probability = one.fault_probability, .largest_m_s = one.fault_m_s}});
    return speeds;
}

SpeedMixture mixture_of(const SpeedEvidence& evidence, double speed_m_s, WitnessSet set,
                        double also_m_s) {
    return SpeedMixture(speeds_of(evidence, speed_m_s, set),
                        std::hypot(evidence.shared_standard_uncertainty_m_s, also_m_s));
}

}  // namespace runcert
