#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "core/claimed_text.h"
#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"
#include "store/archive.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "trust/attestation.h"
#include "trust/run_standing.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// An envelope whose signature holds.
struct SignedAnswers {
    std::string file{};
    std::string sha256{};  ///< of the file
    std::string id{};
    Attestation said{};
    Signer signer{};  ///< with the roster's word on it
    SshPublicKey key{};
};

std::string shown_of(const Requirement& requirement) {
    std::string shown = requirement.evidence;
    for (const Figure& figure : requirement.figures)
        shown += fmt::format("; {}: {}", figure.name, figure_value_text(figure));
    return shown;
}

/// Takes an envelope apart. Failure where its signature does not hold, and, of keys that the roster
/// has, where it is not one of this report, whose hash is given.
SignedAnswers open_envelope(const EnvelopeFile& file, const ReportFacts& report,
                            const std::string& report_sha256, const SignatureRules& rules) {
    SignedAnswers opened{.file = fmt::format("{}/{}", attestations_folder, file.name),
                         .sha256 = sha256_hex(file.text)};
    const auto refuse = [&](const std::string& problem) {
        throw Failure(opened.file, problem, "Move it away, or bring back the original");
    };
    const Envelope envelope = read_envelope(file.text, opened.file);
    Attestation& said = opened.said = read_statement(envelope.payload, opened.file);
    opened.id = attestation_id(envelope.payload);
    const PublicKey key = parse_public_key(said.key, opened.file);
    if (!envelope_holds(envelope, key) || envelope.key_id != key_id_text(key))
        refuse("it was not signed by the key that it names, or was changed since");
    if (file.name != envelope_name(opened.id)) refuse("it has another name than its statement");
    opened.key = ssh_key_of(key.key);
    opened.signer = judge_by_roster(
        {.file = opened.file, .role = said.role, .key = said.key, .stated_time = said.time},
        opened.key, std::nullopt, rules);
    if (!opened.signer.known) return opened;
    if (said.report_sha256 != report_sha256 || said.report_id != report.report_id ||
        said.attempt_id != report.attempt_id)
        refuse(
            fmt::format("it was signed for another report ({}, attempt {}), and is replayed here",
                        escape_for_message(said.report_id), escape_for_message(said.attempt_id)));
    if (!is_role(said.role)) refuse("it states no role to answer in");
    if (!parse_iso_utc(said.time)) refuse("the time that its signer states cannot be read");
    return opened;
}

/// Notes evidence that is missing or changed, and envelopes by known keys that lay there when this
/// one was signed and are gone.
void check_surroundings(const fs::path& run_dir, const SignedAnswers& one,
                        const std::set<std::string>& ids, const SignatureRules& rules,
                        std::vector<std::string>& faults) {
    std::vector<EvidenceFile> evidence = one.said.evidence;
    if (one.said.on_paper) evidence.push_back(*one.said.on_paper);
    for (const EvidenceFile& file : evidence) {
        const fs::path path = run_dir / attestations_folder / evidence_name(file);
        const bool there =
            is_plain_name(evidence_name(file)) && fs::is_regular_file(fs::symlink_status(path));
        if (!there || digest_file(path).sha256 != file.sha256)
            faults.push_back(fmt::format("{}: its evidence {} is {}", one.file, shown(file.name),
                                         there ? "changed" : "missing"));
    }
    const auto gone = std::ranges::count_if(one.said.after, [&](const EvidenceFile& earlier) {
        if (ids.contains(earlier.sha256)) return false;
        const SshPublicKey key = ssh_key_of(parse_public_key(earlier.name, one.file).key);
        return judge_by_roster({}, key, std::nullopt, rules).known;
    });
    if (gone > 0)
        faults.push_back(fmt::format("{}: when it was signed there {} {} more, now deleted",
                                     one.file, gone == 1 ? "was" : "were",
                                     counted(gone, "attestation")));
}

/// The answers that their signers took back (envelope, rule, clause), with the time.
using TakenBack = std::map<std::tuple<std::string, std::string, std::string>, std::string>;

TakenBack taken_back(const std::vector<SignedAnswers>& all) {
    TakenBack taken;
    for (const SignedAnswers& later : all)
        for (const Answer& answer : later.said.answers) {
            if (answer.answer != answer_withdrawn) continue;
            for (const SignedAnswers& earlier : all)
                if (earlier.key == later.key &&
                    std::ranges::find(later.said.after, earlier.id, &EvidenceFile::sha256) !=
                        later.said.after.end())
                    taken[{earlier.id, answer.profile, answer.clause}] = later.said.time;
        }
    return taken;
}

/// Why an answer does not count, whoever signed it; empty where it does.
std::string objection_to(const Answer& answer, const SignedAnswers& one,
                         const std::vector<DueClause>& due, const TakenBack& taken) {
    const auto clause = std::ranges::find_if(due, [&](const DueClause& each) {
        return each.profile == answer.profile && each.clause == answer.clause;
    });
    if (clause == due.end()) return "nothing of that name is to be attested";
    if (clause->text != answer.text || clause->shown != answer.shown)
        return "its signer was shown other words or figures than the report has";
    if (const auto back = taken.find({one.id, answer.profile, answer.clause}); back != taken.end())
        return "taken back by its signer, " + back->second;
    if (clause->answered_by.role != one.said.role)
        return fmt::format("{} answers for it, not {}", clause->answered_by.role, one.said.role);
    return {};
}

