#include "stages/import/imu/tie.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/failure.h"
#include "core/text.h"

namespace runcert::imu {
namespace {

/// A way to take the samples' times: what is added to them (ns) to have them count from the
/// recording's first epoch, and what they are then.
struct Reading {
    std::int64_t added_ns = 0;
    std::string_view what;
};

double seconds_of(const RawSample& sample, const Reading& reading) {
    return (static_cast<double>(sample.time_ns) + static_cast<double>(reading.added_ns)) * 1e-9;
}

bool shares_time(const Reading& reading, const RawFile& raw, double span_s) {
    constexpr double counted_s = 9e9;  // in nanoseconds of 64 bits
    const double from_s = seconds_of(raw.samples.front(), reading);
    const double to_s = seconds_of(raw.samples.back(), reading);
    return from_s > -counted_s && from_s < span_s && to_s > 0.0 && to_s < counted_s;
}

/// Failure where the difference does not fit.
std::int64_t less(std::int64_t from, std::int64_t taken) {
    std::int64_t difference = 0;
    if (__builtin_sub_overflow(from, taken, &difference))
        throw Failure("time", "two times are more than 292 years apart",
                      "Correct start_gps, time_unit or the column of the time in imu");
    return difference;
}

/// Added to seconds of the week, so that the first sample is within half a week of the first epoch.
std::int64_t of_week(const GpsTime& first_epoch, std::int64_t first_sample_ns) {
    constexpr std::int64_t week = GpsTime::nanoseconds_per_week;
    std::int64_t off = first_sample_ns - first_epoch.nanoseconds_of_week();
    const std::int64_t weeks = off > week / 2 ? -1 : off < -week / 2 ? 1 : 0;
    return weeks * week - first_epoch.nanoseconds_of_week();
}

/// Added to a count since 1970, UTC; nothing for numbers that are none of 1980 to 2100.
std::optional<std::int64_t> since_1970(const GpsTime& first_epoch, std::int64_t first_sample_ns) {
    constexpr std::int64_t second = GpsTime::nanoseconds_per_second;
    constexpr std::int64_t epoch_1980 = 315'964'800, year_2100 = 4'102'444'800;
    const std::int64_t seconds = first_sample_ns / second;
    if (seconds < epoch_1980 || seconds > year_2100) return std::nullopt;
    const GpsTime utc = GpsTime::from_nanoseconds(first_sample_ns - epoch_1980 * second);
    const GpsTime gps = gps_from_utc(utc.calendar());
    return less(gps.nanoseconds() - first_sample_ns, first_epoch.nanoseconds());
}

/// The ways in which times without a date may be taken, the likeliest first.
std::vector<Reading> readings_of_count(const RecordingSpan& recording, const RawFile& raw) {
    std::vector<Reading> ways;
    const std::int64_t first = raw.samples.front().time_ns;
    if (raw.stamps == Stamps::count && recording.count_ns)
        ways.push_back({-*recording.count_ns, "the recording's own count of time"});
    if (recording.first_epoch) {
        if (raw.stamps == Stamps::count)
            if (const auto added = since_1970(*recording.first_epoch, first))
                ways.push_back({*added, "a count since 1970, UTC"});
        ways.push_back({of_week(*recording.first_epoch, first), "seconds of the GPS week"});
    }
    if (raw.stamps == Stamps::count)
        ways.push_back({0, "seconds from the recording's first epoch"});
    return ways;
}

std::string span_text(double from_s, double to_s, const RecordingSpan& recording) {
    constexpr double dated_s = 2e9;
    if (!recording.first_epoch || std::abs(from_s) > dated_s || std::abs(to_s) > dated_s)
        return fmt::format("{} s to {} s", format_fixed(from_s, 1), format_fixed(to_s, 1));
    const auto at = [&](double seconds) {
        return to_iso(recording.first_epoch->plus_nanoseconds(std::llround(seconds * 1e9)), 1);
    };
    return fmt::format("{} to {} GPS time", at(from_s), at(to_s));
}

[[noreturn]] void refuse_other_times(const Reading& reading, const Imu& imu, const RawFile& raw,
                                     const RecordingSpan& recording) {
    throw Failure(
        imu.place,
        fmt::format("the IMU's samples share no time with the recording: taken as {} they are from "
                    "{}, the recording from {}",
                    reading.what,
                    span_text(seconds_of(raw.samples.front(), reading),
                              seconds_of(raw.samples.back(), reading), recording),
                    span_text(0.0, recording.span_s, recording)),
        imu.start_gps ? "Correct start_gps, the GPS time of the first sample, or name the IMU's "
                        "file of this run"
                      : "Name the IMU's file of this run; where it has a clock of its own, give "
                        "start_gps, the GPS time of its first sample");
}

Reading reading_of(const Receiver& receiver, const RecordingSpan& recording, const RawFile& raw) {
    const Imu& imu = *receiver.imu;
    const bool dated = raw.stamps == Stamps::gps || imu.start_gps;
    if (dated && !recording.first_epoch)
        throw Failure(imu.place,
                      "the IMU's times have a date, and the recording's times are relative",
                      "Give start_gps in the receiver, the GPS time of the recording's time zero");
    const std::int64_t first = raw.samples.front().time_ns;
    if (imu.start_gps)
        return {less(imu.start_gps->nanoseconds_since(*recording.first_epoch), first),
                "begun at start_gps"};
    if (raw.stamps == Stamps::gps) return {-recording.first_epoch->nanoseconds(), "dates"};
    const std::vector<Reading> ways = readings_of_count(recording, raw);
    if (ways.empty())
        throw Failure(imu.place,
                      "the IMU's times are of the GPS week, and the recording's times are relative",
                      "Give start_gps in the receiver, the GPS time of the recording's time zero");
    for (const Reading& way : ways)
        if (shares_time(way, raw, recording.span_s)) return way;
    return ways.front();
}

}  // namespace

void tie_to_recording(const Receiver& receiver, const RecordingSpan& recording, RawFile& raw) {
    const Imu& imu = *receiver.imu;
    Reading reading = reading_of(receiver, recording, raw);
    reading.added_ns += std::llround(imu.time_offset_s * 1e9);
    if (!shares_time(reading, raw, recording.span_s))
        refuse_other_times(reading, imu, raw, recording);
    for (RawSample& sample : raw.samples)
        sample.time_ns += reading.added_ns;
    raw.notes.push_back(fmt::format("The IMU's times are taken as {}.", reading.what));
    const double from_s = static_cast<double>(raw.samples.front().time_ns) * 1e-9;
    const double to_s = static_cast<double>(raw.samples.back().time_ns) * 1e-9;
    constexpr double noted_s = 1.0;
    if (from_s > noted_s || to_s < recording.span_s - noted_s)
        raw.notes.push_back(fmt::format(
            "The IMU's samples cover the recording from {} s to {} s of its {} s.",
            format_fixed(std::max(from_s, 0.0), 1),
            format_fixed(std::min(to_s, recording.span_s), 1), format_fixed(recording.span_s, 1)));
}

}  // namespace runcert::imu
