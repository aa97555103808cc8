#pragma once

#include "stages/check/check.h"
#include "stages/check/course.h"
#include "stages/check/decision.h"
#include "stages/check/declared_agreement.h"
#include "stages/check/wind.h"
#include "witness/runs.h"

namespace runcert {

/// The run that holds the window, and what the data say of the course; or why they say nothing.
struct CourseFindings {
    std::optional<CourseFacts> facts;
    std::optional<CraftRun> run;
    std::string missing;
};

/// One profile's figures, gathered for its clauses. Speeds in m/s.
struct ClauseContext {
    const CheckInput& input;
    const Profile& profile;
    const ProfileWindows& windows;
    std::optional<DeclaredAgreement> declared = std::nullopt;  ///< where a method is declared
    double coverage_factor = 2.0;
    /// What the rule counts: of its windows, less the current where it subtracts that.
    std::optional<SpeedPosterior> speed = std::nullopt;
    std::optional<double> expanded_uncertainty_m_s = std::nullopt;
    const Record* record = nullptr;
    std::optional<Threshold> required_speed = std::nullopt;
    std::optional<Decision> decision = std::nullopt;
    std::optional<ShownFigures> shown = std::nullopt;  ///< where there is a speed
    CourseFindings course = {};
    /// Of the window, beside its positions, in words: those that agree and are sure enough to
    /// confirm it; and those that agree and are not.
    std::vector<std::string> witnesses = {};
    std::vector<std::string> unsure_witnesses = {};
    bool observed = false;  ///< whether a receiver's recording is among the first
    std::optional<FlowInWindow> wind = std::nullopt;
    std::optional<FlowInWindow> current = std::nullopt;
};

/// What a computation finds of a clause.
struct Finding {
    RequirementStatus status = RequirementStatus::not_met;
    std::string evidence;
    std::vector<Figure> figures = {};
    bool observed = false;  ///< met by what was observed alone, whatever else is stated
};

/// Decides one clause by the computation it names. What that finds met is only to be attested where
/// it rests on something that nobody observed: the evidence then says on what.
Requirement decide_clause(const Clause& clause, const ClauseContext& context);

/// A function for each word of the profile's schema: what decides the clause.
namespace computation {
#define RUNCERT_DECLARE(word) Finding word(const Clause& clause, const ClauseContext& context);
RUNCERT_EACH_COMPUTATION(RUNCERT_DECLARE)
#undef RUNCERT_DECLARE
}  // namespace computation

}  // namespace runcert
