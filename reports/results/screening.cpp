#include "reports/words/screening.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

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

/// Fix types in their order, a line for each with all of its axes.
void add_kinds(Block& facts, const std::vector<FixTypeErrors>& kinds) {
    std::vector<std::pair<FixType, std::string>> lines;
    for (const FixTypeErrors& kind : kinds) {
        const auto line = std::find_if(lines.begin(), lines.end(),
                                       [&](const auto& each) { return each.first == kind.fix; });
        if (line == lines.end())
            lines.emplace_back(kind.fix, fix_type_errors_text(kind));
        else
            line->second += "; " + fix_type_errors_text(kind);
    }
    for (auto& [fix, text] : lines)
        add_fact(facts, capitalised(words_of(fix)), std::move(text));
}

std::string time_text(const ScreenedTable& table) {
    const TimeStampSummary& time = table.basis.time;
    std::string text = fmt::format("{}, ", counted(time.sessions, "session"));
    text += time.gaps == 0 ? "no gap"
                           : fmt::format("{}, the longest {} s", counted(time.gaps, "gap"),
                                         format_fixed(time.longest_gap_s, 3));
    text += fmt::format(", {} repeated and {} backward; mostly {} s apart, the mean interval ",
                        counted(time.duplicates), counted(time.backward),
                        format_fixed(table.facts.nominal_interval_s, 3));
    const std::string deviation = format_fixed(std::abs(time.rate_deviation) * 1e6, 1);
    text += deviation == "0.0" ? "as it should be"
                               : fmt::format("{} millionths {} than it should be", deviation,
                                             time.rate_deviation > 0.0 ? "longer" : "shorter");
    return text + fmt::format(", scattering by {} s", significant_text(time.jitter_s, 2));
}

std::string fault_text(const ScreenedTable& table, const TimeFault& fault) {
    const auto row = std::ranges::find(table.rows, fault.epoch, &ScreenedEpoch::epoch);
    return fmt::format("epoch {}{}: {}", fault.epoch,
                       row != table.rows.end() && row->source_line
                           ? fmt::format(" (line {})", *row->source_line)
                           : "",
                       time_fault_text(fault));
}

void add_time(Block& facts, const ScreenedTable& table, std::size_t faults_shown) {
    add_fact(facts, "Time stamps", time_text(table));
    const auto& faults = table.basis.time.faults;
    const std::size_t shown = std::min(faults.size(), faults_shown);
    for (std::size_t i = 0; i < shown; ++i)
        add_fact(facts, "Fault of time stamps", fault_text(table, faults[i]));
    if (const std::int64_t left =
            time_stamp_faults(table.basis.time) - static_cast<std::int64_t>(shown);
        left > 0)
        add_fact(facts, "Further faults of time stamps", counted(left));
}

std::string limits_text(const ScreenedTable& table) {
    const LimitComparison& limits = table.basis.limits;
    return fmt::format(
               "largest acceleration {} m/s^2 (limit of the class {} m/s^2), largest jerk {} m/s^3 "
               "({} m/s^3)",
               format_fixed(limits.acceleration_m_s2, 1),
               format_fixed(limits.acceleration_max_m_s2, 1), format_fixed(limits.jerk_m_s3, 1),
               format_fixed(limits.jerk_max_m_s3, 1)) +
           (table.facts.vertical_measured
                ? fmt::format(", largest vertical rate {} m/s ({} m/s)",
                              format_fixed(limits.vertical_rate_m_s, 1),
                              format_fixed(limits.vertical_rate_max_m_s, 1))
                : "") +
           fmt::format("; {} beyond them", counted(limits.rejected, "epoch"));
}

/// What rows have of a figure: how many do, and which has the largest.
struct LargestOf {
    std::int64_t count = 0;
    const ScreenedEpoch* row = nullptr;
    double value = 0.0;
};

LargestOf largest_of(const std::vector<ScreenedEpoch>& rows, auto figure) {
    LargestOf found;
    for (const ScreenedEpoch& row : rows) {
        const auto value = row.*figure;
        if (!value) continue;
        ++found.count;
        if (!found.row || *value > found.value)
            found = {.count = found.count, .row = &row, .value = *value};
    }
    return found;
}

/// Sudden motion that tests allowed for, and where the errors around an epoch were larger.
void add_allowances(Block& facts, const std::vector<ScreenedEpoch>& rows) {
    const LargestOf loudest = largest_of(rows, &ScreenedEpoch::local_variance_factor);
    if (loudest.value > 1.0)
        add_fact(facts, "Locally larger errors",
                 fmt::format("its statistics are divided by the ratio of the variances, at most "
                             "{} (epoch {})",
                             format_fixed(loudest.value, 2), loudest.row->epoch));
    const LargestOf sudden = largest_of(rows, &ScreenedEpoch::manoeuvre_m_s2);
    if (sudden.row)
        add_fact(facts, "Manoeuvres allowed for",
                 fmt::format("at {}: a change of the acceleration explains the data better than an "
                             "error, at most {} m/s^2 (epoch {})",
                             counted(sudden.count, "epoch"), format_fixed(sudden.value, 1),
                             sudden.row->epoch));
}

