#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/text.h"
#include "stages/import/imu/propose.h"

// What is said of an IMU's file before an attempt names it.

namespace runcert::imu {
namespace {

std::string format_text(const Proposal& proposal) {
    if (!proposal.raw) return "a table";
    const std::string& format = proposal.raw->format;
    if (format == "kf-gins") return "KF-GINS text: seconds of the GPS week, increments";
    if (format == "novatel")
        return "NovAtel RAWIMU, read by its published description; no recorded log was at hand";
    return "a table";
}

std::string times_text(const RawFile& raw) {
    const auto seconds = [](std::int64_t ns) {
        return format_fixed(static_cast<double>(ns) * 1e-9, 3);
    };
    const std::int64_t first = raw.samples.front().time_ns, last = raw.samples.back().time_ns;
    if (raw.stamps == Stamps::gps)
        return fmt::format("{} to {} GPS time", to_iso(GpsTime::from_nanoseconds(first), 3),
                           to_iso(GpsTime::from_nanoseconds(last), 3));
    return fmt::format(
        "{} s to {} s {}", seconds(first), seconds(last),
        raw.stamps == Stamps::week ? "of the GPS week" : "of a count without a date");
}

std::string gravity_text(const Stretch& quiet) {
    Eigen::Index axis = 0;
    quiet.force_m_s2.cwiseAbs().maxCoeff(&axis);
    const double size = quiet.force_m_s2.norm();
    const double off = std::acos(std::min(std::abs(quiet.force_m_s2[axis]) / size, 1.0));
    return fmt::format("{} m/s2 in the quietest second; the {}{} axis points down, {} degrees off",
                       format_fixed(size, 3), quiet.force_m_s2[axis] > 0.0 ? "-" : "", "xyz"[axis],
                       format_fixed(Angle::from_radians(off).degrees(), 1));
}

std::string range_text(const SampleFaults& faults) {
    const auto count = std::count(faults.saturated.begin(), faults.saturated.end(), true);
    if (count == 0) return "none";
    std::string text = fmt::format("{} samples", count);
    if (faults.gyro_range_rad_s)
        text +=
            fmt::format(", gyros at {} deg/s",
                        format_fixed(Angle::from_radians(*faults.gyro_range_rad_s).degrees(), 1));
    if (faults.accelerometer_range_m_s2)
        text += fmt::format(", accelerometers at {} m/s2",
                            format_fixed(*faults.accelerometer_range_m_s2, 1));
    return text;
}

void add_measured(Block& facts, const Proposal& proposal) {
    const RawFile& raw = *proposal.raw;
    const Sampling& sampling = *proposal.sampling;
    const SampleFaults faults = faults_of(raw, sampling);
    const auto repeated = std::count(faults.repeated.begin(), faults.repeated.end(), true);
    add_fact(facts, "Samples",
             fmt::format("{}{}", raw.samples.size(),
                         sampling.held > 0
                             ? fmt::format("; {} more only repeat the one before", sampling.held)
                             : ""));
    add_fact(facts, "Times", times_text(raw));
    add_fact(facts, "Rate",
             fmt::format("{} Hz; stamps jitter by {} ms", format_fixed(sampling.clock.rate_hz, 2),
                         format_fixed(sampling.clock.jitter_s * 1e3, 2)));
    add_fact(facts, "Gravity", gravity_text(*proposal.quiet));
    add_fact(facts, "Gyros at rest",
             fmt::format("{} deg/s",
                         format_fixed(
                             Angle::from_radians(proposal.quiet->rate_rad_s.norm()).degrees(), 3)));
    add_fact(facts, "Gaps",
             sampling.gaps == 0 ? "none"
                                : fmt::format("{}, the longest of {} s", sampling.gaps,
                                              format_fixed(sampling.longest_gap_s, 3)));
    if (repeated > 0)
        add_fact(facts, "Repeated", fmt::format("{} samples repeat the one before", repeated));
    add_fact(facts, "At the end of the range", range_text(faults));
    if (raw.records.bad > 0)
        add_fact(facts, "Not readable",
                 fmt::format("{} of {} records", raw.records.bad, raw.records.total));
}

/// As YAML reads it: in quotation marks where it is more than letters, digits and a few signs.
std::string yaml_word(std::string_view value) {
    const bool plain = std::ranges::all_of(value, [](char c) {
        return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
               c == '-' || c == '.' || c == '/';
    });
    return plain ? std::string(value) : fmt::format("\"{}\"", escape_for_message(value));
}

/// The lines of an attempt. Of a count without a date the start is left open.
std::string yaml_of(const Proposal& proposal) {
    std::string columns, axes, rest;
    const auto append = [](std::string& map, std::string_view key, std::string_view value) {
        map += fmt::format("{}{}: {}", map.empty() ? "" : ", ", key, yaml_word(value));
    };
    for (const ProposedKey& one : proposal.keys) {
        const std::string_view key = one.key;
        if (key.starts_with("columns."))
            append(columns, key.substr(8), one.value);
        else if (key.starts_with("axes."))
            append(axes, key.substr(5), one.value);
        else
            rest += fmt::format("  {}: {}\n", key, one.value);
    }
    const std::string file = proposal.receiver.imu->file;
    std::string text =
        fmt::format("imu:\n  file: {}\n", yaml_word(file.substr(file.find_last_of('/') + 1)));
    if (!columns.empty()) text += fmt::format("  columns: {{{}}}\n", columns);
    if (!axes.empty()) text += fmt::format("  axes: {{{}}}\n", axes);
    text += rest;
    if (proposal.raw && proposal.raw->format == "novatel")
        text += "  gyro_scale: ...\n  accelerometer_scale: ...\n";
    if (proposal.raw && proposal.raw->stamps == Stamps::count)
        text +=
            "  start_gps: \"...\"  # of the first sample, where its clock is not the recording's\n";
    return text +
           "  grade: ...  # tactical, mems or consumer\n"
           "  antenna_m: {forward: ..., right: ..., down: ...}  # from the IMU to the antenna";
}

}  // namespace

Section section_of(const Proposal& proposal) {
    Section section{.anchor = "imu", .title = "IMU"};
    Block measured = facts({});
    add_fact(measured, "Format", format_text(proposal));
    if (proposal.raw) add_measured(measured, proposal);
    add(section, measured);
    if (!proposal.problem.empty()) add(section, paragraph(proposal.problem, "warning"));
    add(section, paragraph("An attempt describes it so, beside its receiver's recording:"));
    add(section, code(yaml_of(proposal)));
    std::vector<std::string> said = proposal.unsure;
    if (proposal.raw)
        said.insert(said.end(), proposal.raw->notes.begin(), proposal.raw->notes.end());
    if (!said.empty()) add(section, list_of(said));
    return section;
}

Recognition recognition_of(const Proposal& proposal) {
    Recognition is{.kind = RecordingKind::imu};
    is.format = proposal.raw ? proposal.raw->format : "csv";
    is.problem = proposal.problem;
    for (const ProposedKey& one : proposal.keys)
        is.proposed.push_back({"imu." + one.key, one.value, one.reason});
    if (!proposal.raw) return is;
    const RawFile& raw = *proposal.raw;
    const std::int64_t first = raw.samples.front().time_ns, last = raw.samples.back().time_ns;
    if (raw.stamps == Stamps::gps) {
        is.first = GpsTime::from_nanoseconds(first);
        is.last = GpsTime::from_nanoseconds(last);
    } else {
        is.count_s = static_cast<double>(first) * 1e-9;
    }
    is.span_s = static_cast<double>(last - first) * 1e-9;
    is.epochs = std::ssize(raw.samples);
    is.interval_s = proposal.sampling->clock.interval_s;
    return is;
}

}  // namespace runcert::imu
