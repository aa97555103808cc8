#include "witness/evidence.h"

#include <algorithm>
#include <cmath>

namespace runcert {

SpeedMixture mixture_of(const SpeedEvidence& evidence, double speed_m_s, WitnessSet heard,
                        double also_m_s) {
    const auto& witness = heard == WitnessSet::all ? evidence.witnesses : evidence.observed;
    const double common_m_s = witness ? witness->common_standard_uncertainty_m_s : 0.0;
    constexpr double least_m_s = 1e-9;
    const auto without_common = [&](double sigma_m_s) {
        return std::sqrt(
            std::max(sigma_m_s * sigma_m_s - common_m_s * common_m_s, least_m_s * least_m_s));
    };
    const SpeedBySource positions{
        .speed_m_s = speed_m_s,
        .standard_uncertainty_m_s = without_common(evidence.position_standard_uncertainty_m_s),
        .fault = {.probability = evidence.chosen_fault_probability,
                  .largest_m_s = evidence.fault_m_s,
                  .upwards_alone = evidence.fault_upwards_alone}};
    std::optional<SpeedBySource> beside;
    if (witness)
        beside = {.speed_m_s = speed_m_s - witness->difference_m_s,
                  .standard_uncertainty_m_s = without_common(witness->standard_uncertainty_m_s),
                  .fault = {.probability = witness->fault_probability,
                            .largest_m_s = witness->fault_m_s}};
    return {positions, beside,
            std::hypot(std::hypot(common_m_s, evidence.shared_standard_uncertainty_m_s), also_m_s)};
}

double least_expanded_m_s(const SpeedEvidence& evidence, double speed_m_s, double alone_m_s) {
    constexpr double coverage = 0.9545;
    SpeedEvidence stated = evidence;
    if (!evidence.witnesses) stated.chosen_fault_probability = evidence.fault_probability;
    const SpeedMixture mixture = mixture_of(stated, speed_m_s, WitnessSet::all);
    const double half_width_m_s = mixture.half_width(speed_m_s, coverage);
    constexpr double rare = 0.05;
    const bool is_likelier = mixture.positions_at_fault() >
                             (evidence.witnesses ? evidence.chosen_fault_probability : rare);
    return is_likelier ? half_width_m_s : std::min(half_width_m_s, alone_m_s);
}

}  // namespace runcert