/// What was decided for, as a noun that can be counted.
struct Noun {
    std::string one;
    std::string several;
};

Noun decided_for(Hypothesis hypothesis) {
    switch (hypothesis) {
        case Hypothesis::outlier:
            return {"single outlier", "single outliers"};
        case Hypothesis::burst:
            return {"position in a run of wrong ones", "positions in runs of wrong ones"};
        case Hypothesis::step:
            return {"step of the positions", "steps of the positions"};
        case Hypothesis::ramp:
            return {"drift of the positions", "drifts of the positions"};
        case Hypothesis::time_shift:
            return {"jump of the time stamps", "jumps of the time stamps"};
        case Hypothesis::model:
            return {"position in a stretch that no single error explains",
                    "positions in stretches that no single error explains"};
        case Hypothesis::velocity:
            return {"position that the recorded velocity contradicts",
                    "positions that the recorded velocities contradict"};
        case Hypothesis::acceleration:
            return {"acceleration that the craft cannot make",
                    "accelerations that the craft cannot make"};
        case Hypothesis::jerk:
            return {"jerk that the craft cannot make", "jerks that the craft cannot make"};
        case Hypothesis::vertical_rate:
            return {"vertical rate that the craft cannot make",
                    "vertical rates that the craft cannot make"};
        case Hypothesis::baseline:
            return {"position that the other receiver contradicts",
                    "positions that the other receiver contradicts"};
        case Hypothesis::surface:
            return {"height that the surface contradicts", "heights that the surface contradicts"};
        case Hypothesis::phase:
        case Hypothesis::wheel:
            break;
    }
    const auto witness = witness_of(hypothesis);
    return {fmt::format("position that the {} contradict", witness.at(0)),
            fmt::format("positions that the {} contradict", witness.at(0))};
}

std::string decisions_text(const ScreeningSummary& summary) {
    std::string text;
    for (const auto& [hypothesis, count] : summary.decisions) {
        const Noun noun = decided_for(hypothesis);
        text += fmt::format("{}{} {}", text.empty() ? "" : "; ", count,
                            count == 1 ? noun.one : noun.several);
    }
    return text.empty() ? "nothing" : text;
}

std::string used_text(const ScreenedTable& table, const ScreeningSummary& summary) {
    std::string used =
        fmt::format("{} of {}", counted(summary.usable), counted(std::ssize(table.rows)));
    if (summary.arcs == 0) return used;
    const std::string longest = format_fixed(longest_arc_s(table.rows), 3);
    if (summary.arcs == 1) return fmt::format("{}, in one arc, of {} s", used, longest);
    return fmt::format("{}, in {} arcs, the longest of {} s", used, summary.arcs, longest);
}

void add_basis(Block& facts, const ScreenedTable& table, std::size_t faults_shown) {
    const ScreeningBasis& basis = table.basis;
    add_fact(facts, "False alarms", false_alarm_text(basis));
    for (const ScreeningModel& model : basis.models)
        add_fact(facts, fmt::format("Noise assumed, {}", to_text(model.axes)), model_text(model));
    if (basis.models.empty()) add_fact(facts, "Noise assumed", "none: nothing could be tested");
    add_allowances(facts, table.rows);
    add_kinds(facts, basis.fix_types);
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
    add_time(facts, table, faults_shown);
    if (basis.baseline)
        add_fact(facts, "Other receiver", baseline_comparison_text(*basis.baseline));
}

}  // namespace

std::int64_t time_stamp_faults(const TimeStampSummary& time) {
    return std::max(time.gaps + time.duplicates + time.backward, std::ssize(time.faults));
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

ElapsedTime last_time(const std::vector<ScreenedEpoch>& rows) {
    ElapsedTime last;
    for (const ScreenedEpoch& row : rows)
        last = std::max(last, row.time);
    return last;
}

std::vector<Block> screening_results(const ScreenedTable& screened, std::size_t faults_shown) {
    const ScreeningSummary summary = summarise(screened.rows);
    Block list = facts({});
    add_fact(list, "Epochs used", used_text(screened, summary));
    add_fact(list, "Decided by the tests", decisions_text(summary));
    add_basis(list, screened, faults_shown);
    Block counts = table({">Epochs|14", "Decision of screening|86"});
    for (const auto& [reason, count] : summary.reasons)
        add_row(counts,
                {counted(count), reason == Reason::none ? "used" : std::string(words_of(reason))});
    return {std::move(list), std::move(counts)};
}

}  // namespace runcert
