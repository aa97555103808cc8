#include <fmt/format.h>

#include "core/prose.h"
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

std::string best_text(const CertifiableWindow& best) {
    std::string text = fmt::format("{} over {}, in arc {}; combined standard uncertainty {} m/s",
                                   file_speed_text(best.speed_m_s), span_text(best.span), best.arc,
                                   format_fixed(best.standard_uncertainty_m_s, 6));
    if (best.bias_limit_m_s > 0.0)
        text += fmt::format("; a bias of choosing it of at most {} m/s either way is left",
                            format_fixed(best.bias_limit_m_s, 6));
    if (best.own_standard_uncertainty_m_s)
        text += fmt::format("; {} m/s of the uncertainty another receiver does not share",
                            format_fixed(*best.own_standard_uncertainty_m_s, 6));
    if (best.repaired_steps > 0)
        text += fmt::format("; {} inside", counted(best.repaired_steps, "bridged step"));
    return text;
}

std::string indicated_text(const ProfileWindows& windows) {
    const IndicatedWindow& indicated = *windows.indicated;
    const bool refused = !indicated.refusals.empty();
    std::string text = fmt::format("the recording's own fastest: {} over {}",
                                   file_speed_text(indicated.speed_m_s), span_text(indicated.span));
    if (indicated.mean_m_s)
        text += "; mean of the windows required " + file_speed_text(*indicated.mean_m_s);
    return text + (refused ? ": REFUSED, because" : ": certifiable");
}

std::string bound_text(const ErrorBound& bound) {
    return fmt::format(
        "a time-correlated error of {} m is allowed for, with any correlation time from {} s to {} "
        "s; decided by {} (fitted {} m{}, stated {} m, floor {} m{})",
        quantity_text(bound.sigma_m), quantity_text(bound.tau_min_s),
        quantity_text(bound.tau_max_s), to_text(bound.decided_by), quantity_text(bound.fitted_m),
        bound.along > 1.0
            ? fmt::format(", {} times that of both axes because the course shows more of it",
                          quantity_text(bound.along))
            : "",
        quantity_text(bound.stated_m), quantity_text(bound.floor_m),
        bound.floor_fix ? fmt::format(" for {}", to_text(*bound.floor_fix)) : "");
}

std::string estimates_text(const OtherEstimates& estimates) {
    std::string text;
    if (estimates.chord_m_s)
        text = fmt::format("{} m/s from the measured ends alone",
                           format_fixed(*estimates.chord_m_s, 6)) +
               (estimates.chord_difference_uncertainty_m_s
                    ? fmt::format(" (standard uncertainty of the difference {} m/s)",
                                  format_fixed(*estimates.chord_difference_uncertainty_m_s, 6))
                    : "") +
               "; ";
    return text + fmt::format(
                      "{} m/s with a third of the jerk density, {} m/s with three times it, {} m/s "
                      "with the one of the whole recording; the choice is taken to change the "
                      "speed by at most {} m/s",
                      format_fixed(estimates.stiffer_m_s, 6), format_fixed(estimates.softer_m_s, 6),
                      format_fixed(estimates.whole_m_s, 6),
                      format_fixed(estimates.half_width_m_s, 6));
}

std::string selection_text(const SelectionBias& selection) {
    const bool subtracted = selection.treatment == SelectionTreatment::subtracted;
    return fmt::format(
        "{} windows could have been the best; the one chosen is too fast by {} m/s with the errors "
        "as fitted, {} m/s with the time-correlated error at its bound (± {} m/s): {} ({} "
        "trajectories drawn, seed {})",
        counted(selection.candidates), quantity_text(selection.fitted_bias_m_s),
        quantity_text(selection.bounded_bias_m_s), quantity_text(selection.bias_uncertainty_m_s),
        subtracted ? "the middle of the two is subtracted from the speed, half their difference "
                     "added to the expanded uncertainty"
                   : "the larger is added to the expanded uncertainty",
        counted(selection.samples), selection.seed);
}

std::string monte_carlo_text(const MonteCarloCheck& check) {
    return fmt::format(
        "{} draws (seed {}): mean {} m/s, standard deviation {} m/s, 95 % coverage interval {} to "
        "{} m/s; {}",
        counted(check.trials), check.seed, format_fixed(check.mean_m_s, 6),
        format_fixed(check.standard_uncertainty_m_s, 6), format_fixed(check.lower_m_s, 6),
        format_fixed(check.upper_m_s, 6), check.converged ? "settled" : "NOT SETTLED");
}

