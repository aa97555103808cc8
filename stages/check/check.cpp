#include "stages/check/check.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "stages/check/decision.h"
#include "stages/check/requirements.h"

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

void set_outcome(const ClauseContext& context, ProfileVerdict& verdict) {
    const auto failed = failed_clauses(verdict.requirements, context.profile);
    const auto& record = context.input.attempt.record;
    if (!context.windows.best || !failed.empty()) {
        verdict.outcome = "not_certifiable";
        verdict.reason =
            failed.empty() ? "There is no certifiable window." : "Not met: " + failed.front();
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
    ClauseContext context{
        .input = input, .profile = profile, .windows = windows_of(input.judged.windows, profile)};
    if (input.secondary) context.secondary = &windows_of(input.secondary->windows, profile);
    const auto& best = context.windows.best;
    if (best)
        context.expanded_uncertainty_mps = profile.coverage_factor * best->standard_uncertainty_mps;
    if (const auto& record = input.attempt.record)
        context.target_mps = target_speed(profile, record->speed * metres_per_second(record->unit));

    ProfileVerdict verdict;
    verdict.profile = profile.id;
    verdict.body = profile.body;
    verdict.title = profile.title;
    verdict.definition = profile.definition;
    verdict.coverage_factor = profile.coverage_factor;
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

/// What must be read with every figure of the measurement.
std::vector<std::string> statements_of(const CheckInput& input) {
    const ReceiverEvidence& judged = input.judged;
    std::vector<std::string> statements{
        "The uncertainty covers errors of the positions that are independent from epoch to epoch, "
        "of the size stated, multiplied by the variance factor. Errors that vary slowly over the "
        "window, as carrier-phase positions have them, are not in it."};
    if (judged.accuracy_source == "none")
        statements.push_back(
            "Neither the recording nor the attempt states an accuracy: nothing "
            "can be certified without one.");
    else
        statements.push_back(fmt::format(
            "Stated accuracies come from the {}; the variance factor of the adjustment is {:.2f}, "
            "applied {:.2f}.",
            judged.accuracy_source, judged.estimation.variance_factor,
            judged.estimation.variance_factor_applied));
    if (!judged.facts.georeferenced)
        statements.push_back(
            "Not georeferenced: the coordinates are those of a local plane, whose "
            "place, orientation and scale on the Earth are not stated.");
    if (!judged.facts.vertical_measured)
        statements.push_back("Heights were not measured: the estimate is in the plane.");
    if (!judged.facts.first_epoch)
        statements.push_back("The recording's time is relative: the run has no date in it.");
    else if (!utc_from_gps(*judged.facts.first_epoch).leap_seconds_known)
        statements.push_back(
            "UTC is given with the leap seconds known to the program, whose table "
            "does not reach the date of the recording.");
    return statements;
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
