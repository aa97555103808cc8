#include "trust/run_standing.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "schemas/verdict/declared.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "store/utc_second.h"
#include "trust/signature_files.h"
#include "trust/verification.h"

namespace runcert {
namespace {

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

/// Sets whether the statements of these keys close the run, and what they say otherwise than it is.
void set_closing(RunStanding& standing, const std::vector<Signer>& signers, const Roster& roster) {
    standing.roster_sha256 = sha256_hex(roster.text);
    const std::vector<GivenAnswer>& all = standing.given.whole;
    std::vector<EvidenceFile>& there = standing.to_close = standing.given.files;
    for (const Signer& signer : signers)
        if (signer.valid) there.push_back({signer.file, signer.sha256});
    const auto has = [](const std::vector<EvidenceFile>& files, const std::string& sha256) {
        return std::ranges::find(files, sha256, &EvidenceFile::sha256) != files.end();
    };
    std::vector<const GivenAnswer*> latest;
    for (const GivenAnswer& one : all)
        if (one.vouched && !one.closes.empty() &&
            std::ranges::none_of(all, [&](const GivenAnswer& other) {
                return other.vouched && has(other.closes, one.sha256);
            }))
            latest.push_back(&one);
    std::vector<std::string>& words = standing.closing;
    if (latest.empty())
        words = {"Not closed: " + roster.closing_role() +
                 " closes it, runcert attest RUN --close."};
    if (latest.size() > 1)
        words = {"Several closing statements, of which none names the others: close again."};
    if (latest.size() != 1) return;
    const GivenAnswer& by = *latest.front();
    for (const EvidenceFile& file : there)
        if (file.sha256 != by.sha256 && !has(by.closes, file.sha256))
            words.push_back(shown(file.name) +
                            " lies here, but the close does not list it: close again.");
    for (const EvidenceFile& file : by.closes)
        if (!has(there, file.sha256))
            words.push_back(shown(file.name) +
                            " is listed by the close, but is missing, changed or not counted.");
    standing.closed = words.empty();
    if (standing.closed) {
        constexpr std::size_t date = 10;
        standing.closed_by =
            fmt::format("Closed by {} ({}), {}.", by.role, by.who, by.time.substr(0, date));
        words = {
            fmt::format("Closed by {} ({}), {}, with the key {}. Later answers show only where "
                        "the body keeps them.",
                        by.role, by.who, by.time, by.key)};
    }
}

/// Sets whose keys fill which roles. Returns by whose roster they do, for the headline.
std::string set_roles(RunStanding& standing, const std::vector<Signer>& signers) {
    std::map<std::string, std::set<std::string>> holders_of, roles_of;
    const auto add = [&](const std::string& role, const std::string& who, const std::string& key) {
        holders_of[role].insert(who.empty() ? key : who);
        roles_of[key].insert(role);
    };
    for (const auto* list : {&standing.given.answers, &standing.given.whole})
        for (const GivenAnswer& one : *list)
            if (one.vouched) add(one.role, one.who, one.key);
    for (const Signer& signer : signers)
        if (signer.valid) add(signer.role, signer.who, key_identity(signer));
    for (const auto& [role, who] : holders_of)
        standing.roles += fmt::format("{} {} {}", standing.roles.empty() ? ":" : ",", role,
                                      listed({who.begin(), who.end()}));
    std::string shared;
    for (const auto& [key, roles] : roles_of)
        if (roles.size() > 1)
            shared += fmt::format("; one key is {}", listed({roles.begin(), roles.end()}));
    standing.roles += shared;
    return fmt::format("by the roster {}: compare it with your body's{}",
                       short_fingerprint(standing.roster_sha256), shared);
}

Standing summed(const std::vector<ClauseStanding>& clauses, const SignaturesLeft& signatures,
                bool closed) {
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
    if (standing.state == StandingState::complete && !closed) {
        standing.state = StandingState::awaiting;
        standing.unclosed = 1;
    }
    return standing;
}

/// Whether officials of the roster answered for every second file, and none said no. The results
/// with these files then take the place of those without.
bool second_files_count(const ReportFacts& report, const Attestations& attestations) {
    if (report.verdict->with_files.empty()) return false;
    const std::vector<std::string>& files = report.verdict->second_files;
    return std::ranges::all_of(due_clauses(report), [&](const DueClause& due) {
        if (std::find(files.begin(), files.end(), due.clause) == files.end()) return true;
        const ClauseStanding clause = standing_of(due, attestations);
        return clause.vouched && !clause.refused;
    });
}

std::vector<RuleStanding> read_rules(const ReportFacts& report, bool with_files) {
    std::vector<RuleStanding> rules;
    for (const ProfileVerdict& rule :
         with_files ? report.verdict->with_files : report.verdict->profiles)
        rules.push_back({.profile = rule.profile, .state = state_of(rule)});
    return rules;
}

/// The body's word on the record that stands goes before the attempt's.
void compare_record(RuleStanding& rule, const ReportFacts& report, const Roster& roster) {
    const StandingRecord* const stands = roster.record_of(
        rule.profile,
        report.json->at("predicate").at("attempt").at("craft_class").get<std::string>());
    const auto verdict =
        std::ranges::find(report.verdict->profiles, rule.profile, &ProfileVerdict::profile);
    if (stands == nullptr || verdict == report.verdict->profiles.end() || !verdict->record) return;
    constexpr double as_written = 1e-6;  // by conversions between units
    if (std::abs(verdict->record->speed_m_s / stands->speed_m_s - 1.0) < as_written) return;
    Standing& standing = rule.state.standing;
    standing.other_record = fmt::format("{} ({})", stands->shown, stands->source);
    if (standing.state == StandingState::complete) standing.state = StandingState::awaiting;
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
            const std::string text = is_link ? "" : read_handwritten(entry.path());
            if (name.starts_with(
                    envelope_name(attestation_id(read_envelope(text, name).payload)))) {
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
    const Attestations& given = standing.given;
    if (given.envelopes > 0) step.answer = LayerAnswer::verified;
    for (const std::string& fault : given.faults)
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
    for (const GivenAnswer& one : given.whole)
        step.details.push_back(fmt::format("{}: {}", one.file, answer_words(one)));
    add_superseded(run_dir, step.details);
    step.finding =
        step.is(LayerAnswer::not_verified)
            ? "not all are there as they were signed"
            : fmt::format("{}; {} of {} open",
                          step.answer
                              ? counted(static_cast<std::int64_t>(given.envelopes), "attestation") +
                                    ", as signed"
                              : "there are none",
                          counted(open), counted(due, "requirement") + " to be attested");
    return step;
}

/// "28 Nov" of "2026-11-28T...".
std::string day_and_month(const std::string& time) {
    const auto at = parse_iso_utc(time);
    return at ? fmt::format("{:%d %b}", *at) : time;
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

std::string clause_mark_text(const ClauseStanding& clause) {
    const RoleSignatures& needed = clause.due.answered_by;
    if (clause.missing > 0 && !clause.refused)
        return fmt::format("☐ open: {}", needed.count > 1
                                             ? fmt::format("{} of {} {}s", clause.missing,
                                                           needed.count, needed.role)
                                             : needed.role);
    const std::string_view counted_answer = clause.refused ? answer_no : answer_yes;
    std::set<std::string> roles, keys;
    const GivenAnswer* latest = nullptr;
    for (const GivenAnswer& answer : clause.answers) {
        if (!answer.counts || answer.answer != counted_answer) continue;
        roles.insert(answer.on_paper ? answer.role + " on paper" : answer.role);
        keys.insert(answer.key);
        if (latest == nullptr || latest->time < answer.time) latest = &answer;
    }
    if (latest == nullptr) return fmt::format("☐ open: {}", needed.role);
    const std::string by = fmt::format("{}{}, {}", fmt::join(roles, ", "),
                                       keys.size() > 1 ? fmt::format(" ({})", keys.size()) : "",
                                       day_and_month(latest->time));
    if (clause.contradicted) return "✗ yes and no: " + by;
    if (clause.refused) return "✗ no by " + by;
    return clause.vouched ? "✓ " + by : "? " + by + ": nobody vouches for the key";
}

RunStanding run_standing(const ReportFacts& report, const Attestations& attestations,
                         const std::vector<Signer>& signers, const SignatureRules& rules) {
    RunStanding standing{.given = attestations};
    if (rules.vouches()) set_closing(standing, signers, *rules.roster);
    const std::string vouched_by = rules.vouches() ? set_roles(standing, signers) : "";
    if (const auto& strangers = attestations.strangers; !strangers.empty())
        standing.closing.push_back(
            fmt::format("{} by keys that are not on the roster, not counted: {}{}.",
                        counted(std::ssize(strangers), "attestation"), strangers.front(),
                        strangers.size() > 1 ? " and others" : ""));
    standing.with_files = second_files_count(report, attestations);
    standing.rules = read_rules(report, standing.with_files);
    const SignaturesLeft signatures = signatures_left(report, signers, rules);
    const std::vector<DueClause> due = due_clauses(report, standing.with_files);
    for (RuleStanding& rule : standing.rules) {
        for (const DueClause& clause : due)
            if (clause.profile == rule.profile)
                rule.clauses.push_back(standing_of(clause, attestations));
        rule.state.standing = summed(rule.clauses, signatures, standing.closed);
        if (rules.vouches()) compare_record(rule, report, *rules.roster);
        rule.state.vouched_by = vouched_by;
    }
    return standing;
}

RunStanding stated_standing(const std::filesystem::path& run_dir, const ReportFacts& report,
                            std::optional<Roster> roster, std::optional<UtcSecond> at) {
    const auto latest = [](UtcSecond& time, const std::string& text) {
        if (const auto stated = parse_iso_utc(text)) time = std::max(time, *stated);
    };
    SignatureRules rules{.roster = std::move(roster)};
    UtcSecond time{std::chrono::days(1)};  // the first that ssh-keygen takes
    rules.present = rules.at = time;
    const Attestations all = judge_attestations(run_dir, report, rules);
    for (const auto* list : {&all.answers, &all.whole})
        for (const GivenAnswer& answer : *list)
            latest(time, answer.time);
    for (const Signer& signer : verify_signatures(run_dir, report, rules).signers)
        if (signer.known) latest(time, signer.stated_time);
    rules.present = rules.at = at.value_or(time);
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
    lines.insert(lines.end(), standing.closing.begin(), standing.closing.end());
    return lines;
}

std::string short_fingerprint(const std::string& sha256) {
    return fmt::format("{} {}", sha256.substr(0, 4), sha256.substr(4, 4));
}

std::string vouched_words(const RunStanding& standing) {
    if (standing.roster_sha256.empty())
        return "No roster was given: nobody vouches for the keys of who answered or signed.";
    return fmt::format("Keys of the roster with the SHA-256 {} count{}.", standing.roster_sha256,
                       standing.roles);
}

AttestationLayer verify_attestations(const fs::path& run_dir, const ReportFacts& report,
                                     const std::vector<Signer>& signers,
                                     const SignatureRules& rules) {
    AttestationLayer layer;
    try {
        layer.standing =
            run_standing(report, judge_attestations(run_dir, report, rules), signers, rules);
        layer.step = step_of(run_dir, *layer.standing);
    } catch (const ComputerFailure&) {
        throw;
    } catch (const Failure& failure) {
        layer.step = {.what = "attestations",
                      .finding = "what is to be attested, or was, cannot be read"};
        layer.step.fail(failure);
    }
    return layer;
}

}  // namespace runcert
