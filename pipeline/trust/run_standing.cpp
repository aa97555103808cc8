#include "trust/run_standing.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "schemas/verdict/declared.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "trust/signature_files.h"
#include "trust/verification.h"

namespace runcert {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

std::int64_t keys_with(const std::vector<GivenAnswer>& answers, std::string_view word,
                       bool vouched) {
    std::set<std::string> keys;
    for (const GivenAnswer& answer : answers)
        if (answer.counts && answer.answer == word && (answer.vouched || !vouched))
            keys.insert(answer.key);
    return static_cast<std::int64_t>(keys.size());
}

ClauseStanding standing_of(const DueClause& due, const Attestations& attestations) {
    ClauseStanding clause{.due = due};
    for (const GivenAnswer& answer : attestations.answers)
        if (answer.profile == due.profile && answer.clause == due.clause)
            clause.answers.push_back(answer);
    const std::int64_t yes = keys_with(clause.answers, answer_yes, false);
    clause.missing = std::max<std::int64_t>(0, due.answered_by.count - yes);
    clause.refused = keys_with(clause.answers, answer_no, false) > 0;
    clause.contradicted = clause.refused && yes > 0;
    clause.vouched = keys_with(clause.answers, answer_yes, true) >= due.answered_by.count;
    return clause;
}

/// How many signatures that the report needs are not there.
std::int64_t missing_signatures(const ReportFacts& report, const std::vector<Signer>& signers) {
    if (report.required.empty()) return std::ranges::none_of(signers, &Signer::valid) ? 1 : 0;
    std::int64_t missing = 0;
    for (const RoleState& role : fill_roles(report.required, signers))
        missing += static_cast<std::int64_t>(role.needed - role.there);
    return missing;
}

struct SignaturesLeft {
    std::int64_t missing = 0;
    std::int64_t unvouched = 0;
};

/// A signature that does not hold counts as missing, whatever else there is.
SignaturesLeft signatures_left(const ReportFacts& report, const std::vector<Signer>& signers,
                               const SignatureRules& rules) {
    std::vector<Signer> there = signers;
    if (!rules.roster)
        for (Signer& signer : there)
            signer.valid = !signer.broken && !signer.key.empty();
    const std::int64_t missing = missing_signatures(report, there);
    const std::int64_t all = missing_signatures(report, {});
    const std::int64_t broken = std::ranges::count_if(signers, &Signer::broken);
    const bool vouched = rules.vouches();
    return {.missing = missing + broken, .unvouched = vouched ? 0 : all - missing};
}

Standing summed(const std::vector<ClauseStanding>& clauses, const SignaturesLeft& signatures) {
    std::int64_t open = 0, refused = 0, unvouched = signatures.unvouched;
    for (const ClauseStanding& clause : clauses) {
        if (clause.refused)
            ++refused;
        else if (clause.missing > 0)
            ++open;
        else if (!clause.vouched)
            ++unvouched;
    }
    Standing standing{.attestations = open, .signatures = signatures.missing};
    if (refused > 0) standing.refused = refused;
    if (unvouched > 0) standing.unvouched = unvouched;
    standing.state = refused > 0                                 ? StandingState::refused
                     : open + signatures.missing + unvouched > 0 ? StandingState::awaiting
                                                                 : StandingState::complete;
    return standing;
}

OutcomeState outcome_of(const Json& profile) {
    const auto read = [](const Json& word, auto value) {
        if (!from_text(word.get<std::string>(), value))
            throw Failure("report.json", fmt::format("it knows no \"{}\"", shown(word.dump())),
                          "The file was changed; take the original");
        return value;
    };
    const auto outcome = read(profile.at("outcome"), Outcome{});
    // Reports of revision 1.0 call it rule_identity.
    const char* const rule = profile.contains("rule") ? "rule" : "rule_identity";
    const auto origin = read(profile.at(rule).at("origin"), RuleOrigin{});
    const bool overridden = profile.contains("overrides") && !profile.at("overrides").empty();
    return {.outcome = outcome,
            .record_named = profile.contains("record"),
            .rule_altered = overridden || origin != RuleOrigin::built_in};
}

std::vector<RuleStanding> read_rules(const ReportFacts& report) {
    std::vector<RuleStanding> rules;
    for (const Json& profile : report.json->at("predicate").at("profiles"))
        rules.push_back(
            {.profile = profile.at("profile").get<std::string>(), .state = outcome_of(profile)});
    return rules;
}

/// Says of superseded/ how many answers to an earlier report lie there, and what only looks like
/// one.
void add_superseded(const fs::path& run_dir, std::vector<std::string>& details) {
    const fs::path folder = run_dir / superseded_folder;
    if (!fs::is_directory(fs::symlink_status(folder))) return;
    std::int64_t answers = 0;
    std::set<std::string> others;
    for (const auto& entry :
         fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied)) {
        const std::string name = entry.path().filename().string();
        const bool is_link = entry.is_symlink();
        if (!is_link && !name.starts_with("answer-")) continue;
        try {
            const EnvelopeFile file{.name = name,
                                    .text = is_link ? "" : read_handwritten(entry.path())};
            if (name.starts_with(envelope_name(envelope_id(file)))) {
                ++answers;
                continue;
            }
        } catch (const Failure&) {
            // No envelope, which is said below.
        }
        others.insert(fmt::format("{} is {}, no answer, and not counted",
                                  shown(entry.path().lexically_relative(run_dir).string()),
                                  is_link ? "a link" : "no envelope"));
    }
    details.insert(details.end(), others.begin(), others.end());
    if (answers > 0)
        details.push_back(
            fmt::format("superseded/: {} to an earlier report, which count for nothing here",
                        counted(answers, "attestation")));
}

