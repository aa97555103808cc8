#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/results/results.h"
#include "schemas/screened/witness_text.h"

namespace runcert {
namespace {

/// What the tests took the errors for, on some axes.
std::string model_text(const ScreeningModel& model) {
    constexpr double least_m = 5e-5;  // what is not zero as written
    return fmt::format(
        "{}: {} times the stated standard deviations, jerk density {:.3g} m s^-2.5, {}",
        words_of(model.noise), format_fixed(model.measurement_scale, 2), model.jerk_density,
        model.error_sigma_m >= least_m
            ? fmt::format("a time-correlated error of {} m over {:.3g} s",
                          format_fixed(model.error_sigma_m, 4), model.error_tau_s)
            : "no time-correlated error");
}

std::string delay_text(const VelocityComparison& velocity) {
    if (!velocity.delay_s) return "the motion does not determine their delay";
    const double delay_s = *velocity.delay_s;
    const auto& sigma_s = velocity.sigma_delay_s;
    const int decimals = sigma_s && *sigma_s > 0.0 ? uncertainty_decimals(*sigma_s) : 3;
    return fmt::format("{} s{} {} the positions, which is allowed for",
                       format_fixed(std::abs(delay_s), decimals),
                       sigma_s ? fmt::format(" ± {} s", format_fixed(*sigma_s, decimals)) : "",
                       delay_s < 0.0 ? "ahead of" : "behind");
}

std::string velocity_comparison_text(const VelocityComparison& velocity) {
    if (velocity.origin == VelocityOrigin::positions) return std::string(words_of(velocity.origin));
    std::string text =
        velocity.compared == 0
            ? "too few could be compared with the motion, or they never change"
            : fmt::format("{}; compared at {}, they differ by {} m/s and contradict {}",
                          delay_text(velocity), counted(velocity.compared, "epoch"),
                          format_fixed(velocity.scale_m_s, 3), counted(velocity.rejected));
    if (const std::string others = other_moments_text(velocity); !others.empty())
        text = (velocity.compared == 0 ? "" : text + "; ") + others;
    if (const std::string unfit = unfit_text(velocity); !unfit.empty())
        text += fmt::format("; {}, and are no source of a speed", unfit);
    return text;
}

std::string device_signs_text(const DeviceSigns& device) {
    if (device.moving == 0) return "none looked for: the craft hardly moved";
    const std::string moving = counted(device.moving, "position") + " recorded in motion";
    if (device.held + device.interpolated == 0) return "none in " + moving;
    return fmt::format(
        "{} of {} repeat the one before, {} lie on a line or curve through others to the last "
        "digit; chance makes {}",
        counted(device.held), moving, counted(device.interpolated),
        significant_text(device.by_chance, 2));
}

std::string time_fault_text(const TimeFault& fault) {
    const std::string size = format_fixed(std::abs(fault.size_s), 3) + " s";
    return fault.kind == TimeFaultKind::gap         ? size + " missing"
           : fault.kind == TimeFaultKind::backward  ? "the clock goes back by " + size
           : fault.kind == TimeFaultKind::duplicate ? "the time of the epoch before"
           : fault.kind == TimeFaultKind::session
               ? fmt::format("another session begins, {} {}", size,
                             fault.size_s < 0.0 ? "earlier" : "later")
               : fmt::format("the clock jumps by {} while the positions go on", size);
}

std::string surface_text(const SurfaceComparison& surface) {
    return fmt::format(
        "{} compared, {} beside it; median {}{} m{}, scatter {} m; {} contradicted; "
        "an error of {} m is found with a probability of 0.8",
        counted(surface.compared), counted(surface.outside), surface.offset_m > 0.0 ? "+" : "",
        format_fixed(surface.offset_m, 3), surface.offset_removed ? " (a datum's, taken off)" : "",
        format_fixed(surface.scatter_m, 3), counted(surface.rejected),
        format_fixed(surface.detectable_m, 2));
}

std::string time_text(const ScreenedTable& table) {
    const TimeStampSummary& time = table.basis.time;
    const std::string deviation = format_fixed(std::abs(time.rate_deviation) * 1e6, 1);
    return fmt::format(
        "{}, {}, {} repeated and {} backward; mostly {} s apart, the mean interval {}, scattering "
        "by {} s",
        counted(time.sessions, "session"),
        time.gaps == 0 ? "no gap"
                       : fmt::format("{}, the longest {} s", counted(time.gaps, "gap"),
                                     format_fixed(time.longest_gap_s, 3)),
        counted(time.duplicates), counted(time.backward),
        format_fixed(table.facts.nominal_interval_s, 3),
        deviation == "0.0" ? "as it should be"
                           : fmt::format("{} millionths {} than it should be", deviation,
                                         time.rate_deviation > 0.0 ? "longer" : "shorter"),
        significant_text(time.jitter_s, 2));
}

void add_time(Block& facts, const ScreenedTable& table, std::size_t faults_shown) {
    add_fact(facts, "Time stamps", time_text(table));
    const TimeStampSummary& time = table.basis.time;
    const std::size_t shown = std::min(time.faults.size(), faults_shown);
    for (const TimeFault& fault : std::span(time.faults).first(shown)) {
        const auto row = std::ranges::find(table.rows, fault.epoch, &ScreenedEpoch::epoch);
        const bool has_line = row != table.rows.end() && row->source_line;
        add_fact(facts, "Fault of time stamps",
                 fmt::format("epoch {}{}: {}", fault.epoch,
                             has_line ? fmt::format(" (line {})", *row->source_line) : "",
                             time_fault_text(fault)));
    }
    // Counts hold every fault, the table a thousand of them at most.
    const std::int64_t all =
        std::max(time.gaps + time.duplicates + time.backward, std::ssize(time.faults));
    if (const std::int64_t left = all - static_cast<std::int64_t>(shown); left > 0)
        add_fact(facts, "Further faults of time stamps", counted(left));
}

std::string limits_text(const ScreenedTable& table) {
    const LimitComparison& limits = table.basis.limits;
    return fmt::format(
        "largest acceleration {} m/s^2 (limit of the class {} m/s^2), largest jerk {} m/s^3 ({} "
        "m/s^3){}; {} beyond them and the uncertainty of the motion",
        format_fixed(limits.acceleration_m_s2, 1), format_fixed(limits.acceleration_max_m_s2, 1),
        format_fixed(limits.jerk_m_s3, 1), format_fixed(limits.jerk_max_m_s3, 1),
        table.facts.vertical_measured ? fmt::format(", largest vertical rate {} m/s ({} m/s)",
                                                    format_fixed(limits.vertical_rate_m_s, 1),
                                                    format_fixed(limits.vertical_rate_max_m_s, 1))
                                      : "",
        counted(limits.rejected, "epoch"));
}

/// Sudden motion that tests allowed for, and where the errors around an epoch were larger.
void add_allowances(Block& facts, const std::vector<ScreenedEpoch>& rows) {
    const auto loudest = std::ranges::max_element(rows, {}, &ScreenedEpoch::local_variance_factor);
    if (loudest != rows.end() && loudest->local_variance_factor > 1.0)
        add_fact(facts, "Locally larger errors",
                 fmt::format("its statistics are divided by the ratio of the variances, at most "
                             "{} (epoch {})",
                             format_fixed(*loudest->local_variance_factor, 2), loudest->epoch));
    const auto sudden = std::ranges::max_element(rows, {}, &ScreenedEpoch::manoeuvre_m_s2);
    const auto allowed = std::ranges::count_if(
        rows, [](const ScreenedEpoch& row) { return row.manoeuvre_m_s2.has_value(); });
    if (allowed > 0)
        add_fact(facts, "Manoeuvres allowed for",
                 fmt::format("at {}: a change of the acceleration explains the data better than an "
                             "error, at most {} m/s^2 (epoch {})",
                             counted(allowed, "epoch"), format_fixed(*sudden->manoeuvre_m_s2, 1),
                             sudden->epoch));
}

void add_basis(Block& facts, const ScreenedTable& table) {
    const ScreeningBasis& basis = table.basis;
    add_fact(facts, "Tests",
             fmt::format("{}, the recording gone through {}; each raises a false alarm with a "
                         "probability of {}",
                         counted(basis.tests), counted(basis.passes, "time"),
                         scientific_text(basis.test_size)));
    const double rate = basis.family_false_alarm_rate;
    add_fact(facts, "False alarms",
             rate > 0.0
                 ? fmt::format("of {} recordings without an outlier at most one would have "
                               "anything marked, by all tests together",
                               counted(static_cast<std::int64_t>(std::floor(1.0 / rate + 1e-9))))
                 : "not stated");
    for (const ScreeningModel& model : basis.models)
        add_fact(facts, fmt::format("Noise assumed, {}", to_text(model.axes)), model_text(model));
    if (basis.models.empty()) add_fact(facts, "Noise assumed", "none: nothing could be tested");
    add_allowances(facts, table.rows);
    // A time-correlated error is not in these.
    for (const FixTypeErrors& errors : basis.fix_types)
        add_fact(facts, fmt::format("Errors between epochs, {}", to_text(errors.axes)),
                 fmt::format("{}: {}{} ({})", words_of(errors.fix),
                             errors.judgement == AccuracyJudgement::too_few_epochs
                                 ? ""
                                 : significant_text(std::sqrt(errors.variance_factor), 2) +
                                       " times the stated standard deviation, ",
                             words_of(errors.judgement), counted(errors.epochs, "epoch")));
    add_fact(facts, "Recorded velocities",
             basis.velocity ? velocity_comparison_text(*basis.velocity)
                            : "too few were recorded to compare");
    for (const DisplacementComparison& each : basis.displacements)
        add_fact(facts, "Displacements by a witness", displacement_comparison_text(each));
    if (basis.surface) add_fact(facts, "Heights above the surface", surface_text(*basis.surface));
    add_fact(facts, "Motion of the epochs kept", limits_text(table));
    if (basis.device)
        add_fact(facts, "Signs of positions that were not measured",
                 device_signs_text(*basis.device));
}

std::string baseline_text(const BaselineComparison& baseline) {
    if (baseline.compared == 0) return "could not be compared: no epochs at the same time";
    return fmt::format(
        "“{}”: antennas {} m apart, standard deviation {} m over {}; contradicted at {}",
        baseline.receiver, format_fixed(baseline.length_m, 3), format_fixed(baseline.sd_m, 3),
        counted(baseline.compared, "epoch"), counted(baseline.rejected));
}

double longest_arc_s(const std::vector<ScreenedEpoch>& rows) {
    std::map<std::int64_t, std::pair<ElapsedTime, ElapsedTime>> ends;
    for (const ScreenedEpoch& row : rows)
        if (row.arc) ends.try_emplace(*row.arc, row.time, row.time).first->second.second = row.time;
    double longest = 0.0;
    for (const auto& [arc, times] : ends)
        longest = std::max(longest, times.second.seconds() - times.first.seconds());
    return longest;
}

}  // namespace

ElapsedTime last_time(const std::vector<ScreenedEpoch>& rows) {
    ElapsedTime last;
    for (const ScreenedEpoch& row : rows)
        last = std::max(last, row.time);
    return last;
}

std::vector<Block> screening_blocks(const ScreenedTable& screened, Level level) {
    constexpr std::size_t faults_in_annex = 3;
    const ScreeningSummary summary = summarise(screened.rows);
    Block list = facts({});
    std::string used =
        fmt::format("{} of {}", counted(summary.usable), counted(std::ssize(screened.rows)));
    if (summary.arcs > 0)
        used += fmt::format(
            ", in {} of {} s",
            summary.arcs == 1 ? "one arc," : fmt::format("{} arcs, the longest", summary.arcs),
            format_fixed(longest_arc_s(screened.rows), 3));
    add_fact(list, "Epochs used", used);
    std::vector<std::string> decisions;
    for (const auto& [hypothesis, count] : summary.decisions)
        decisions.push_back(
            fmt::format("{} at {}", tested_error_text(hypothesis), counted(count, "epoch")));
    add_fact(list, "Decided by the tests",
             decisions.empty() ? "nothing" : fmt::format("{}", fmt::join(decisions, "; ")));
    add_basis(list, screened);
    add_time(list, screened,
             level == Level::annex ? faults_in_annex : screened.basis.time.faults.size());
    if (const auto& baseline = screened.basis.baseline)
        add_fact(list, "Other receiver", baseline_text(*baseline));
    Block counts = table({">Epochs|14", "Decision of screening|86"});
    for (const auto& [reason, count] : summary.reasons)
        add_row(counts,
                {counted(count), reason == Reason::none ? "used" : std::string(words_of(reason))});
    std::vector<Block> blocks{std::move(list), std::move(counts)};
    if (level != Level::annex) add(blocks, decision_blocks(screened, level == Level::all));
    return blocks;
}

}  // namespace runcert
