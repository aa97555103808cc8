#pragma once

#include <cmath>

#include "schemas/windows/declared.h"

namespace runcert {

struct Profile;

/// The speed by one of the four definitions that every window has, m/s; Failure for elapsed_time.
double speed_by(const SpeedDefinitions& definitions, SpeedDefinition definition);

/// What a profile looks for.
WindowRule rule_of(const Profile& profile);

/// The speed that a rule counts.
struct RuleFigure {
    double speed_m_s = 0.0;
    double standard_uncertainty_m_s = 0.0;
    std::optional<double> effective_degrees_of_freedom = std::nullopt;  ///< empty: infinite
    double bias_limit_m_s = 0.0;  ///< of a systematic error either way, beside that uncertainty
    std::optional<SpeedEvidence> evidence = std::nullopt;  ///< where all windows have it
};

/// The best window's speed; of several, the mean, its uncertainty taken as if the errors of all
/// were the same. Empty where there are too few.
std::optional<RuleFigure> figure_of(const ProfileWindows& windows);

/// Those of the profile of that id; null where there are none.
const ProfileWindows* windows_of(const Windows& windows, std::string_view profile);

/// Whether the law of propagation and the draws through the same model agree ([GUM-S1] 8).
struct LinearisationJudgement {
    double lower_m_s = 0.0;  ///< the budget's 95 % interval
    double upper_m_s = 0.0;
    bool uncertainty_agrees = false;  ///< both standard uncertainties, within the tolerance
    bool interval_agrees = false;     ///< both intervals, at either end
    bool interval_holds = false;      ///< or the budget's holds that of the draws: the safe side
};

/// Of a window that has the check.
LinearisationJudgement judge_linearisation(const CertifiableWindow& window);

/// Whether a witness and the positions contradict one another: an error of either is more probable
/// than none, or chance makes such a difference less than once in a thousand. Of a file from before
/// errors had a probability, and of positions beside recorded velocities, by the normalised error.
bool contradicts(const WitnessedSpeed& one);

/// What errors of the positions, of any kind, can change the speed by (m/s, k = 2) where a witness
/// agrees with them: the difference, the witness's own uncertainty, and what the two may share.
inline double largest_error_given(const WitnessedSpeed& witness) {
    return std::abs(witness.difference_m_s) +
           2.0 * std::hypot(witness.standard_uncertainty_m_s,
                            witness.shared_standard_uncertainty_m_s);
}

/// What is stated with a speed: `coverage_factor` standard uncertainties and, added to them, the
/// limit of a bias that is not known better.
template <class Speed>
double expanded_uncertainty_m_s(const Speed& speed, double coverage_factor) {
    return coverage_factor * speed.standard_uncertainty_m_s + speed.bias_limit_m_s;
}

/// The same with the coverage factor that the rule's stands for at the speed's degrees of freedom.
double expanded_uncertainty_by_rule_m_s(const CertifiableWindow& window, double rule_factor);
double expanded_uncertainty_by_rule_m_s(const RuleFigure& figure, double rule_factor);

}  // namespace runcert