VerificationStep step_of(const fs::path& run_dir, const RunStanding& standing) {
    VerificationStep step{.what = "attestations"};
    if (standing.envelopes > 0) step.answer = LayerAnswer::verified;
    for (const std::string& fault : standing.faults)
        step.fail(fault);
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
    add_superseded(run_dir, step.details);
    step.finding =
        step.is(LayerAnswer::not_verified)
            ? "not all are there as they were signed"
            : fmt::format("{}; {} of {} open",
                          step.answer ? counted(static_cast<std::int64_t>(standing.envelopes),
                                                "attestation") +
                                            ", as signed"
                                      : "there are none",
                          counted(open), counted(due, "requirement") + " to be attested");
    return step;
}

}  // namespace

std::vector<std::string> clause_words(const ClauseStanding& clause) {
    const RoleSignatures& needed = clause.due.answered_by;
    std::vector<std::string> words;
    if (clause.contradicted)
        words.emplace_back("contradicted: answered yes and no");
    else if (clause.refused)
        words.emplace_back("answered no");
    else if (clause.missing > 0)
        words.push_back(fmt::format(
            "open: {} answers{}", needed.role,
            needed.count > 1 ? fmt::format(", {} of {} missing", clause.missing, needed.count)
                             : ""));
    else
        words.emplace_back(clause.vouched ? "attested"
                                          : "answered by keys that nobody vouched for");
    for (const GivenAnswer& answer : clause.answers)
        words.push_back(answer_words(answer));
    return words;
}

RunStanding run_standing(const ReportFacts& report, const Attestations& attestations,
                         const std::vector<Signer>& signers, const SignatureRules& rules) {
    RunStanding standing{.recomputations = attestations.recomputations,
                         .faults = attestations.faults,
                         .envelopes = attestations.envelopes};
    const bool vouched = rules.vouches();
    if (vouched) standing.roster_sha256 = sha256_hex(rules.roster->text);
    try {
        standing.rules = read_rules(report);
    } catch (const Json::exception& error) {
        throw Failure(
            "report.json",
            fmt::format("its outcomes cannot be read: {}", escape_for_message(error.what(), 200)),
            "The file was changed or cut off; take the original");
    }
    const SignaturesLeft signatures = signatures_left(report, signers, rules);
    const std::vector<DueClause> due = due_clauses(report);
    for (RuleStanding& rule : standing.rules) {
        for (const DueClause& clause : due)
            if (clause.profile == rule.profile)
                rule.clauses.push_back(standing_of(clause, attestations));
        rule.state.standing = summed(rule.clauses, signatures);
        rule.state.vouched = vouched;
    }
    return standing;
}

RunStanding stated_standing(const std::filesystem::path& run_dir, const ReportFacts& report,
                            std::optional<Roster> roster) {
    const auto latest = [](UtcSecond& time, const std::string& text) {
        if (const auto stated = parse_iso_utc(text)) time = std::max(time, *stated);
    };
    SignatureRules rules;
    UtcSecond time{std::chrono::days(1)};  // the first that ssh-keygen takes
    rules.present = rules.at = time;
    for (const GivenAnswer& answer : judge_attestations(run_dir, report, rules).answers)
        latest(time, answer.time);
    for (const Signer& signer : verify_signatures(run_dir, report, rules).signers)
        latest(time, signer.stated_time);
    rules.roster = std::move(roster);
    rules.present = rules.at = time;
    return run_standing(report, judge_attestations(run_dir, report, rules),
                        verify_signatures(run_dir, report, rules).signers, rules);
}

std::vector<std::string> standing_lines(const RunStanding& standing, bool all_holds) {
    std::vector<std::string> lines;
    for (const RuleStanding& rule : standing.rules)
        lines.push_back(
            all_holds || rule.state.standing.state != StandingState::complete
                ? fmt::format("{}: {}. Standing: {}.", rule.profile,
                              outcome_words(rule.state).title, standing_text(rule.state.standing))
                : fmt::format("{}: no standing, since not all above holds.", rule.profile));
    lines.push_back(vouched_words(standing));
    return lines;
}

std::string vouched_words(const RunStanding& standing) {
    if (standing.roster_sha256.empty())
        return "No roster was given: nobody vouches for the keys of who answered or signed.";
    return fmt::format("Keys of the roster with the SHA-256 {} count.", standing.roster_sha256);
}

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
                      .finding = "what is to be attested, or was, cannot be read"};
        layer.step.fail(failure);
    }
    return layer;
}

}  // namespace runcert
