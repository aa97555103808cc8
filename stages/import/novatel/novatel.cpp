#include <fmt/format.h>

#include <map>
#include <optional>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/format.h"
#include "stages/import/novatel/row.h"

/// NovAtel's ASCII logs, alone or among NMEA sentences (NovAtel, OEM7 Commands and Logs Reference
/// Manual: ASCII, BESTPOS, BESTVEL, INSPVA, INSPVAX). Positions of one log are read, those of the
/// satellites before those with an inertial unit; velocities of the log that goes with it, of the
/// same time.
namespace runcert::novatel {
namespace {

/// How many of each log there are.
std::map<std::string_view, std::int64_t> count_logs(const RecordingBytes& recording) {
    std::map<std::string_view, std::int64_t> count;
    LineReader lines(recording);
    while (const auto line = lines.next())
        if (const std::string_view name = log_name(line->text); !name.empty()) ++count[name];
    return count;
}

/// Whether the receiver knows its time to better than some milliseconds.
bool is_known(std::string_view time_status) {
    return time_status.empty() || time_status.starts_with("FINE");
}

class Reader {
  public:
    Reader(const RecordingBytes& recording, std::string_view positions)
        : recording_(recording),
          positions_(positions),
          velocities_(velocity_log(positions)),
          timed_(recording) {}

    Observations read() {
        LineReader lines(recording_);
        while (const auto line = lines.next()) {
            try {
                if (is_log(line->text, positions_))
                    take_position(*line);
                else if (!velocities_.empty() && is_log(line->text, velocities_))
                    take_velocity(*line);
            } catch (const Failure& failure) {
                timed_.count_bad(*line, failure);
            }
        }
        finish();
        Observations observations;
        observations.format = "novatel";
        observations.frame = "geodetic";
        observations.time_scale = "gps";
        observations.variant = positions_;
        set_rows(observations, std::move(timed_));
        note(observations);
        return observations;
    }

  private:
    void take_position(const SourceLine& line) {
        const Log log = read_log(line, recording_);
        if (!is_known(log.time_status)) {
            ++without_time_;
            return timed_.count_good();
        }
        TimedRow row = read_position(log);
        timed_.count_good();
        if (velocity_ && velocity_->instant == row.instant) {
            static_cast<RecordedVelocity&>(row.observation) = velocity_->observation;
            velocity_.reset();
        }
        finish();
        row_ = std::move(row);
        place_ = RecordPlace(line);
    }

    void take_velocity(const SourceLine& line) {
        const Log log = read_log(line, recording_);
        TimedRow velocity;
        velocity.instant = instant_of(log);
        const double latency_s = read_velocity(log, velocity.observation);
        timed_.count_good();
        latency_s_ = std::max(latency_s_, latency_s);
        if (row_ && row_->instant == velocity.instant) {
            static_cast<RecordedVelocity&>(row_->observation) = velocity.observation;
            return;
        }
        velocity_ = velocity;
    }

    void finish() {
        if (row_) timed_.add(*row_, *place_);
        row_.reset();
    }

    void note(Observations& observations) const {
        observations.notes.push_back(
            fmt::format("Positions are those of the logs {}.", positions_));
        if (is_inertial(positions_))
            observations.notes.push_back(
                "An inertial unit takes part in these positions: they are estimates, and between "
                "solutions predicted.");
        if (without_time_ > 0)
            observations.notes.push_back(
                fmt::format("{} logs of a receiver that did not know its time yet are not used.",
                            without_time_));
        if (latency_s_ > 0.0)
            observations.notes.push_back(fmt::format(
                "By the receiver's word its velocities are up to {} s older than their times.",
                latency_s_));
    }

    const RecordingBytes& recording_;
    std::string_view positions_, velocities_;
    RowCollector timed_;
    std::optional<TimedRow> row_;
    std::optional<RecordPlace> place_;
    std::optional<TimedRow> velocity_;  ///< of an epoch whose position comes after it
    std::int64_t without_time_ = 0;
    double latency_s_ = 0.0;
};

bool recognises(std::string_view bytes) {
    LineReader lines(bytes);
    while (const auto line = lines.next())
        for (const std::string_view name : position_logs())
            if (is_log(line->text, name)) return true;
    return false;
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    const auto count = count_logs(recording);
    std::string_view positions;
    for (const std::string_view name : position_logs())
        if (positions.empty() && count.contains(name)) positions = name;
    if (positions.empty())
        throw Failure(place_in(recording, RecordPlace(0)),
                      "the recording has no NovAtel log of positions",
                      "Record BESTPOSA and BESTVELA, both at every epoch (ONTIME 0.1)");
    Observations observations = Reader(recording, positions).read();
    apply_attempt(observations, receiver);
    note_text(observations, recording);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "novatel",
    .what = "NovAtel ASCII logs",
    .place = 35,
    .of_satellites = true,
    .time_origin = "GPS time of the receiver's measurements, in each log's header",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::novatel
