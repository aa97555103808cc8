#include "stages/import/sbn/sbn.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "stages/import/format.h"
#include "stages/import/row_collector.h"
#include "stages/import/sbn/frame.h"
#include "stages/import/sbn/row.h"
#include "stages/import/sbp/device.h"

namespace runcert::sbn {
namespace {

constexpr char file_id_message = '\xfd';

/// Leap seconds that the receiver's UTC counted with, while they stayed the same.
struct LeapCount {
    std::int64_t used = 0;
    std::int64_t right = 0;  ///< of the date where it began
    std::size_t from_byte = 0;
};

std::int64_t right_leap_seconds(GpsTime instant) {
    const CalendarTime utc = utc_from_gps(instant).time;
    CalendarTime minute = utc;
    minute.second = 0;
    minute.nanosecond = 0;
    return (instant.nanoseconds_since(GpsTime::from_calendar(minute)) - utc.nanosecond) /
               GpsTime::nanoseconds_per_second -
           utc.second;
}

/// Reads a log frame by frame.
class Reader {
  public:
    explicit Reader(const RecordingBytes& recording)
        : recording_(recording),
          timed_(recording, WrittenResolution{CoordinateUnit::degree, 1e-7, 1e-3}) {}

    Observations read() {
        FrameReader frames(recording_);
        while (const auto frame = frames.next()) {
            const RecordPlace place(frame->offset);
            if (frame->failure)
                timed_.count_bad(place, *frame->failure);
            else
                read_message(frame->payload, frame->offset, place);
        }
        set_rows(observations_, std::move(timed_));
        note_times();
        return std::move(observations_);
    }

  private:
    static constexpr std::size_t most_leap_counts = 8;

    void read_message(std::string_view payload, std::size_t offset, const RecordPlace& place) {
        if (payload[0] == file_id_message && observations_.device.empty())
            observations_.device = locosys_device(payload.substr(1));
        if (payload[0] != geodetic_message) return timed_.count_good();
        try {
            const GeodeticRow read = read_geodetic(payload, recording_, place);
            if (read.row) {
                timed_.add(*read.row, place);
                if (read.leap_seconds)
                    see_leap_seconds(*read.leap_seconds, read.row->instant, offset);
            } else {
                ++without_time_;
            }
        } catch (const Failure& failure) {
            return timed_.count_bad(place, failure);
        }
        timed_.count_good();
    }

    void see_leap_seconds(std::int64_t used, GpsTime instant, std::size_t byte) {
        if (!leap_counts_.empty() && leap_counts_.back().used == used) return;
        if (leap_counts_.size() < most_leap_counts)
            leap_counts_.push_back({used, right_leap_seconds(instant), byte});
    }

    void note_times() {
        std::vector<std::string>& notes = observations_.notes;
        if (without_time_ > 0)
            notes.push_back(fmt::format(
                "{} messages were recorded before the receiver knew the time, and are no epochs.",
                without_time_));
        for (const LeapCount& count : leap_counts_)
            if (count.used != count.right)
                notes.push_back(fmt::format(
                    "From byte {} on the recorded UTC is {} s behind GPS time where {} s are "
                    "right: "
                    "the receiver had not estimated the leap seconds. The recorded GPS time is "
                    "used, "
                    "which this does not touch.",
                    count.from_byte, count.used, count.right));
            else if (leap_counts_.size() > 1)
                notes.push_back(
                    fmt::format("From byte {} on the recorded UTC has the right leap seconds, {}.",
                                count.from_byte, count.used));
    }

    const RecordingBytes& recording_;
    RowCollector timed_;
    Observations observations_;
    std::vector<LeapCount> leap_counts_;
    std::size_t without_time_ = 0;
};

}  // namespace

bool recognises(std::string_view bytes) {
    if (!bytes.starts_with("\xa0\xa2")) return false;
    const RecordingBytes nameless{{}, bytes};
    const auto first = FrameReader(nameless).next();
    return first && !first->failure;
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    Observations observations = Reader(recording).read();
    observations.format = "sbn";
    observations.frame = "geodetic";
    observations.time_scale = "gps";
    apply_attempt(observations, receiver);
    return observations;
}

extern const Format format{
    .name = "sbn",
    .what = "Locosys SBN",
    .place = 40,
    .of_satellites = true,
    .time_origin = "GPS time of the receiver's navigation solutions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::sbn
