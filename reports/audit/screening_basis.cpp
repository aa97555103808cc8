#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "reports/audit/screening.h"
#include "reports/words/screening.h"

namespace runcert {
namespace {

std::string_view adverb(TestedAxes axes) {
    return axes == TestedAxes::horizontal ? "horizontally" : "vertically";
}

std::string recording_text(const ScreenedTable& table, const AuditSubject& subject) {
    const ScreeningSummary summary = summarise(table.rows);
    std::string text = fmt::format("{}: {}, {} used, in {} without gap or step.", subject.recording,
                                   counted(std::ssize(table.rows), "epoch"),
                                   counted(summary.usable), counted(summary.arcs, "arc"));
    std::vector<std::string> reasons;
    for (const auto& [reason, count] : summary.reasons)
        if (reason != Reason::none)
            reasons.push_back(fmt::format("{} ({})", counted(count), words_of(reason)));
    if (!reasons.empty()) text += " Left out: " + listed(reasons) + ".";
    if (table.facts.first_epoch)
        text += fmt::format(" The first epoch is at {}.", to_utc_iso(*table.facts.first_epoch));
    return text;
}

std::string checked_text(const AuditSubject& subject) {
    if (subject.checked.empty()) return {};
    return fmt::format("The hashes (SHA-256) of {} are those that the files made from them name.",
                       listed(subject.checked));
}

std::string unchecked_text(const AuditSubject& subject) {
    if (subject.unchecked.empty()) return {};
    return fmt::format(
        "Not checked, because the folder lacks the file or the one that names its hash: {}.",
        listed(subject.unchecked));
}

std::string noise_sentence(const ScreeningModel& model) {
    const std::string figures =
        fmt::format("{} times the stated standard deviations and a jerk density of {:.3g} m s^-2.5",
                    format_fixed(model.measurement_scale, 2), model.jerk_density);
    if (model.noise != NoiseBasis::fitted) {
        return fmt::format(
            "The tests rested {} on {}: noise was not estimated from the recording ({}).",
            adverb(model.axes), figures, words_of(model.noise));
    }
    constexpr double least_m = 5e-5;  // what is not zero as written
    const std::string slow =
        model.error_sigma_m >= least_m
            ? fmt::format("a time-correlated error of {} m with a correlation time of {:.3g} s",
                          format_fixed(model.error_sigma_m, 4), model.error_tau_s)
            : std::string("no time-correlated error");
    return fmt::format("The tests rested {} on noise estimated from the recording: {}, {}.",
                       adverb(model.axes), figures, slow);
}

std::string noise_text(const ScreenedTable& table) {
    std::string text;
    for (const ScreeningModel& model : table.basis.models)
        text += (text.empty() ? "" : " ") + noise_sentence(model);
    const ScreenedEpoch* loudest = nullptr;
    for (const ScreenedEpoch& row : table.rows)
        if (row.local_variance_factor &&
            (!loudest || *row.local_variance_factor > *loudest->local_variance_factor))
            loudest = &row;
    if (loudest && *loudest->local_variance_factor > 1.0)
        text += fmt::format(
            " Where the errors around an epoch are larger, its statistics are divided by the ratio "
            "of the variances, at most {} (epoch {}).",
            format_fixed(*loudest->local_variance_factor, 2), loudest->epoch);
    return text;
}

std::string tests_text(const ScreeningBasis& basis) {
    std::string text = fmt::format("{} planned, the recording gone through {}.",
                                   counted(basis.tests, "test"), counted(basis.passes, "time"));
    if (basis.family_false_alarm_rate > 0.0 && basis.test_size > 0.0)
        text += fmt::format(" One test rejects by chance {}; {}.", once_in(basis.test_size),
                            false_alarm_text(basis));
    return text + fmt::format(
                      " An error of the minimal detectable size (see the end) is found with a "
                      "probability of {} %.",
                      format_fixed(100.0 * basis.power, 1));
}

/// Motion that screening found sudden, and positions that look as if nobody had measured them.
std::string motion_text(const ScreenedTable& table) {
    std::int64_t manoeuvres = 0;
    const ScreenedEpoch* largest = nullptr;
    for (const ScreenedEpoch& row : table.rows) {
        if (!row.manoeuvre_m_s2) continue;
        ++manoeuvres;
        if (!largest || *row.manoeuvre_m_s2 > *largest->manoeuvre_m_s2) largest = &row;
    }
    if (!largest) return "";
    return fmt::format(
        "At {} the acceleration was found to change beyond what the tests take for "
        "granted, at most by {} m/s^2 (epoch {}): a manoeuvre of the craft explains the data "
        "better than an error, and the tests allow for it.",
        counted(manoeuvres, "epoch"), format_fixed(*largest->manoeuvre_m_s2, 1), largest->epoch);
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
    text += fmt::format(", scattering by {} s.", significant_text(time.jitter_s, 2));
    const std::int64_t all = time.gaps + time.duplicates + time.backward;
    if (std::ssize(time.faults) < all)
        text += fmt::format(" The table holds the first {} of {} faults.",
                            counted(std::ssize(time.faults)), counted(all));
    return text;
}

std::string fault_line(const ScreenedTable& table, const TimeFault& fault) {
    const auto row =
        std::find_if(table.rows.begin(), table.rows.end(),
                     [&](const ScreenedEpoch& each) { return each.epoch == fault.epoch; });
    std::string where = fmt::format("at epoch {}", fault.epoch);
    if (row != table.rows.end() && row->source_line)
        where += fmt::format(" (line {})", *row->source_line);
    return where + ": " + time_fault_text(fault);
}

std::string limits_text(const ScreenedTable& table) {
    const LimitComparison& limits = table.basis.limits;
    std::string text = fmt::format(
        "Of the epochs kept the largest acceleration is {} m/s^2 (limit of the class {} "
        "m/s^2); the largest jerk is {} m/s^3 ({} m/s^3)",
        format_fixed(limits.acceleration_m_s2, 1), format_fixed(limits.acceleration_max_m_s2, 1),
        format_fixed(limits.jerk_m_s3, 1), format_fixed(limits.jerk_max_m_s3, 1));
    if (table.facts.vertical_measured)
        text += fmt::format(", the largest vertical rate {} m/s ({} m/s)",
                            format_fixed(limits.vertical_rate_m_s, 1),
                            format_fixed(limits.vertical_rate_max_m_s, 1));
    return text + fmt::format("; {} beyond them.", counted(limits.rejected, "epoch"));
}

}  // namespace

Block basis_block(const ScreenedTable& table, const AuditSubject& subject) {
    const ScreeningBasis& basis = table.basis;
    Block told = facts({{"Recording", recording_text(table, subject)}});
    add_fact(told, "Files", checked_text(subject));
    add_fact(told, "Files", unchecked_text(subject));
    if (!basis.models.empty()) add_fact(told, "Noise", noise_text(table));
    add_fact(told, "Tests", tests_text(basis));
    for (const FixTypeErrors& errors : basis.fix_types)
        add_fact(told, "Fix type",
                 fmt::format("{}, {}.", capitalised(words_of(errors.fix)),
                             fix_type_errors_text(errors)));
    add_fact(told, "Recorded velocities",
             basis.velocity ? sentence(velocity_comparison_text(*basis.velocity))
                            : "None, or fewer than 30, were recorded.");
    for (const DisplacementComparison& each : basis.displacements)
        add_fact(told, "Displacements", sentence(displacement_comparison_text(each)));
    add_fact(told, "Time stamps", time_text(table));
    for (const TimeFault& fault : basis.time.faults)
        add_fact(told, "Fault of time stamps", fault_line(table, fault));
    add_fact(told, "Limits", limits_text(table));
    add_fact(told, "Motion", motion_text(table));
    if (basis.device)
        add_fact(told, "Device",
                 fmt::format("Signs of positions that were not measured: {}.",
                             device_signs_text(*basis.device)));
    add_fact(told, "Other receiver",
             basis.baseline ? sentence(baseline_comparison_text(*basis.baseline))
                            : "None was compared with this one.");
    return told;
}

}  // namespace runcert
