#pragma once

#include <fmt/format.h>

#include <utility>

#include "schemas/attempt/attempt.h"
#include "schemas/verdict/figures.h"
#include "stages/check/check.h"
#include "stages/check/course.h"
#include "stages/check/decision.h"
#include "stages/check/wind.h"
#include "witness/runs.h"

namespace runcert {

/// Comparison of the judged speed with a second method whose result the attempt states.
struct DeclaredAgreement {
    std::string method;
    std::string missing = {};  ///< why it gives no result; empty if it does
    double judged_m_s = 0.0;
    double other_m_s = 0.0;
    double other_expanded_uncertainty_m_s = 0.0;  ///< k = 2
    /// Difference over the root sum of squares of both expanded uncertainties (k = 2). At most 1
    /// means agreement (ISO/IEC 17043).
    double normalised_error = 0.0;

    bool contradicts() const { return missing.empty() && !(normalised_error <= 1.0); }
};

/// Compares the best window's speed, before the current is subtracted, with the attempt's second
/// method: a stated speed or, over a course, that of declared times at its lines, which say nothing
/// of another window, nor of one whose crossings they miss by more than 2 s. Empty without one.
std::optional<DeclaredAgreement> compare_declared(const CertifiableWindow& best,
                                                  const Profile& profile, const Attempt& attempt);

/// Speed through the water over a surveyed course, in m/s: distance over elapsed time, minus the
/// current along the course (positive where it carries the craft forward). Reproduces the 500 m and
/// nautical mile speeds that the WSSRC printed. Failure (at "course") for numbers that are not
/// finite, or a distance or time not above 0.
double course_speed_m_s(double distance_m, double elapsed_s, double current_m_s);

/// The run that contains the window and the facts about its course, or the reason why there are
/// none.
struct CourseFindings {
    std::optional<CourseFacts> facts = std::nullopt;
    std::optional<CraftRun> run = std::nullopt;
    std::string missing = {};
    std::optional<GroundFacts> ground = std::nullopt;  ///< if a surface lies under the whole run
};

/// One profile's figures, gathered to decide its clauses. Speeds are in m/s.
struct ClauseContext {
    const CheckInput& input;
    const Profile& profile;
    const ProfileWindows& windows;
    std::optional<DeclaredAgreement> declared = std::nullopt;  ///< if a method is declared
    double coverage_factor = 2.0;
    /// The speed that the rule counts: of its windows, minus the current where it subtracts that.
    std::optional<SpeedPosterior> speed = std::nullopt;
    std::optional<double> expanded_uncertainty_m_s = std::nullopt;
    const Record* record = nullptr;
    std::optional<Threshold> required_speed = std::nullopt;
    std::optional<Decision> decision = std::nullopt;
    std::optional<ShownFigures> shown = std::nullopt;  ///< if there is a speed
    CourseFindings course = {};
    /// The windows of the speed, the best one first; of that only what all have is in it.
    std::vector<FurtherWindow> counted = {};
    /// Witnesses of the window other than its positions, in words: those that agree and are
    /// accurate enough to confirm it, and those that agree and are not.
    std::vector<std::string> witnesses = {};
    std::vector<std::string> unsure_witnesses = {};
    bool observed = false;       ///< whether `witnesses` includes a receiver's recording
    bool files_attested = true;  ///< whether officials answered for second files
    /// Key of the window's epochs.
    std::string key() const {
        return files_attested && !input.judged.windows.with_files.empty()
                   ? key_with_files(profile.id)
                   : profile.id;
    }
    const std::vector<ScreenedEpoch>& epochs() const { return input.judged.epochs_of(key()); }
    /// The unit of the rule's speeds.
    const SpeedUnit& unit() const { return speed_unit(rule_unit_name(profile)); }
    std::optional<FlowInWindow> wind = std::nullopt;
    std::optional<FlowInWindow> current = std::nullopt;
};

/// Gathers a profile's figures: its windows, the record and the required speed, the conformance
/// probability, course and craft, wind and current, second methods.
ClauseContext gather_context(const CheckInput& input, const Profile& profile,
                             const ProfileWindows& windows, bool files_attested);

/// How a body rounds by such a rule.
StepRounding direction_of(const DecimalRule& rule);

/// A speed as it stands beside the measured one, in the rule's unit: "216.00 km/h".
std::string speed_of_rule(const ClauseContext& context, double speed_m_s,
                          SpeedKind kind = SpeedKind::measured);

/// The same in the rule's unit, beside the verdict's figures (`compared_in`).
ComparedSpeeds compared_speeds(const ClauseContext& context, double other_m_s,
                               double other_expanded_uncertainty_m_s, double judged_m_s);

/// The current that is subtracted, as it is shown: what lies between the speed over the ground and
/// the measured one. Empty if none is.
struct SubtractedCurrent {
    std::string over_ground;  ///< "54.40 kn"
    std::string current;      ///< "+0.10 kn"
};
std::optional<SubtractedCurrent> subtracted_current(const ClauseContext& context);

/// What the second method gives beside the positions, from its first words on. It must give a
/// figure.
std::string second_method_text(const ClauseContext& context);

/// The epochs of each window that makes the figure, without those out of time.
std::vector<std::vector<ScreenedEpoch>> samples_of(const ClauseContext& context);

/// The runs of a recording under the profile's thresholds.
std::vector<CraftRun> runs_under(const Profile& profile, const ReceiverFindings& judged);

/// Whether a second measurement with this expanded uncertainty (k = 2, m/s) could have failed. Its
/// uncertainty must be at most three times that of the positions' speed, or of the margin over the
/// record. A less accurate one agrees with whatever is claimed, and confirms nothing.
bool could_have_failed(double expanded_uncertainty_m_s, const ClauseContext& context);

/// Whether a witness that agrees could have failed.
bool confirms(const WitnessedSpeed& one, const ClauseContext& context);

/// "at ± 9.0 km/h it is too uncertain to confirm", in the rule's unit.
std::string too_uncertain_text(double expanded_uncertainty_m_s, const ClauseContext& context);

/// The result of a witness for the window, in words.
std::string witness_text(const WitnessedSpeed& one, const ClauseContext& context);

/// Over what a witness was compared: "the window", "6.0 s around the window".
std::string span_of(const WitnessedSpeed& one);

/// What a witness of this kind is compared with.
std::string_view compared_with(WitnessKind kind);

/// The name of a witness, with "the".
std::string witness_name(const WitnessedSpeed& one);

/// The fastest speed that the recording shows, certifiable or not, and when, in the rule's unit:
/// "44.12 kn at 10:03:43.0 UTC". The windows must have one.
std::string indicated_text(const ClauseContext& context);

/// The windows of a profile in 5-windows. Failure if they were searched under another rule than
/// the profile now has.
const ProfileWindows& windows_of(const Windows& windows, const Profile& profile,
                                 bool with_files = false);

/// The speed by the rule's own arithmetic, why it differs from the measured one, or why there is
/// none.
OwnArithmetic own_arithmetic(const ClauseContext& context);

/// A computation's finding on a clause.
struct Finding {
    RequirementStatus status = RequirementStatus::not_met;
    std::string evidence;
    std::vector<Figure> figures = {};
    bool observed = false;  ///< met by observed evidence alone, whatever else is stated

