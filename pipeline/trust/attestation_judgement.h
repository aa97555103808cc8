#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "schemas/common/role_signatures.h"
#include "trust/attestation.h"
#include "trust/report_facts.h"
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

/// All of a report, in its order. Failure where its requirements cannot be read.
std::vector<DueClause> due_clauses(const ReportFacts& report);

/// One answer of one envelope. Of "recomputed and agreed" it has no clause.
struct GivenAnswer {
    std::string file{};  ///< the envelope, from the run folder on
    std::string profile{};
    std::string clause{};
    std::string answer{};
    std::string role{};
    std::string who{};  ///< as the roster calls the key's holder
    std::string key{};  ///< "TYPE BASE64"
    std::string time{};
    std::string statement{};
    std::vector<std::string> evidence{};  ///< names, as their owner called them
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
    std::vector<GivenAnswer> answers{};         ///< by time, as their signers state it
    std::vector<GivenAnswer> recomputations{};  ///< the same
    std::vector<std::string> faults{};          ///< a line each: what is not as it was signed
};

/// Reads and judges all attestations of a run. A fault is an envelope that does not hold, is of
/// another report, or whose evidence, or whose earlier neighbours, are not there as they were.
/// An answer that holds counts where its role is the clause's, its key the roster's for that role
/// (without a roster: any), it answers what is due, and its signer did not take it back; beside a
/// fault none does. Failure
/// where the report's requirements cannot be read.
Attestations judge_attestations(const std::filesystem::path& run_dir, const ReportFacts& report,
                                const SignatureRules& rules);

}  // namespace runcert
