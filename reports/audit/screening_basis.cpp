#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "reports/audit/screening_parts.h"
#include "reports/audit/words.h"

namespace runcert {
namespace {

std::string_view adverb(TestedAxes axes) {
    return axes == TestedAxes::horizontal ? "horizontally" : "vertically";
}

std::string recording_text(const ScreenedTable& table, const AuditSubject& subject) {
    const ScreeningSummary summary = summarise(table.rows);
    std::string text = fmt::format("Recording. {}: {}, {} used, in {} (arcs).",
                                   subject.recording, counted(std::ssize(table.rows), "epoch"),
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

std::string files_text(const ScreenedTable& table, const AuditSubject& subject) {
    std::string text = fmt::format("Files. Written by runcert {}, source {}, schema {} {}.",
                                   table.header.program_version, table.header.source_revision,
                                   table.header.schema_name, table.header.schema_version);
    if (!subject.checked.empty())
        text += fmt::format(
            " The hashes (SHA-256) of {} are those that the files made from them "
            "name.",
            listed(subject.checked));
    if (!subject.unchecked.empty())
        text += fmt::format(
            " Not checked, because the folder lacks the file or the one that names "
            "its hash: {}.",
            listed(subject.unchecked));
    return text;
}

std::string noise_sentence(const ScreeningModel& model) {
    const std::string figures =
        fmt::format("{} times the stated standard deviations and a jerk density of {:.3g} m s^-2.5",
                    format_fixed(model.measurement_scale, 2), model.jerk_density);
    if (model.noise != NoiseBasis::fitted) {
        return fmt::format(
            " The tests rested {} on {}: noise was not estimated from the recording ({}).",
            adverb(model.axes), figures, words_of(model.noise));
    }
    constexpr double least_m = 5e-5;  // what is not zero as written
    const std::string slow =
        model.error_sigma_m >= least_m
            ? fmt::format("a time-correlated error of {} m with a correlation time of {:.3g} s",
                          format_fixed(model.error_sigma_m, 4), model.error_tau_s)
            : std::string("no time-correlated error");
    return fmt::format(" The tests rested {} on noise estimated from the recording: {}, {}.",
                       adverb(model.axes), figures, slow);
}

std::string noise_text(const ScreenedTable& table) {
    std::string text = "Noise.";
    for (const ScreeningModel& model : table.basis.models)
        text += noise_sentence(model);
    const ScreenedEpoch* loudest = nullptr;
    for (const ScreenedEpoch& row : table.rows)
        if (row.local_variance_factor &&
            (!loudest || *row.local_variance_factor > *loudest->local_variance_factor))
            loudest = &row;
    if (loudest && *loudest->local_variance_factor > 1.0)
        text += fmt::format(
            " Where the errors around an epoch are larger than that, its statistics are divided "
            "by how much larger their variance is, at most {} (epoch {}).",
            format_fixed(*loudest->local_variance_factor, 2), loudest->epoch);
    return text;
}

std::string tests_text(const ScreeningBasis& basis) {
    const double rate = basis.family_false_alarm_rate;
    std::string text = fmt::format("Tests. {} planned, the recording gone through {}.",
                                   counted(basis.tests, "test"), counted(basis.passes, "time"));
    if (rate > 0.0 && basis.test_size > 0.0)
        text += fmt::format(
            " A test rejects by chance {}: in a recording without an outlier, and with that "
            "noise, the tests together mark anything in at most 1 of {} recordings.",
            once_in(basis.test_size),
            counted(static_cast<std::int64_t>(std::floor(1.0 / rate + 1e-9))));
    return text + fmt::format(
                      " An error of the smallest detectable size (see the end) is found with a "
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
        "Motion. At {} the acceleration was found to change beyond what the tests take for "
        "granted, at most by {} m/s^2 (epoch {}): a manoeuvre of the craft explains the data "
        "better than an error, and the tests allow for it.",
        counted(manoeuvres, "epoch"), format_fixed(*largest->manoeuvre_m_s2, 1), largest->epoch);
}

std::string device_text(const DeviceSigns& device) {
    return fmt::format(
        "Device. Of {} recorded in motion {} repeat the one before (held), and {} lie in line with "
        "their neighbours to the last digit (interpolated), where chance makes {}.",
        counted(device.moving, "position"), counted(device.held), counted(device.interpolated),
        format_fixed(device.by_chance, 1));
}

std::string kind_sentence(const FixTypeErrors& kind) {
    const std::string what = fmt::format(" {}, {} ({}): ", capitalised(words_of(kind.fix)),
                                         adverb(kind.axes), counted(kind.epochs, "epoch"));
    const std::string factor = fmt::format(
        "errors {} times as large as stated (variance factor {})",
        format_fixed(std::sqrt(kind.variance_factor), 2), format_fixed(kind.variance_factor, 3));
    if (kind.judgement == AccuracyJudgement::too_few_epochs)
        return what + "too few epochs to tell how large its errors are.";
    if (kind.judgement == AccuracyJudgement::optimistic)
        return what + factor + ": the stated standard deviation is optimistic: the errors are larger.";
    if (kind.judgement == AccuracyJudgement::pessimistic)
        return what + factor + ": the stated standard deviation is pessimistic: the errors are smaller.";
    return what + factor + ": as stated.";
}

std::string velocity_text(const VelocityComparison& velocity) {
    std::string text =
        fmt::format("Velocities. Recorded velocities were compared with the motion at {}",
                    counted(velocity.compared, "epoch"));
    if (velocity.compared == 0)
        return text +
               ": too few could be compared, or they never change; nothing follows from "
               "them.";
    text += fmt::format("; they differ by {} m/s (robust standard deviation of each component).",
                        format_fixed(velocity.scale_m_s, 3));
    if (velocity.delay_s)
        text += fmt::format(" They are {} s{} {} the positions.",
                            format_fixed(std::abs(*velocity.delay_s), 3),
                            velocity.sigma_delay_s
                                ? fmt::format(" ± {} s", format_fixed(*velocity.sigma_delay_s, 3))
                                : "",
                            *velocity.delay_s < 0.0 ? "ahead of" : "behind");
    else
        text += " The motion does not tell whether they are late.";
    return text + fmt::format(" They contradict {}.", counted(velocity.rejected, "epoch"));
}

std::string time_text(const ScreenedTable& table) {
    const TimeStampSummary& time = table.basis.time;
    std::string text = fmt::format("Time stamps. {}, ", counted(time.sessions, "session"));
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
    text += fmt::format(", scattering by {} s.", format_fixed(time.jitter_s, 6));
    const std::int64_t all = time.gaps + time.duplicates + time.backward;
    if (std::ssize(time.faults) < all)
        text += fmt::format(" The table holds the first {} of {} faults.",
                            counted(std::ssize(time.faults)), counted(all));
    return text + (time.faults.empty() ? "" : " Faults:");
}

std::string fault_line(const ScreenedTable& table, const TimeFault& fault) {
    const auto row =
        std::find_if(table.rows.begin(), table.rows.end(),
                     [&](const ScreenedEpoch& each) { return each.epoch == fault.epoch; });
    std::string where = fmt::format("at epoch {}", fault.epoch);
    if (row != table.rows.end() && row->source_line)
        where += fmt::format(" (line {})", *row->source_line);
    const std::string size = format_fixed(std::abs(fault.size_s), 3) + " s";
    const std::string what =
        fault.kind == TimeFaultKind::gap         ? size + " missing"
        : fault.kind == TimeFaultKind::backward  ? "the clock goes back by " + size
        : fault.kind == TimeFaultKind::duplicate ? "the time of the epoch before"
        : fault.kind == TimeFaultKind::session
            ? fmt::format("another session begins, {} {}", size,
                          fault.size_s < 0.0 ? "back" : "later")
            : fmt::format("the clock jumps by {} while the positions go on", size);
    return where + ": " + what;
}

std::string limits_text(const ScreenedTable& table) {
    const LimitComparison& limits = table.basis.limits;
    std::string text = fmt::format(
        "Limits. Of the epochs kept the largest acceleration is {} m/s^2 (a craft of the class can "
        "make {} m/s^2), the largest jerk {} m/s^3 ({} m/s^3)",
        format_fixed(limits.acceleration_m_s2, 1), format_fixed(limits.acceleration_max_m_s2, 1),
        format_fixed(limits.jerk_m_s3, 1), format_fixed(limits.jerk_max_m_s3, 1));
    if (table.facts.vertical_measured)
        text += fmt::format(", the largest vertical rate {} m/s ({} m/s)",
                            format_fixed(limits.vertical_rate_m_s, 1),
                            format_fixed(limits.vertical_rate_max_m_s, 1));
    return text + fmt::format("; {} beyond them.", counted(limits.rejected, "epoch"));
}

std::string baseline_text(const BaselineComparison& baseline) {
    return fmt::format(
        "Other receiver. Compared with {} at {}: the antennas are {} m apart, with a standard "
        "deviation of {} m; {} contradicted.",
        baseline.receiver, counted(baseline.compared, "epoch"), format_fixed(baseline.length_m, 3),
        format_fixed(baseline.sd_m, 3), counted(baseline.rejected, "epoch"));
}

}  // namespace

std::vector<Block> basis_blocks(const ScreenedTable& table, const AuditSubject& subject) {
    std::vector<Block> blocks;
    const auto say = [&](std::string text) { blocks.emplace_back(Paragraph{std::move(text)}); };
    say(recording_text(table, subject));
    say(files_text(table, subject));
    const ScreeningBasis& basis = table.basis;
    if (!basis.models.empty()) say(noise_text(table));
    say(tests_text(basis));
    std::string kinds = "Solutions.";
    for (const FixTypeErrors& kind : basis.fix_types)
        kinds += kind_sentence(kind);
    if (!basis.fix_types.empty()) say(kinds);
    say(basis.velocity ? velocity_text(*basis.velocity)
                       : "Velocities. None, or fewer than 30, were recorded.");
    say(time_text(table));
    Entries faults{.items = {}, .nested = true};
    for (const TimeFault& fault : basis.time.faults)
        faults.items.push_back(fault_line(table, fault));
    if (!faults.items.empty()) blocks.emplace_back(std::move(faults));
    say(limits_text(table));
    if (std::string motion = motion_text(table); !motion.empty()) say(std::move(motion));
    if (basis.device) say(device_text(*basis.device));
    say(basis.baseline ? baseline_text(*basis.baseline)
                       : "Other receiver. None was compared with this one.");
    return blocks;
}

}  // namespace runcert
