#pragma once

#include "estimation/tables/runs.h"
#include "stages/check/agreement.h"
#include "stages/check/course.h"
#include "stages/check/decision.h"
#include "stages/check/declared_agreement.h"
#include "stages/check/wind.h"

namespace runcert {

/// The run that holds the window, and what the data say of the course; or why they say nothing.
struct CourseEvidence {
    std::optional<CourseFacts> facts;
    std::optional<CraftRun> run;
    std::string missing;
};

/// One profile's figures, gathered for its clauses. Speeds in m/s.
struct ClauseContext {
    const CheckInput& input;
    const Profile& profile;
    const ProfileWindows& windows;
    std::optional<Agreement> agreement = std::nullopt;         ///< where there is a second receiver
    std::optional<DeclaredAgreement> declared = std::nullopt;  ///< and where a method is declared
    double coverage_factor = 2.0;
    /// What the rule counts: of its windows, less the current where it subtracts that.
    std::optional<SpeedPosterior> speed = std::nullopt;
    std::optional<double> expanded_uncertainty_mps = std::nullopt;
    const Record* record = nullptr;
    std::optional<Threshold> target = std::nullopt;
    std::optional<Decision> decision = std::nullopt;
    CourseEvidence course = {};
    std::vector<std::string> witnesses = {};  ///< of the window, beside its positions, in words
    std::optional<FlowInWindow> wind = std::nullopt;
    std::optional<FlowInWindow> current = std::nullopt;
};

/// What a computation finds of a clause: "met", "not_met", or "attest", which leaves it to a
/// person.
struct Finding {
    std::string status;
    std::string evidence;
    std::vector<Figure> figures = {};
};

/// Decides one clause by the computation it names.
Requirement decide_clause(const Clause& clause, const ClauseContext& context);

/// The computations of course and craft, and those of wind, current, recording and runs, against
/// the clause's limit where it has one. Empty for another name.
std::optional<Finding> course_finding(const Clause& clause, const ClauseContext& context);
std::optional<Finding> recording_finding(const Clause& clause, const ClauseContext& context);

/// The computations of the program's own requirements: where times, kinds of solution and positions
/// come from. Empty for another name.
std::optional<Finding> origin_finding(const Clause& clause, const ClauseContext& context);

/// "232.172 km/h".
std::string in_unit(double speed_mps, const std::string& unit, int decimals);

}  // namespace runcert
