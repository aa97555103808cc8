#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "trust/run_standing.h"
#include "trust/signature_files.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// Answers to an earlier report, which this one replaced.
std::ptrdiff_t superseded_answers(const fs::path& run_dir) {
    const fs::path folder = run_dir / superseded_folder;
    if (!fs::is_directory(fs::symlink_status(folder))) return 0;
    return std::ranges::count_if(fs::recursive_directory_iterator(folder), [](const auto& entry) {
        return entry.path().filename().string().starts_with("answer-");
    });
}

VerificationStep step_of(const fs::path& run_dir, const RunStanding& standing) {
    VerificationStep step{
        .passed = standing.faults.empty(), .what = "attestations", .finding = {}, .details = {}};
    std::int64_t due = 0, open = 0;
    for (const RuleStanding& rule : standing.rules)
        for (const ClauseStanding& clause : rule.clauses) {
            ++due;
            open += clause.missing > 0 ? 1 : 0;
            const std::string name = shown(rule.profile + "/" + clause.due.clause);
            for (const std::string& words : clause_words(clause))
                step.details.push_back(fmt::format("{}: {}", name, words));
        }
    for (const GivenAnswer& one : standing.recomputations)
        step.details.push_back(fmt::format("{}: {}", one.file, answer_words(one)));
    if (const auto count = superseded_answers(run_dir); count > 0)
        step.details.push_back(
            fmt::format("superseded/: {} to an earlier report, which count for nothing here",
                        counted(count, "attestation")));
    step.details.insert(step.details.begin(), standing.faults.begin(), standing.faults.end());
    if (!step.passed) {
        step.finding = "not all are there as they were signed";
    } else {
        step.checked = standing.envelopes > 0;
        step.passed = step.checked;
        step.finding = fmt::format(
            "{}; {} of {} open",
            step.checked ? counted(static_cast<std::int64_t>(standing.envelopes), "attestation") +
                               ", as signed"
                         : "there are none",
            counted(open), counted(due, "requirement") + " to be attested");
    }
    return step;
}

}  // namespace

AttestationLayer verify_attestations(const fs::path& run_dir, const ReportFacts& report,
                                     const std::vector<Signer>& signers,
                                     const SignatureRules& rules) {
    AttestationLayer layer;
    try {
        layer.standing =
            run_standing(report, judge_attestations(run_dir, report, rules), signers, rules);
        layer.step = step_of(run_dir, *layer.standing);
    } catch (const Failure& failure) {
        layer.step = {.what = "attestations",
                      .finding = "what is to be attested, or was, cannot be read",
                      .details = {shown(fs::path(failure.where()).filename().string()) + ": " +
                                  failure.problem()}};
    }
    return layer;
}

}  // namespace runcert
