#include <fmt/format.h>

#include "core/prose.h"
#include "core/rounding.h"
#include "core/text.h"
#include "reports/audit/sections.h"
#include "reports/run_speeds/run_speeds.h"
#include "reports/words/screening.h"

namespace runcert {
namespace {

std::string rule_text(const WindowRule& rule) {
    const std::string length =
        rule.kind == WindowKind::time ? quantity_text(rule.duration_s) + " s"
        : rule.kind == WindowKind::course
            ? std::string("the surveyed course")
            : quantity_text(rule.distance_m) + " m" +
                  (rule.kind == WindowKind::alpha ? ", back to where it began" : "");
    return fmt::format("{}{}, speed by {}, {}, of the {}{}{}",
                       rule.count > 1 ? fmt::format("{} windows of ", rule.count) : "", length,
                       to_text(rule.definition), to_text(rule.dimension),
                       rule.source == SpeedSource::velocity ? "recorded velocities" : "positions",
                       rule.ends == WindowEnds::epochs ? ", from epoch to epoch"
                                                       : ", beginning and ending anywhere",
                       rule.opposite_runs ? ", two runs in opposite directions" : "");
}

std::string best_text(const CertifiableWindow& best, const RuleSpeeds& speeds) {
    std::string text =
        fmt::format("{} over {}, in arc {}; combined standard uncertainty {}",
                    speeds.speed_in_file(best.speed_m_s), span_text(best.span), best.arc,
                    speeds.uncertainty_in_file(best.standard_uncertainty_m_s));
    if (best.bias_limit_m_s > 0.0)
        text += fmt::format("; a bias of choosing it of at most {} either way is left",
                            speeds.uncertainty_in_file(best.bias_limit_m_s));
    if (best.own_standard_uncertainty_m_s)
        text += fmt::format("; {} of the uncertainty another receiver does not share",
                            speeds.uncertainty_in_file(*best.own_standard_uncertainty_m_s));
    if (best.repaired_steps > 0)
        text += fmt::format("; {} inside", counted(best.repaired_steps, "bridged step"));
    return text;
}

std::string indicated_text(const IndicatedWindow& indicated, const RuleSpeeds& speeds) {
    std::string text =
        fmt::format("the recording's own fastest: {} over {}",
                    speeds.speed_in_file(indicated.speed_m_s), span_text(indicated.span));
    if (indicated.mean_m_s)
        text += "; mean of the windows required " + speeds.speed_in_file(*indicated.mean_m_s);
    return text + (indicated.refusals.empty() ? ": certifiable" : ": REFUSED, because");
}

std::string bound_text(const ErrorBound& bound) {
    const auto metres = [](double size_m) { return significant_text(size_m, 2) + " m"; };
    return fmt::format(
        "a time-correlated error of {} is allowed for, with any correlation time from {} s to {} "
        "s; decided by {} (fitted {}{}, stated {}, floor {}{})",
        metres(bound.sigma_m), quantity_text(bound.tau_min_s), quantity_text(bound.tau_max_s),
        to_text(bound.decided_by), metres(bound.fitted_m),
        bound.along > 1.0
            ? fmt::format(", {} times that of both axes because the course shows more of it",
                          significant_text(bound.along, 2))
            : "",
        metres(bound.stated_m), metres(bound.floor_m),
        bound.floor_fix ? fmt::format(" for {}", to_text(*bound.floor_fix)) : "");
}

std::string estimates_text(const OtherEstimates& estimates, const RuleSpeeds& speeds) {
    std::string text;
    if (estimates.chord_m_s)
        text = fmt::format(
            "{} from the measured ends alone{}; ", speeds.speed_in_file(*estimates.chord_m_s),
            estimates.chord_difference_uncertainty_m_s
                ? fmt::format(" (standard uncertainty of the difference {})",
                              speeds.uncertainty(*estimates.chord_difference_uncertainty_m_s))
                : "");
    return text + fmt::format(
                      "{} with a third of the jerk density, {} with three times it, {} with the "
                      "one of the whole recording; the choice is taken to change the speed by at "
                      "most {}",
                      speeds.speed_in_file(estimates.stiffer_m_s),
                      speeds.speed_in_file(estimates.softer_m_s),
                      speeds.speed_in_file(estimates.whole_m_s),
                      speeds.difference(estimates.half_width_m_s));
}

std::string selection_text(const SelectionBias& selection, const RuleSpeeds& speeds) {
    const bool subtracted = selection.treatment == SelectionTreatment::subtracted;
    return fmt::format(
        "{} could have been the best; the one chosen is too fast by {} with the errors as fitted, "
        "{} with the time-correlated error at its bound (± {}): {} ({} trajectories drawn, seed "
        "{})",
        counted(selection.candidates, "window"), speeds.difference(selection.fitted_bias_m_s),
        speeds.difference(selection.bounded_bias_m_s),
        speeds.difference(selection.bias_uncertainty_m_s),
        subtracted ? "the middle of the two is subtracted from the speed, half their difference "
                     "added to the expanded uncertainty"
                   : "the larger is added to the expanded uncertainty",
        counted(selection.samples), selection.seed);
}

std::string monte_carlo_text(const MonteCarloCheck& check, const RuleSpeeds& speeds) {
    return fmt::format(
        "{} draws (seed {}): mean {}, standard deviation {}, 95 % coverage interval {} to {}; {}",
        counted(check.trials), check.seed, speeds.speed_in_file(check.mean_m_s),
        speeds.uncertainty_in_file(check.standard_uncertainty_m_s), speeds.speed(check.lower_m_s),
        speeds.speed(check.upper_m_s, SafeSide::up), check.converged ? "settled" : "NOT SETTLED");
}

std::string witness_text(const WitnessedSpeed& one, const RuleSpeeds& speeds) {
    std::string text = fmt::format(
        "{} by {}, standard uncertainty {}; positions less witness {}, normalised error {}: {}; "
        "the displacements differ by {} m{}; counts by {}",
        speeds.speed_in_file(one.speed_m_s),
        one.receiver.empty() ? std::string(words_of(one.kind))
                             : fmt::format("the positions of receiver \"{}\"", one.receiver),
        speeds.uncertainty(one.standard_uncertainty_m_s), speeds.difference(one.difference_m_s),
        format_fixed(one.normalised_error, 2), contradicts(one) ? "DOES NOT AGREE" : "agrees",
        quantity_text(one.apart_m),
        one.apart_azimuth_deg
            ? fmt::format(" towards {} degrees from north", format_fixed(*one.apart_azimuth_deg, 0))
            : "",
        format_fixed(one.share, 3));
    if (one.kind == WitnessKind::phases)
        text += fmt::format("; {}, {}, {}", counted(one.satellites.value_or(0), "satellite"),
                            counted(one.slips.value_or(0), "slip"),
                            counted(one.refusals.value_or(0), "refusal"));
    return text;
}

Block checks_of(const CertifiableWindow& best, const RuleSpeeds& speeds) {
    Block told = facts({});
    if (best.robust)
        add_fact(told, "Robust batch",
                 fmt::format("{}, {} from the screened solution, limit {}: {}",
                             speeds.speed_in_file(best.robust->speed_m_s),
                             speeds.difference(best.robust->difference_m_s),
                             speeds.difference(best.robust->limit_m_s),
                             best.robust->agrees ? "agrees" : "DOES NOT AGREE"));
    if (best.estimates) add_fact(told, "Other estimates", estimates_text(*best.estimates, speeds));
    if (best.bound) add_fact(told, "Bound", bound_text(*best.bound));
    if (best.selection)
        add_fact(told, "Choice of the fastest", selection_text(*best.selection, speeds));
    if (best.monte_carlo)
        add_fact(told, "Check of linearisation", monte_carlo_text(*best.monte_carlo, speeds));
    for (const WitnessedSpeed& one : best.witnesses)
        add_fact(told, "Witness", witness_text(one, speeds));
    for (const UndetectedError& error : best.reliability)
        add_fact(told, "Undetected error",
                 fmt::format("{}, {} {}: changes the speed by {}",
                             tested_error_text(error.hypothesis), size_text(error),
                             where_text(error), speeds.uncertainty_in_file(error.speed_m_s)));
    return told;
}

/// "0.0010 m/s"; a ratio has no unit.
std::string source_size(const BudgetRow& row) {
    std::string size = significant_text(row.standard_uncertainty, 2);
    if (row.unit.empty() || row.unit == "1") return size;
    return fmt::format("{} {}", size, row.unit == "m / s" ? "m/s" : row.unit);
}

Block budget_table(const std::vector<BudgetRow>& budget, const RuleSpeeds& speeds) {
    Block sources = table(
        {"symbol", ">size", fmt::format(">u, {}", speeds.unit().name), ">u, m/s", "type", "source"},
        "Budget: standard uncertainty of each source, and what it contributes "
        "to u, that of the speed");
    for (const BudgetRow& row : budget)
        add_row(sources, {row.symbol, source_size(row),
                          significant_text(row.contribution_m_s * speeds.unit().per_m_s, 2),
                          significant_text(row.contribution_m_s, 2), row.type, row.source});
    return sources;
}

/// The speeds by each method at the window's epochs, as [DHD22] prints them; no block where none of
/// them has all.
std::vector<Block> method_blocks(const TrajectoryTable& trajectory, const WindowSpan& span,
                                 const SpeedUnit& unit) {
    const auto methods = method_speeds(trajectory, span.first_epoch, span.last_epoch);
    if (methods.empty()) return {};
    Block speeds = table({"method", fmt::format(">mean, {}", unit.name), ">s", ">95 % interval"},
                         fmt::format("Horizontal speeds at the {} epochs of the window, by method: "
                                     "mean, standard deviation s of one speed, and the interval of "
                                     "1.96 s, as [DHD22] prints them. The interval is not the "
                                     "uncertainty of the mean, which the budget has",
                                     methods.front().epochs));
    for (const MethodSpeeds& one : methods) {
        const int decimals = uncertainty_decimals(one.standard_deviation_m_s * unit.per_m_s);
        const auto shown = [&](double speed_m_s) {
            return format_fixed(speed_m_s * unit.per_m_s, decimals);
        };
        add_row(speeds,
                {std::string(one.method), shown(one.mean_m_s), shown(one.standard_deviation_m_s),
                 fmt::format("{} to {}", shown(one.mean_m_s - one.half_width_m_s()),
                             shown(one.mean_m_s + one.half_width_m_s()))});
    }
    return {std::move(speeds)};
}

/// The speed of the best window, and how sure it is.
std::optional<SpeedsToShow> measured_in(const RunRecord& record, const ProfileWindows& windows) {
    if (!windows.best) return std::nullopt;
    const ProfileVerdict* verdict = verdict_of(record, windows.profile);
    const double coverage_factor = verdict ? verdict->coverage_factor : 2.0;
    return SpeedsToShow{
        .speed_m_s = windows.best->speed_m_s,
        .expanded_uncertainty_m_s = expanded_uncertainty_m_s(*windows.best, coverage_factor)};
}

std::vector<Block> rule_windows(const RunRecord& record, const ReceiverRecord& one,
                                const ProfileWindows& windows) {
    const RuleSpeeds speeds(record, windows.profile, measured_in(record, windows));
    Block told = facts({{"Looked for", rule_text(windows.rule)},
                        {"Compared", counted(windows.candidates, "certifiable window")},
                        {"Best", windows.best ? best_text(*windows.best, speeds)
                                 : windows.missing.empty()
                                     ? "none: breaks and epochs left out leave no stretch long "
                                       "enough"
                                     : "none: " + windows.missing}});
    for (const FurtherWindow& further : windows.further)
        add_fact(told, "Further",
                 fmt::format("{} over {}", speeds.speed_in_file(further.speed_m_s),
                             span_text(further.span)));
    if (windows.indicated) add_fact(told, "Indicated", indicated_text(*windows.indicated, speeds));
    std::vector<Block> blocks{heading("Rule " + windows.profile), std::move(told)};
    if (windows.indicated && !windows.indicated->refusals.empty())
        blocks.push_back(list_of(windows.indicated->refusals, "apart"));
    if (!windows.best) return blocks;
    if (Block checks = checks_of(*windows.best, speeds); !checks.facts.empty())
        blocks.push_back(std::move(checks));
    if (!windows.best->budget.empty()) blocks.push_back(budget_table(windows.best->budget, speeds));
    if (one.trajectory)
        append(blocks, method_blocks(*one.trajectory, windows.best->span, speeds.unit()));
    return blocks;
}

}  // namespace

std::vector<Block> window_blocks(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const Windows& windows = *one.windows;
    std::vector<Block> blocks = product_blocks(record, windows.header, one.windows_file,
                                               counted(std::ssize(windows.profiles), "rule"), all);
    append(blocks, parameter_blocks(record.attempt, windows.header, all));
    if (!windows.witness_notes.empty()) blocks.push_back(list_of(windows.witness_notes));
    for (const ProfileWindows& each : windows.profiles)
        append(blocks, rule_windows(record, one, each));
    return blocks;
}

}  // namespace runcert
