#include "stages/check/requirements.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

#include "core/failure.h"

namespace runcert {
namespace {

struct Finding {
    std::string status;
    std::string evidence;
};

std::string in_unit(double speed_mps, const std::string& unit, int decimals) {
    return fmt::format("{:.{}f} {}", speed_mps / metres_per_second(unit), decimals, unit);
}

/// Why not one epoch may take part: "none of the 400 epochs is usable: 398 ambiguities not fixed, 2
/// no solution".
std::string nothing_usable(const ScreeningSummary& screening) {
    std::int64_t epochs = 0;
    std::vector<std::pair<std::int64_t, Reason>> reasons;
    for (const auto& [reason, count] : screening.reasons) {
        epochs += count;
        if (reason != Reason::none) reasons.emplace_back(count, reason);
    }
    std::stable_sort(reasons.begin(), reasons.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<std::string> words;
    for (const auto& [count, reason] : reasons)
        words.push_back(fmt::format("{} {}", count, words_of(reason)));
    return fmt::format("none of the {} epochs is usable: {}", epochs, fmt::join(words, ", "));
}

double longest_stretch_s(const std::vector<TrajectoryEpoch>& rows) {
    double longest_s = 0.0;
    const TrajectoryEpoch* first = nullptr;
    for (const TrajectoryEpoch& row : rows) {
        if (!row.arc || !row.usable) continue;
        if (!first || first->arc != row.arc) first = &row;
        longest_s = std::max(longest_s, row.time.seconds() - first->time.seconds());
    }
    return longest_s;
}

Finding window_complete(const ClauseContext& context) {
    if (!context.windows.best) {
        const ReceiverEvidence& judged = context.input.judged;
        if (judged.screening.usable == 0) return {"not_met", nothing_usable(judged.screening)};
        std::string evidence = fmt::format(
            "no {:g} s of the recording are without a break and without an unusable epoch, the "
            "longest stretch without a break having {:.3g} s",
            context.profile.duration_s, longest_stretch_s(judged.trajectory));
        if (const auto& indicated = context.windows.indicated)
            evidence +=
                fmt::format("; the fastest {:g} s of the raw positions hold {}",
                            context.profile.duration_s, fmt::join(indicated->refusals, ", "));
        return {"not_met", evidence};
    }
    const WindowSpan& span = context.windows.best->span;
    return {"met", fmt::format("{:.3f} s from epoch {} to epoch {}, no break and no unusable epoch "
                               "inside; the best of {} such windows",
                               span.duration.seconds(), span.first_epoch, span.last_epoch,
                               context.windows.candidates)};
}

Finding accuracy(const ClauseContext& context) {
    if (!context.windows.best || !context.profile.accuracy_limit_mps)
        return {"not_met", "there is no certifiable window whose accuracy could be stated"};
    const double u = *context.expanded_uncertainty_mps;
    const bool met = u <= *context.profile.accuracy_limit_mps;
    const std::string& unit = context.profile.accuracy_unit;
    return {met ? "met" : "not_met",
            fmt::format("{:.3g} times the standard uncertainty is {}, the limit {}",
                        context.coverage_factor, in_unit(u, unit, 3),
                        in_unit(*context.profile.accuracy_limit_mps, unit, 3))};
}

Finding margin(const ClauseContext& context) {
    if (!context.input.attempt.record) return {"attest", "the attempt names no record to beat"};
    if (!context.windows.best) return {"not_met", "there is no certifiable window"};
    const std::string& unit = context.input.attempt.record->unit;
    const double speed = context.windows.best->speed_mps;
    const double u = *context.expanded_uncertainty_mps;
    const bool met = speed - u >= *context.target_mps;
    return {met ? "met" : "not_met",
            fmt::format("speed {} less expanded uncertainty {} is {}, to reach {}",
                        in_unit(speed, unit, 3), in_unit(u, unit, 3), in_unit(speed - u, unit, 3),
                        in_unit(*context.target_mps, unit, 3))};
}

Finding georeferenced(const ClauseContext& context) {
    if (context.input.judged.facts.georeferenced)
        return {"met", "WGS 84 positions, taken to a local frame without a grid's scale factor"};
    return {"attest",
            "the recording holds local-plane coordinates, not georeferenced: their unit "
            "must be the true metre on the ground"};
}

Finding secondary_method(const ClauseContext& context) {
    if (!context.input.secondary)
        return {"attest", "the attempt has one receiver; another method is not part of it"};
    const std::string& receiver = context.input.secondary->receiver;
    if (!context.agreement) return {"not_met", "there is no certifiable window to compare"};
    const Agreement& agreement = *context.agreement;
    if (!agreement.missing.empty())
        return {"not_met", fmt::format("receiver \"{}\" {}", receiver, agreement.missing)};
    return {agreement.agrees() ? "met" : "not_met",
            fmt::format(
                "receiver \"{}\" gives {:.3f} km/h over the same {:.3f} s, {:+.3f} km/h "
                "against the primary one (displacement over time); normalised error "
                "{:.2f}, at most 1",
                receiver, agreement.other_mps * 3.6, context.windows.best->span.duration.seconds(),
                (agreement.other_mps - agreement.judged_mps) * 3.6, agreement.normalised_error)};
}

Finding attest(const ClauseContext&) {
    return {"attest", "the data cannot tell"};
}

}  // namespace

Requirement decide_clause(const Clause& clause, const ClauseContext& context) {
    static const std::map<std::string, std::function<Finding(const ClauseContext&)>> computations{
        {"window_complete", window_complete},
        {"accuracy", accuracy},
        {"margin", margin},
        {"georeferenced", georeferenced},
        {"secondary_method", secondary_method},
        {"attest", attest}};
    const auto computation = computations.find(clause.decided_by);
    if (computation == computations.end())
        throw Failure("clause " + clause.id,
                      "there is no computation \"" + clause.decided_by + "\"",
                      "Use one of the names of the profile's schema");
    const Finding finding = computation->second(context);
    return {.clause = clause.id,
            .status = finding.status,
            .evidence = finding.evidence,
            .text = clause.text,
            .source = clause.source,
            .certainty = clause.certainty};
}

}  // namespace runcert