/// Why a statement does not count, whatever it answers; empty where it does.
std::string objection_to(const SignedAnswers& one, const ReportFacts& report,
                         const SignatureRules& rules) {
    if (const auto& until = report.recorded_until;
        until && *parse_iso_utc(one.said.time) + clock_tolerance < *until)
        return "dated before the end of the recording, " + iso_text(*until);
    if (one.said.is_recomputed() && one.said.policies != policies_of(report))
        return "it recomputed by other rules than those of this report";
    const std::string closes = rules.roster ? rules.roster->closing_role() : one.said.role;
    if (one.said.is_closing() && one.said.role != closes)
        return fmt::format("{} closes a run, not {}", closes, one.said.role);
    return rules.roster ? one.signer.reason : "";
}

void object(GivenAnswer& answer, std::string objection) {
    if (objection.empty()) return;
    answer.counts = answer.vouched = false;
    answer.reason = std::move(objection);
}

GivenAnswer given(const SignedAnswers& one, const ReportFacts& report,
                  const SignatureRules& rules) {
    GivenAnswer answer{.file = one.file,
                       .sha256 = one.sha256,
                       .answer = one.said.is_closing() ? "closed" : "recomputed and agreed",
                       .role = one.said.role,
                       .who = one.signer.who,
                       .key = ssh_key_text(one.key),
                       .time = one.said.time,
                       .statement = one.said.statement,
                       .closes = one.said.closes,
                       .on_paper = one.said.on_paper.has_value(),
                       .counts = true,
                       .vouched = rules.vouches()};
    object(answer, objection_to(one, report, rules));
    for (const EvidenceFile& file : one.said.evidence)
        answer.evidence.push_back(claimed_value(file.name));
    return answer;
}

void add_answers(const SignedAnswers& one, const ReportFacts& report,
                 const std::vector<DueClause>& due, const TakenBack& taken,
                 const SignatureRules& rules, Attestations& result) {
    const GivenAnswer whole = given(one, report, rules);
    result.files.push_back({one.file, one.sha256});
    result.before.push_back({one.said.key, one.id});
    if (one.said.answers.empty()) result.whole.push_back(whole);
    for (const Answer& said : one.said.answers) {
        GivenAnswer answer = whole;
        answer.profile = said.profile;
        answer.clause = said.clause;
        answer.answer = said.answer;
        object(answer, objection_to(said, one, due, taken));
        result.answers.push_back(std::move(answer));
    }
}

void add_due(const std::vector<ProfileVerdict>& rules, std::vector<DueClause>& due) {
    for (const ProfileVerdict& rule : rules)
        for (const Requirement& requirement : rule.requirements) {
            if (requirement.status != RequirementStatus::attest) continue;
            const bool known = std::ranges::any_of(due, [&](const DueClause& one) {
                return one.profile == rule.profile && one.clause == requirement.clause;
            });
            if (known) continue;
            const AnsweredBy by = requirement.answered_by.value_or(AnsweredBy{});
            due.push_back({.profile = rule.profile,
                           .clause = requirement.clause,
                           .text = requirement.text,
                           .shown = shown_of(requirement),
                           .answered_by = {by.role, std::max<std::int64_t>(1, by.count)}});
        }
}

}  // namespace

std::vector<DueClause> due_clauses(const ReportFacts& report, std::optional<bool> with_files) {
    std::vector<DueClause> due;
    if (with_files != true) add_due(report.verdict->profiles, due);
    if (with_files != false) add_due(report.verdict->with_files, due);
    return due;
}

std::vector<EvidenceFile> policies_of(const ReportFacts& report) {
    std::vector<EvidenceFile> policies;
    for (const std::string& name : report.subject_names)
        if (name.starts_with("profile.")) policies.push_back({name, report.subjects.at(name)});
    return policies;
}

std::string answer_words(const GivenAnswer& answer) {
    std::string words = answer.answer;
    if (answer.on_paper) words += " on paper, entered";
    words += " by " + answer.role;
    if (!answer.who.empty()) words += fmt::format(" ({})", answer.who);
    words += ", " + answer.time;
    if (!answer.statement.empty()) words += "; " + claimed(answer.statement);
    if (!answer.evidence.empty()) words += "; evidence: " + listed(answer.evidence);
    if (!answer.counts) words += "; not counted: " + answer.reason;
    return words;
}

Attestations judge_attestations(const fs::path& run_dir, const ReportFacts& report,
                                const SignatureRules& rules) {
    const std::vector<DueClause> due = due_clauses(report);
    Attestations result;
    std::vector<SignedAnswers> all;
    std::set<std::string> ids;
    const std::string report_sha256 = sha256_hex(report.text);
    for (const EnvelopeFile& file : envelope_files(run_dir)) {
        ++result.envelopes;
        try {
            SignedAnswers one = open_envelope(file, report, report_sha256, rules);
            ids.insert(one.id);
            if (one.signer.known)
                all.push_back(std::move(one));
            else
                result.strangers.push_back(one.file);
        } catch (const ComputerFailure&) {
            throw;
        } catch (const Failure& failure) {
            result.faults.push_back(
                fmt::format("{}/{}: {}", attestations_folder, file.name, failure.problem()));
        }
    }
    std::ranges::stable_sort(all, {}, [](const SignedAnswers& one) { return one.said.time; });
    const TakenBack taken = taken_back(all);
    for (const SignedAnswers& one : all) {
        check_surroundings(run_dir, one, ids, rules, result.faults);
        add_answers(one, report, due, taken, rules, result);
    }
    if (!result.faults.empty())
        for (auto* answers : {&result.answers, &result.whole})
            for (GivenAnswer& answer : *answers)
                object(answer, "the attestations here are not as they were signed");
    return result;
}

}  // namespace runcert