std::string witness_text(const WitnessedSpeed& one) {
    std::string text = fmt::format(
        "{} by {}, standard uncertainty {} m/s; positions less witness {} m/s, normalised error "
        "{}: {}; the displacements differ by {} m{}; counts by {}",
        file_speed_text(one.speed_m_s),
        one.receiver.empty() ? std::string(words_of(one.kind))
                             : fmt::format("the positions of receiver \"{}\"", one.receiver),
        quantity_text(one.standard_uncertainty_m_s), quantity_text(one.difference_m_s),
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

Facts checks_of(const CertifiableWindow& best) {
    Facts facts;
    if (best.robust)
        facts.add("Robust batch",
                  fmt::format("{}, {} m/s from the screened solution, limit {} m/s: {}",
                              file_speed_text(best.robust->speed_m_s),
                              quantity_text(best.robust->difference_m_s),
                              quantity_text(best.robust->limit_m_s),
                              best.robust->agrees ? "agrees" : "DOES NOT AGREE"));
    if (best.estimates) facts.add("Other estimates", estimates_text(*best.estimates));
    if (best.bound) facts.add("Bound", bound_text(*best.bound));
    if (best.selection) facts.add("Choice of the fastest", selection_text(*best.selection));
    if (best.monte_carlo) facts.add("Check of linearisation", monte_carlo_text(*best.monte_carlo));
    for (const WitnessedSpeed& one : best.witnesses)
        facts.add("Witness", witness_text(one));
    for (const UndetectedError& error : best.reliability)
        facts.add("Undetected error",
                  fmt::format("{}, {} {}: changes the speed by {} m/s",
                              tested_error_text(error.hypothesis), size_text(error),
                              where_text(error), quantity_text(error.speed_m_s)));
    return facts;
}

FactTable budget_table(const std::vector<BudgetRow>& budget) {
    FactTable table{
        .caption = "Budget: standard uncertainties",
        .heads = {"symbol", "standard uncertainty", "contribution to u", "type", "source"}};
    for (const BudgetRow& row : budget)
        table.rows.push_back({row.symbol,
                              fmt::format("{}{}{}", quantity_text(row.standard_uncertainty),
                                          row.unit.empty() ? "" : " ", row.unit),
                              format_fixed(row.contribution_m_s, 6) + " m/s", row.type,
                              row.source});
    return table;
}

/// The speeds by each method at the window's epochs, as [DHD22] prints them; no block where none of
/// them has all.
void add_methods(const TrajectoryTable& trajectory, const WindowSpan& span, Section& part) {
    const auto methods = method_speeds(trajectory, span.first_epoch, span.last_epoch);
    if (methods.empty()) return;
    FactTable table{
        .caption = fmt::format("Horizontal speeds at the {} epochs of the window, by method: mean, "
                               "standard deviation s of one speed, and the interval of 1.96 s, as "
                               "[DHD22] prints them. The interval is not the uncertainty of the "
                               "mean, which the budget has",
                               methods.front().epochs),
        .heads = {"method", "mean", "s", "95 % interval"}};
    for (const MethodSpeeds& one : methods)
        table.rows.push_back(
            {std::string(one.method), file_speed_text(one.mean_m_s),
             file_speed_text(one.standard_deviation_m_s),
             fmt::format("{} to {}", format_fixed(one.mean_m_s - one.half_width_m_s(), 6),
                         file_speed_text(one.mean_m_s + one.half_width_m_s()))});
    part.add(std::move(table));
}

Section rule_windows(const ProfileWindows& windows,
                     const std::optional<TrajectoryTable>& trajectory) {
    Section part{.title = fmt::format("Rule {}", windows.profile)};
    Facts facts{{{"Looked for", rule_text(windows.rule)},
                 {"Compared", counted(windows.candidates, "certifiable window")},
                 {"Best", windows.best ? best_text(*windows.best)
                          : windows.missing.empty()
                              ? "none: breaks and epochs left out leave no stretch long enough"
                              : "none: " + windows.missing}}};
    for (const FurtherWindow& further : windows.further)
        facts.add("Further", fmt::format("{} over {}", file_speed_text(further.speed_m_s),
                                         span_text(further.span)));
    if (windows.indicated) facts.add("Indicated", indicated_text(windows));
    part.add(std::move(facts));
    if (windows.indicated && !windows.indicated->refusals.empty())
        part.add(Entries{.items = windows.indicated->refusals, .nested = true});
    if (windows.best) {
        if (Facts checks = checks_of(*windows.best); !checks.facts.empty())
            part.add(std::move(checks));
        if (!windows.best->budget.empty()) part.add(budget_table(windows.best->budget));
        if (trajectory) add_methods(*trajectory, windows.best->span, part);
    }
    return part;
}

}  // namespace

Section window_section(const RunRecord& record, const ReceiverRecord& one, bool all) {
    const std::string title = stage_title("window", one.receiver.id);
    if (!one.windows) return missing_section(title, one.windows_file);
    const Windows& windows = *one.windows;
    Section section = product_section(record, title, windows.header, one.windows_file,
                                      counted(std::ssize(windows.profiles), "rule"), all);
    section.add(parameter_blocks(record.attempt, windows.header, all));
    if (!windows.witness_notes.empty()) section.add(Entries{.items = windows.witness_notes});
    for (const ProfileWindows& each : windows.profiles)
        section.parts.push_back(rule_windows(each, one.trajectory));
    return section;
}

}  // namespace runcert