    /// The same finding, by these figures.
    Finding by(std::vector<Figure> compared) && {
        figures = std::move(compared);
        return std::move(*this);
    }
};

/// Findings by their evidence: `met("{} s", 3)`. A clause that is met, one that is not, and one
/// that a person attests.
template <RequirementStatus status>
struct FoundBy {
    template <class... Args>
    Finding operator()(fmt::format_string<Args...> evidence, Args&&... args) const {
        return {status, fmt::format(evidence, std::forward<Args>(args)...)};
    }
};
inline constexpr FoundBy<RequirementStatus::met> met;
inline constexpr FoundBy<RequirementStatus::not_met> not_met;
inline constexpr FoundBy<RequirementStatus::attest> to_attest;

/// One that a person attests because the recording does not decide it.
template <class... Args>
Finding unknown(fmt::format_string<Args...> why, Args&&... args) {
    return to_attest("not decidable from the recording: {}",
                     fmt::format(why, std::forward<Args>(args)...));
}

/// Evidence of several clauses where there is nothing to judge.
inline constexpr const char* no_window = "there is no certifiable window";

/// A quantity that is compared with a clause's limit: a speed in m/s, a ratio, or in the limit's
/// own unit.
struct Quantity {
    std::string name;
    double value = 0.0;
    std::optional<double> expanded_uncertainty = std::nullopt;  ///< k = 2
    std::string note = {};
    /// What else decides the clause where the figure is on the right side of its limit, or on the
    /// wrong one: the status, and the words that follow.
    std::optional<Finding> if_met = std::nullopt;
    std::optional<Finding> if_not_met = std::nullopt;
};

/// A quantity in the unit of a clause's limit, of which it is a multiple: m/s, a ratio, or that
/// unit itself.
double in_unit(double value, const std::string& unit);

/// Met or not met where the whole interval is on one side of the clause's limit, by the relation of
/// its computation. Otherwise to be attested. The one place of a figure's words.
Finding against_limit(const Quantity& quantity, const Clause& clause);

/// A figure that is compared with nothing, and one that must be at most a limit.
Figure plain(std::string name, double value, std::string unit = {});
Figure at_most(Figure figure, double limit);

/// A speed as a figure in a unit, with the words in which it is to be read.
Figure speed_figure(std::string name, double speed_m_s, const std::string& unit, std::string shown);

/// Decides one clause by the computation it names. A positive finding that depends on unobserved
/// inputs is only to be attested, and the evidence then names them.
Requirement decide_clause(const Clause& clause, const ClauseContext& context);

/// The clauses required under a rule: its own, and those of this program that the rule lacks and
/// for which the attempt states or hands in something.
std::vector<Clause> clauses_asked(const Profile& profile, const Attempt& attempt);

/// What an official answers for in that clause: stated or handed in, observed by nobody.
std::vector<AttemptInput> inputs_answered_in(const Clause& clause, const ClauseContext& context);

/// Inputs with their values, as evidence.
std::string stated_text(const std::vector<AttemptInput>& inputs);

/// All inputs of an attempt, with the clauses in which an official answers for them.
std::vector<VerdictInput> verdict_inputs(const CheckInput& input);

/// A function for each computation in the profile's schema. It decides the clause.
namespace computation {
#define RUNCERT_DECLARE(word) Finding word(const Clause& clause, const ClauseContext& context);
RUNCERT_EACH_COMPUTATION(RUNCERT_DECLARE)
#undef RUNCERT_DECLARE
}  // namespace computation

}  // namespace runcert
