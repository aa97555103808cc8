#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/common/window_span.h"

namespace runcert {

/// Whether a clause of a rule is fulfilled.
struct Requirement {
    std::string clause;
    std::string status;  ///< "met", "not_met", "attest"
    std::string evidence;
    std::string text;
    std::string source;
    std::string certainty;  ///< "quoted", "secondary", "unconfirmed"
};

/// The fastest window of the raw positions, where it is not the certified one.
struct RefusedWindow {
    WindowSpan span;
    double speed_mps = 0.0;
    std::vector<std::string> refusals;
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
};

struct RecordToBeat {
    double speed = 0.0;
    std::string unit;
    std::string source;
    double speed_mps = 0.0;
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
