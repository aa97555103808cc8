#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/text.h"
#include "stages/import/imu/propose.h"
#include "stages/import/inspect.h"
#include "stages/import/recognise.h"

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

void add_measured(FactGroup& facts, const Proposal& proposal) {
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

/// What an attempt must say beside what the file shows.
void add_needs(const Proposal& proposal, Recognition& is) {
    const auto need = [&](const char* key, bool required) {
        is.needed.push_back(needed_key(key, required));
    };
    if (is.format == "novatel") {
        need("imu.gyro_scale", true);
        need("imu.accelerometer_scale", true);
    }
    if (proposal.raw && proposal.raw->stamps == Stamps::count) need("imu.start_gps", false);
    need("imu.antenna_m", true);
    need("imu.grade", false);
    is.needed.back().values = {"tactical", "mems", "consumer"};
}

}  // namespace

Recognition recognition_of(const Proposal& proposal) {
    Recognition is = proposal.is;
    is.kind = RecordingKind::imu;
    is.format = proposal.raw ? proposal.raw->format : "csv";
    add_needs(proposal, is);
    FactGroup measured{.title = "IMU"};
    add_fact(measured, "Format", format_text(proposal));
    if (proposal.raw) add_measured(measured, proposal);
    is.said.push_back(std::move(measured));
    if (!proposal.raw) return is;
    const RawFile& raw = *proposal.raw;
    for (const std::string& note : raw.notes)
        is.concerns.push_back({.code = ConcernCode::reading, .says = note});
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
