#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reports/words/outcome.h"
#include "trust/attestation_judgement.h"

namespace runcert {

/// What became of a requirement that somebody must answer for.
struct ClauseStanding {
    DueClause due{};
    std::vector<GivenAnswer> answers{};  ///< all that were given, those that do not count too
    std::int64_t missing = 0;            ///< yes answers, each by another key
    bool refused = false;                ///< there is a no that counts
    bool contradicted = false;           ///< there are both
    bool vouched = false;                ///< answered yes by enough keys of the roster
};

/// "open: judge answers", "attested", "answered no" and so on, with what was answered.
std::vector<std::string> clause_words(const ClauseStanding& clause);

struct RuleStanding {
    std::string profile{};
    OutcomeState state{};  ///< of the outcome, with the standing as it is now
    std::vector<ClauseStanding> clauses{};
};

/// Where a run stands: computed from its report.json and the signatures and attestations beside it.
/// Pages, explanation, day and verification all say this.
struct RunStanding {
    std::vector<RuleStanding> rules{};
    std::vector<GivenAnswer> recomputations{};
    std::vector<std::string> faults{};  ///< of attestations
    std::size_t envelopes = 0;
    std::string roster_sha256{};  ///< of the roster that vouches for keys; empty without one
};

/// With the signatures as they were judged by the same rules. A rule's standing is complete where
/// each of its requirements to be attested was answered yes, as often as it asks, by different keys
/// of the roster in the role that it names, and nobody there answered no; and all signatures that
/// the report needs, one where it names none, stand by keys of that roster. Failure where the
/// report cannot be read.
RunStanding run_standing(const ReportFacts& report, const Attestations& attestations,
                         const std::vector<Signer>& signers, const SignatureRules& rules);

/// The same of a run folder as its pages state it: by no clock, since a page must come out the same
/// whenever it is made. Keys are judged as of the latest time that a signer states.
RunStanding stated_standing(const std::filesystem::path& run_dir, const ReportFacts& report,
                            std::optional<Roster> roster);

/// Whether every attestation in the folder is one of this report, as it was signed, with its
/// evidence, and with the earlier ones that it names. Who answered what is said, what is open too;
/// what is open, or answered no, or does not count is no fault of the folder: the standing says it.
struct AttestationLayer {
    VerificationStep step{};
    std::optional<RunStanding> standing{};  ///< nothing where the report cannot be read for it
};
AttestationLayer verify_attestations(const std::filesystem::path& run_dir,
                                     const ReportFacts& report, const std::vector<Signer>& signers,
                                     const SignatureRules& rules);

/// By whose word the answers count: "by keys of the roster with the SHA-256 ...".
std::string vouched_words(const RunStanding& standing);

}  // namespace runcert
