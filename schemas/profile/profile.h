#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/speed_unit.h"
#include "files/document_schema.h"
#include "schemas/common/role_signatures.h"
#include "schemas/profile/declared.h"

namespace runcert {

/// One requirement of a rule.
struct Clause {
    std::string id;
    std::string text;
    std::string source;
    Certainty certainty = Certainty::quoted;
    Computation decided_by = Computation::attest;
    std::optional<double> limit;  ///< that the computation compares with, in `unit`
    std::string unit;
    /// Witnesses that meet it, of those that it does not name by itself: "velocities", "phases".
    std::vector<std::string> accepts = {};
    /// Who answers for it where it is to be attested; of a silent rule the schema's default.
    RoleSignatures answered_by = {};
};

/// How decimal figures are rounded.
struct DecimalRule {
    std::string mode;  ///< "truncate", "nearest"
    std::string unit;
    int decimals = 0;
};

/// What the attempt puts in place of a profile's figure.
struct FigureOverride {
    std::string profile;
    std::string figure;  ///< "margin.value", "clauses.flat-course.limit"
    double rule = 0.0;   ///< the profile's own figure; of an override not yet applied, zero
    double used = 0.0;
    std::string unit;    ///< of both; empty for a pure number
    std::string reason;  ///< empty where none is given
    std::string place;   ///< "file:line:column" of it in the attempt, for messages
};

/// A body's rule for one kind of record, `schemas/profile/v1.yaml`. Speeds in m/s.
struct Profile {
    std::string id;
    std::int64_t revision = 1;
    std::string sha256;  ///< of its text
    RuleOrigin origin = RuleOrigin::own;
    std::string body;
    std::string title;
    WindowKind window_kind = WindowKind::time;
    double duration_s = 0.0;                                     ///< of kind time
    double distance_m = 0.0;                                     ///< of the other kinds
    SpeedDefinition definition = SpeedDefinition::displacement;  ///< elapsed_time of a course
    Dimension dimension = Dimension::horizontal;
    SpeedSource speed_source = SpeedSource::position;
    WindowEnds ends = WindowEnds::epochs;
    bool exact_duration = false;
    std::int64_t windows = 1;   ///< so many that do not overlap; the figure is their mean
    double proximity_m = 50.0;  ///< of an alpha: the ends' distance, and the turn between them
    double turn_deg = 90.0;
    bool repaired_steps = false;  ///< whether a window may hold a step that was bridged
    /// How a recording is cut into runs of the craft.
    struct Runs {
        double start_m_s = 2.0;
        double stop_m_s = 1.0;
        double stop_s = 5.0;
        double turn_deg = 90.0;
    };
    Runs runs = {};
    /// Two runs in opposite directions that begin within this; the figure is the mean of the two.
    std::optional<double> opposite_runs_within_s;
    std::optional<double> accuracy_limit_m_s;
    std::string accuracy_unit;     ///< unit the limit is written in
    double coverage_factor = 2.0;  ///< k of the expanded uncertainty
    MarginKind margin_kind = MarginKind::absolute;
    double margin = 0.0;                    ///< m/s, a fraction, or s
    std::string margin_unit;                ///< that it is written in; empty for a fraction
    bool margin_above_upper_limit = false;  ///< of the record's own interval
    std::optional<DecimalRule> rounding;    ///< of the required speed
    std::optional<DecimalRule> result;      ///< of the speed itself, as the body writes it
    double decision_probability = 0.975;
    std::vector<RoleSignatures> signatures;  ///< of a report under this rule
    bool subtract_current = false;
    /// How the uncertainty of the speed is made up.
    struct Uncertainty {
        double tau_min_s = 0.5;   ///< correlation time of a time-correlated position error: from
        double tau_max_s = 10.0;  ///< and to
        bool subtract_selection_bias = true;  ///< else it is covered by the uncertainty
        /// Smallest standard deviation of such an error (m), by fix type.
        std::map<std::string, double> error_floor_m;
        /// That positions err unseen in 3 s, where the rule says so.
        std::optional<double> fault_probability = std::nullopt;
    };
    Uncertainty uncertainty = {};
    std::vector<Clause> clauses;
    std::vector<FigureOverride> overrides;  ///< that were applied
};

/// What a computation compares with: whether the figure may be at most the clause's limit, and the
/// units that the limit may have; none where it takes no limit.
struct ClauseLimit {
    bool at_most = true;
    std::vector<std::string_view> units;
};
ClauseLimit limit_of(Computation computation);

/// "3 s", "500 m over the course": what the rule averages over.
std::string window_words(const Profile& profile);

/// The unit that the rule writes speeds in.
std::string rule_unit_name(const Profile& profile);

/// Puts a figure of the attempt in place of the profile's, and notes it. Failure, at the override's
/// place, for a figure that the profile does not have, or a value outside its range.
void override_figure(Profile& profile, FigureOverride figure);

const DocumentSchema& profile_schema();

/// Reads and checks a profile; Failure with file, line and column on any deviation.
Profile read_profile(std::string_view text, const std::string& where);

/// Failure where a profile of one's own has the id of a rule that comes with the program: a title
/// would then speak of a body's rule that is not the body's.
void require_own_id(const Profile& profile, const std::string& where);

/// The text of the profile of that name that comes with the program ("nalsa", "fisly"); empty if
/// there is none.
std::string_view builtin_profile(std::string_view name);

/// Who answers for a clause whose rule does not say.
RoleSignatures default_answerer();

/// What the program itself asks under every rule, beside the rule's clauses.
const std::vector<Clause>& own_clauses();

/// The names of all of them, in alphabetical order.
std::vector<std::string> builtin_profiles();

}  // namespace runcert
