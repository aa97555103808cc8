#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "schemas/common/role_signatures.h"
#include "schemas/verdict/outcome.h"
#include "trust/attestation.h"
#include "trust/verification.h"

// Who answered what of a report, and which of it counts.

namespace runcert {

/// A requirement that somebody must answer for, as report.json has it.
struct DueClause {
    std::string profile{};
    std::string clause{};
    std::string text{};
    std::string shown{};  ///< its evidence and figures, in one line
    RoleSignatures answered_by{};
};

/// All requirements of a report to be attested, in its order: before second files count, after, or
/// (without `with_files`) either. Failure where its requirements cannot be read.
std::vector<DueClause> due_clauses(const ReportFacts& report,
                                   std::optional<bool> with_files = std::nullopt);

/// The rules of a report, each with its hash: what a recomputation goes by.
std::vector<EvidenceFile> policies_of(const ReportFacts& report);

/// One answer of one envelope; "recomputed and agreed" and a closing statement have no clause.
struct GivenAnswer {
    std::string file{};    ///< the envelope, from the run folder on
    std::string sha256{};  ///< of that file
    std::string profile{};
    std::string clause{};
    std::string answer{};
    std::string role{};
    std::string who{};  ///< as the roster calls the key's holder
    std::string key{};  ///< "TYPE BASE64"
    std::string time{};
    std::string statement{};
    std::vector<std::string> evidence{};  ///< names, as their owner called them
    std::vector<EvidenceFile> closes{};   ///< what a closing statement names
    bool on_paper = false;
    bool counts = false;
    bool vouched = false;  ///< counts by a roster; else nobody says whose key it is
    std::string reason{};  ///< why it does not count
};

/// "yes by judge (Jane Roe), 2026-11-26T20:12:03Z; evidence: scan.pdf": an answer, without its
/// clause.
std::string answer_words(const GivenAnswer& answer);

struct Attestations {
    std::size_t envelopes = 0;
    std::vector<GivenAnswer> answers{};    ///< by time, as their signers state it
    std::vector<GivenAnswer> whole{};      ///< recomputations and closing statements, the same
    std::vector<std::string> faults{};     ///< what is not as it was signed, a line each
    std::vector<std::string> strangers{};  ///< envelopes by keys that the roster lacks
    std::vector<EvidenceFile> files{};     ///< the others, with their hashes
    std::vector<EvidenceFile> before{};    ///< these, as a later statement names them
};

/// Reads and judges all attestations of a run. A fault is an envelope that does not hold, is of
/// another report, or whose evidence, or whose earlier neighbours, are not there as they were; of
/// keys that the roster lacks only one that does not hold. What holds counts where its role is the
/// clause's, its key the roster's for that role (without a roster: any), it was signed after the
/// recording, answers what is due (recomputed by this report's rules, closes in the roster's role),
/// and its signer did not take it back; beside a fault nothing does. Failure where the report's
/// requirements cannot be read.
Attestations judge_attestations(const std::filesystem::path& run_dir, const ReportFacts& report,
                                const SignatureRules& rules);

/// How a requirement stands that somebody must answer for.
struct ClauseStanding {
    DueClause due{};
    std::vector<GivenAnswer> answers{};  ///< all, also those that do not count
    std::int64_t missing = 0;            ///< yes answers, each by another key
    bool refused = false;                ///< there is a no that counts
    bool contradicted = false;           ///< there are both
    bool vouched = false;                ///< answered yes by enough keys of the roster
};

/// "open: judge answers", "attested", "answered no" and so on, with what was answered.
std::vector<std::string> clause_words(const ClauseStanding& clause);

/// The same in a few words for a first page: "✓ judge, 28 Nov", "☐ open: judge", "✗ no by judge, 28
/// Nov".
std::string clause_mark_text(const ClauseStanding& clause);

struct RuleStanding {
    std::string profile{};
    OutcomeState state{};  ///< of the outcome, with the standing as it is now
    std::vector<ClauseStanding> clauses{};
};

/// Where a run stands: computed from its report.json and the signatures and attestations beside it.
/// Pages, explanation, day and verification all say this.
struct RunStanding {
    std::vector<RuleStanding> rules{};
    bool with_files = false;  ///< officials of the roster answered for all second files
    Attestations given{};
    std::string roster_sha256{};  ///< of the roster that vouches for keys; empty without one
    /// What the one closing statement that no other names must name by hash, and nothing else:
    /// envelopes by keys of the roster, and signatures that count.
    std::vector<EvidenceFile> to_close{};
    bool closed = false;
    std::string closed_by{};             ///< "Closed by board (B), 2026-11-28."; empty where not
    std::vector<std::string> closing{};  ///< by which key, or why not, and what does not count
    std::string roles{};  ///< whose keys fill which: ": board B, judge A and C; one key is ..."
};

/// `signers` are the signatures as judged by the same rules. A rule's standing is complete where
/// each of its requirements to be attested was answered yes, as often as it asks, by different keys
/// of the roster in the role that it names, and nobody there answered no; all signatures that the
/// report needs, one where it names none, stand by keys of that roster; and the run is closed.
/// Failure where the report cannot be read.
RunStanding run_standing(const ReportFacts& report, const Attestations& attestations,
                         const std::vector<Signer>& signers, const SignatureRules& rules);

/// The standing that a run's pages state. It depends on no clock, since a page must come out the
/// same whenever it is made: keys are judged as of the latest time that a signer whose key the
/// roster has states, or as of `at`.
RunStanding stated_standing(const std::filesystem::path& run_dir, const ReportFacts& report,
                            std::optional<Roster> roster, std::optional<UtcSecond> at = {});

/// Whether every attestation in the folder is one of this report, as it was signed, with its
/// evidence and the earlier ones that it names. The details say who answered what and what is open;
/// what is open, answered no or does not count is no fault of the folder.
struct AttestationLayer {
    VerificationStep step{};
    std::optional<RunStanding> standing{};  ///< nothing where the report cannot be read for it
};
AttestationLayer verify_attestations(const std::filesystem::path& run_dir,
                                     const ReportFacts& report, const std::vector<Signer>& signers,
                                     const SignatureRules& rules);

/// "4a84 9c1e": what people compare of a roster's SHA-256.
std::string short_fingerprint(const std::string& sha256);

/// Where each rule stands, a line each, whose keys count, and what closes the run. Where
/// `all_holds` is false, no standing is called complete.
std::vector<std::string> standing_lines(const RunStanding& standing, bool all_holds);

/// By whose word the answers count: "Keys of the roster with the SHA-256 ... count."
std::string vouched_words(const RunStanding& standing);

}  // namespace runcert
