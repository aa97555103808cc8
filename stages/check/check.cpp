#include "stages/check/check.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/uncertainty.h"
#include "stages/check/decision.h"
#include "stages/check/requirements.h"
#include "stages/check/statements.h"

namespace runcert {
namespace {

const ProfileWindows& windows_of(const Windows& windows, const Profile& profile) {
    for (const ProfileWindows& entry : windows.profiles)
        if (entry.profile == profile.id && entry.duration_s == profile.duration_s &&
            entry.definition == profile.definition)
            return entry;
    throw Failure("5-windows of receiver " + windows.receiver,
                  "the windows were not searched for the profile " + profile.id + " as it is now",
                  "Run runcert-window again");
}

/// Clauses, other than the margin, that the data decide and that are not met.
std::vector<std::string> failed_clauses(const std::vector<Requirement>& requirements,
                                        const Profile& profile) {
    std::vector<std::string> failed;
    for (std::size_t i = 0; i < requirements.size(); ++i)
        if (requirements[i].status == "not_met" && profile.clauses[i].decided_by != "margin")
            failed.push_back(requirements[i].clause + ": " + requirements[i].evidence);
    return failed;
}

/// Why the records that could not be read forbid a certificate; empty where they do not.
std::string refused_for_records(const RecordCount& records, const WindowSpan& window) {
    if (100 * records.bad > records.total)
        return fmt::format(
            "{} of {} records of the recording could not be read, more than 1 %: it is damaged, or "
            "was changed.",
            records.bad, records.total);
    for (const BadRecord& bad : records.bad_records)
        if (bad.epoch >= window.first_epoch && bad.epoch <= window.last_epoch)
            return fmt::format(
                "A record inside the window could not be read ({}{} {}, after epoch {}): {}.",
                bad.file ? fmt::format("file {}, ", *bad.file) : "", bad.line ? "line" : "byte",
                bad.line ? *bad.line : bad.byte, bad.epoch, bad.what);
    if (records.bad > std::ssize(records.bad_records))
        return fmt::format(
            "{} records could not be read, more than are listed, so nobody can tell whether one is "
            "inside the window.",
            records.bad);
    return {};
}

void set_outcome(const ClauseContext& context, ProfileVerdict& verdict) {
    const auto failed = failed_clauses(verdict.requirements, context.profile);
    const auto& record = context.input.attempt.record;
    if (!context.windows.best || !failed.empty()) {
        verdict.outcome = "not_certifiable";
        verdict.reason =
            failed.empty() ? "There is no certifiable window." : "Not met: " + failed.front();
    } else if (const std::string refused =
                   refused_for_records(context.input.judged.records, context.windows.best->span);
               !refused.empty()) {
        verdict.outcome = "not_certifiable";
        verdict.reason = refused;
    } else if (const auto& robust = context.windows.best->robust; robust && !robust->agrees) {
        verdict.outcome = "not_certifiable";
        verdict.reason = fmt::format(
            "A robust estimate over the same epochs gives {:+.3f} km/h against the screened one, "
            "more than their uncertainty of {:.3f} km/h: screening may have kept a wrong epoch or "
            "rejected a right one.",
            robust->difference_mps * 3.6, robust->limit_mps * 3.6);
    } else if (!robust && context.input.judged.estimation.robust_unsolved > 0) {
        verdict.outcome = "not_certifiable";
        verdict.reason =
            "The robust estimate, which is the check on screening, did not converge over the "
            "stretch of this window.";
    } else if (context.agreement && context.agreement->contradicts()) {
        verdict.outcome = "not_certifiable";
        verdict.reason = fmt::format(
            "Receiver \"{}\" gives {:+.3f} km/h over the same time, more than both uncertainties "
            "allow (normalised error {:.2f}): one of the two receivers is wrong.",
            context.input.secondary->receiver,
            (context.agreement->other_mps - context.agreement->judged_mps) * 3.6,
            context.agreement->normalised_error);
    } else if (!record) {
        verdict.outcome = "not_proven";
        verdict.reason = "The attempt names no record to beat.";
    } else {
        const double speed = context.windows.best->speed_mps;
        const double uncertainty = *context.expanded_uncertainty_mps;
        verdict.outcome = decide(speed, uncertainty, *context.target_mps);
        const double unit = metres_per_second(record->unit);
        const std::string figures = fmt::format(
            "{:.3f} {} +/- {:.3f} {} against {:.3f} {} to reach.", speed / unit, record->unit,
            uncertainty / unit, record->unit, *context.target_mps / unit, record->unit);
        verdict.reason =
            verdict.outcome == "beaten"
                ? "The speed less its expanded uncertainty reaches the target: " + figures
            : verdict.outcome == "not_beaten"
                ? "The speed is below the target: " + figures
                : "The target lies within the expanded uncertainty: " + figures;
    }
}

ProfileVerdict judge(const CheckInput& input, const Profile& profile) {
    ClauseContext context{.input = input,
                          .profile = profile,
                          .windows = windows_of(input.judged.windows, profile),
                          .coverage_factor = profile.coverage_factor};
    const auto& best = context.windows.best;
    if (best && input.secondary) {
        const auto& other = windows_of(input.secondary->windows, profile).best;
        context.agreement =
            compare_speeds(input.judged, *best, *input.secondary, other ? &*other : nullptr);
    }
    if (best) {
        context.coverage_factor =
            equivalent_coverage_factor(profile.coverage_factor, best->effective_degrees_of_freedom);
        context.expanded_uncertainty_mps = context.coverage_factor * best->standard_uncertainty_mps;
    }
    if (const auto& record = input.attempt.record)
        context.target_mps = target_speed(profile, record->speed * metres_per_second(record->unit));

    ProfileVerdict verdict;
    verdict.profile = profile.id;
    verdict.body = profile.body;
    verdict.title = profile.title;
    verdict.definition = profile.definition;
    verdict.coverage_factor = context.coverage_factor;
    verdict.expanded_uncertainty_mps = context.expanded_uncertainty_mps;
    verdict.target_mps = context.target_mps;
    if (best) {
        verdict.speed_mps = best->speed_mps;
        verdict.window = best->span;
    }
    for (const Clause& clause : profile.clauses)
        verdict.requirements.push_back(decide_clause(clause, context));
    set_outcome(context, verdict);
    if (const auto& indicated = context.windows.indicated;
        indicated && !indicated->refusals.empty())
        verdict.indicated = RefusedWindow{.span = indicated->span,
                                          .speed_mps = indicated->speed_mps,
                                          .refusals = indicated->refusals};
    return verdict;
}

}  // namespace

Verdict check(const CheckInput& input) {
    Verdict verdict;
    verdict.attempt = input.attempt.id;
    verdict.receiver = input.judged.receiver;
    verdict.georeferenced = input.judged.facts.georeferenced;
    if (const auto& record = input.attempt.record)
        verdict.record = RecordToBeat{.speed = record->speed,
                                      .unit = record->unit,
                                      .source = record->source,
                                      .speed_mps = record->speed * metres_per_second(record->unit)};
    verdict.statements = statements_of(input);
    for (const Profile& profile : input.profiles)
        verdict.profiles.push_back(judge(input, profile));
    return verdict;
}

}  // namespace runcert
