#pragma once

#include <string>
#include <vector>

#include "schemas/verdict/declared.h"

// What a rule's outcome and its standing are called, and what they rest on, on every page.

namespace runcert {

/// Where a requirement is known from: "WSSRC rules, edition 2019, 3.2; looked at 2026-11-27".
std::string source_text(const Requirement& requirement);

/// Counts what people must still answer for: requirements to be attested among these, and the
/// signatures that attempt and rule require of a report (a verdict has none yet).
Standing standing_of(const std::vector<Requirement>& requirements, std::int64_t signatures);

/// The craft's own speed where the antenna's was judged and exceeds the record, but the craft's,
/// with all of its uncertainty, stays below what is required; nothing else.
const Figure* slower_craft(const ProfileVerdict& verdict);

/// What a title speaks of.
struct OutcomeState {
    Outcome outcome = Outcome::not_certifiable;
    Standing standing = {};
    bool record_named = false;
    bool craft_too_slow = false;  ///< as `slower_craft` has it
    bool rule_altered = false;    ///< figures replaced by the attempt, or a rule of its own
    /// "by the roster 4a84 9c1e: compare it with your body's"; empty where none vouches for keys.
    std::string vouched_by = {};
};
OutcomeState state_of(const ProfileVerdict& verdict);

/// " under altered rules" of a speed that was not judged by the body's own rule; else empty.
std::string altered_text(const OutcomeState& state);

/// An outcome as people read it.
struct OutcomeWords {
    std::string title;
    std::string mark;  ///< a sign beside the title: "✓"
    std::string tone;  ///< how a page colours it: "yes", "open", "no" or "refused"
};

/// "Record beaten, by the roster ..." only where the measurement says so, the rule is the body's
/// own and all of it was attested, signed and closed by keys that the reader's roster vouches for;
/// else what was measured, and what it waits for: "Measured speed exceeds the record; 5
/// requirements still to be attested".
OutcomeWords outcome_words(const OutcomeState& state);

/// "rule “nalsa”, revision 1", "the attempt's own rule “x”, revision 1".
std::string rule_identity_text(const ProfileVerdict& verdict);

/// "The result rests on positions alone: a drift below 1.7 km/h could not have been seen." Of a
/// verdict that has such a drift, in its rule's unit.
std::string positions_alone_text(const ProfileVerdict& verdict);

/// "complete", or "awaiting 5 attestations and 2 signatures; 1 requirement answered no".
std::string standing_text(const Standing& standing);

/// What one origin says: "Claimed", and what.
struct InputsOfOrigin {
    std::string label;
    std::string text;
};

/// What the figures of a verdict rest on, by who says it: each input with its value, several of one
/// part of the attempt by their number. Origins that say nothing are left out.
std::vector<InputsOfOrigin> inputs_by_origin(const std::vector<VerdictInput>& inputs);

}  // namespace runcert
