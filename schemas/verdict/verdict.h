#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/common/window_span.h"

namespace runcert {

/// A quantity with its expanded uncertainty (k = 2), for people.
struct Figure {
    std::string name;
    double value = 0.0;
    std::string unit = {};                                      ///< empty for a pure number
    std::optional<double> expanded_uncertainty = std::nullopt;  ///< empty where none is known
    std::string note = {};
};

/// Whether a clause of a rule is fulfilled.
struct Requirement {
    std::string clause;
    std::string status;  ///< "met", "not_met", "attest"
    std::string evidence;
    std::string text;
    std::string source;
    std::string certainty;  ///< "quoted", "secondary", "unconfirmed"
    /// These since revision 1.1: what decided it, the figures that it compared, and its limit.
    std::string decided_by = {};
    std::vector<Figure> figures = {};
};

/// A figure of the profile that the attempt replaced.
struct Override {
    std::string figure;
    double rule = 0.0;
    double used = 0.0;
    std::string unit;    ///< empty for a pure number
    std::string reason;  ///< empty where none is given
};

/// A run of the craft, as the profile cuts them.
struct RunSummary {
    WindowSpan span;
    double length_m = 0.0;
    double top_speed_mps = 0.0;
    double heading_deg = 0.0;  ///< from its beginning to its end, from north
    std::string began;         ///< "standing", "turn", "recording", "gap"
    std::string ended;
};

/// How the outcome was decided ([JCGM106]).
struct Decision {
    double probability = 0.0;  ///< that the speed reaches the one to reach
    double level = 0.0;        ///< that acceptance needs
    double target_standard_uncertainty_mps = 0.0;
    double acceptance_limit_mps = 0.0;  ///< least speed that would be accepted
    /// That the outcome is wrong; empty where nothing can be certified, and before revision 1.2.
    std::optional<double> risk = std::nullopt;
    /// These since revision 1.3.
    std::int64_t attempts_made = 1;  ///< that this is the best of
    double bias_limit_mps = 0.0;     ///< of the bias of choosing the window, either way
    /// How far the positions may drift over the window, against the craft's motion, before the
    /// speed is no longer above the one to reach; of a speed that is.
    std::optional<double> drift_survived_m = std::nullopt;
    /// The rate of the smallest drift beside the window that screening finds with its power.
    std::optional<double> drift_found_mps = std::nullopt;
};

/// Figures as they are to be read: rounded after the decision, towards the safe side.
struct ShownFigures {
    std::string unit;
    std::string speed;                 ///< rounded down
    std::string expanded_uncertainty;  ///< rounded up
    std::string target;                ///< rounded up; empty where no record is named
};

/// The fastest window of the raw positions, where it is not the certified one.
struct RefusedWindow {
    WindowSpan span;
    double speed_mps = 0.0;
    std::vector<std::string> refusals;
};

struct RecordToBeat {
    double speed = 0.0;
    std::string unit;
    std::string source;
    double speed_mps = 0.0;
    /// k = 2, in that unit; since revision 1.1, and of a profile's record only.
    std::optional<double> expanded_uncertainty = std::nullopt;
};

struct ProfileVerdict {
    std::string profile;
    std::string body;
    std::string title;
    std::string outcome;  ///< "beaten", "not_beaten", "not_proven", "not_certifiable"
    std::string reason;   ///< the outcome in one sentence
    std::string definition;
    double coverage_factor = 2.0;
    std::optional<double> speed_mps;
    std::optional<double> expanded_uncertainty_mps;
    std::optional<double> target_mps;
    std::optional<WindowSpan> window;
    std::vector<Requirement> requirements;
    std::optional<RefusedWindow> indicated;
    /// These since revision 1.1.
    std::optional<RecordToBeat> record = std::nullopt;  ///< that the outcome is about
    std::optional<Decision> decision = std::nullopt;
    std::optional<ShownFigures> shown = std::nullopt;
    /// Component of the current along the course, where the rule subtracts it.
    std::optional<double> current_subtracted_mps = std::nullopt;
    std::vector<std::string> notes = {};  ///< what must be read with this verdict
    std::vector<Override> overrides = {};
    std::vector<Figure> course = {};  ///< of course and craft, from the data
    std::vector<RunSummary> runs = {};
    /// What else than the positions was heard of the window; empty: by positions alone. Since
    /// revision 1.3.
    std::vector<std::string> witnesses = {};
};

/// 6-verdict.yaml, `schemas/verdict/v1.yaml`.
struct Verdict {
    Header header;
    std::string attempt;
    std::string receiver;
    bool georeferenced = true;
    std::optional<RecordToBeat> record;
    std::vector<std::string> statements;
    std::vector<ProfileVerdict> profiles;
};

std::string write_verdict(const Verdict& verdict);
Verdict read_verdict(std::string_view text, const std::string& where);

}  // namespace runcert
