#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/rinex/header.h"
#include "stages/import/rinex/rinex.h"
#include "stages/import/row_collector.h"

namespace runcert::rinex {
namespace {

constexpr int most_satellites = 200;
bool is_used(SatelliteSystem system) {
    return system == SatelliteSystem::gps || system == SatelliteSystem::galileo;
}

class MeasurementReader {
  public:
    MeasurementReader(const RecordingBytes& recording, const TakeMeasurements& take)
        : lines_(recording), header_(lines_), take_(take) {}

    MeasurementFacts read() {
        header_.read();
        while (const auto line = lines_.next()) {
            try {
                read_epoch(*line);
            } catch (const Failure& failure) {
                log_.count_bad(lines_.last(), failure, epochs_);
                find_next_epoch();
            }
        }
        facts_.format = header_.format;
        facts_.device = header_.device;
        facts_.approximate_position = header_.approximate_position;
        facts_.notes = header_.notes;
        facts_.records = std::move(log_).finish(facts_.notes);
        if (epochs_ == 0)
            throw Failure(lines_.recording().name + ":1", "the file has a header and no epochs",
                          "Take the whole file");
        note_counts();
        return std::move(facts_);
    }

  private:
    void read_epoch(const SourceLine& line) {
        if (trim(line.text).empty()) return;
        const bool modern = header_.version >= 300;
        if (modern && line.text[0] != '>')
            lines_.fail(line, 0, "a line of an epoch was expected, which begins with >",
                        as_written);
        const std::size_t flag_at = modern ? 31 : 28;
        const std::size_t count_at = flag_at + 1;
        const std::string_view flag_text = trim(characters(line.text, flag_at, 1));
        const int flag =
            flag_text.empty() ? 0 : read_count(lines_, line, flag_at, 1, 0, 6, "event flag");
        const int count = read_count(lines_, line, count_at, 3, 0, 999, "number of satellites");
        if (flag >= 2 && flag <= 5) return pass_event(line, flag, count);
        if (count > most_satellites)
            lines_.fail(line, count_at, fmt::format("an epoch of {} satellites is none", count),
                        as_written);
        MeasuredEpoch epoch{
            .time = read_instant(line, modern), .measurements = {}, .byte = line.byte};
        epoch.measurements.swap(spare_);
        epoch.measurements.clear();
        if (modern)
            read_satellites_3(count, epoch);
        else
            read_satellites_2(line, count, epoch);
        // What follows a power failure, or repairs of slips that the receiver knew (6).
        if (flag == 6) return;
        if (flag == 1)
            for (SignalMeasurement& each : epoch.measurements)
                each.loss_of_lock = true;
        finish(line, epoch);
        spare_.swap(epoch.measurements);
    }

    void finish(const SourceLine& line, MeasuredEpoch& epoch) {
        if (last_time_ && epoch.time <= *last_time_)
            lines_.fail(line, 0, "the epoch is not later than the one before",
                        "Hand in the file as the receiver or converter wrote it");
        const SignalMeasurement* same = order_measurements(epoch);
        if (same)
            lines_.fail(line, 0,
                        fmt::format("the epoch has {} {} twice", to_text(same->satellite),
                                    to_text(same->signal)),
                        as_written);
        last_time_ = epoch.time;
        ++epochs_;
        log_.count_good();
        take_(epoch);
    }

    GpsTime read_instant(const SourceLine& line, bool modern) const {
        const TimeFields at = modern ? TimeFields{2, 4, 7, 10, 13, 16, 18, 11}
                                     : TimeFields{1, 2, 4, 7, 10, 13, 15, 11};
        const GpsTime written = read_time(lines_, line, at);
        if (header_.scale == Scale::gps) return written;
        if (header_.scale == Scale::beidou)
            return written.plus_nanoseconds(14 * GpsTime::nanoseconds_per_second);
        return gps_from_utc(written.calendar());
    }

    /// Flags 2 to 5: an antenna that begins to move, a new site, header lines, an event.
    void pass_event(const SourceLine& line, int flag, int count) {
        ++events_;
        for (int i = 0; i < count; ++i) {
            const auto special = lines_.next();
            if (!special)
                lines_.fail(line, 0, "the file ends before the event's lines do",
                            "Take the whole file");
            if (flag == 4) header_.read_line(*special);
        }
        if (flag == 4) header_.require_types();
    }

    void read_satellites_3(int count, MeasuredEpoch& epoch) {
        for (int i = 0; i < count; ++i) {
            const auto line = lines_.next();
            if (!line) fail_cut();
            if (line->text.starts_with(">")) {
                lines_.put_back();
                lines_.fail(*line, 0,
                            fmt::format("an epoch of {} satellites has only {}", count, i),
                            as_written);
            }
            read_signals(*line, 0, read_satellite(lines_, *line, 0), epoch);
        }
    }

    [[noreturn]] void fail_cut() const {
        throw Failure(lines_.recording().name, "the file ends inside an epoch",
                      "Nothing, where the recording was cut off; else take the whole file");
    }

    void read_satellites_2(SourceLine line, int count, MeasuredEpoch& epoch) {
        std::vector<Satellite> satellites;
        for (int i = 0; i < count; ++i) {
            if (i > 0 && i % 12 == 0) {
                const auto more = lines_.next();
                if (!more) fail_cut();
                line = *more;
            }
            satellites.push_back(
                read_satellite(lines_, line, 32 + 3 * static_cast<std::size_t>(i % 12)));
        }
        const Types& types = header_.types[0];
        for (const Satellite& satellite : satellites)
            for (std::size_t from = 0; from < types.size(); from += 5) {
                const auto values = lines_.next();
                if (!values) fail_cut();
                read_signals(*values, from, satellite, epoch);
            }
    }

    /// Observations of one line: all of a satellite (version 3), or five from that type on (2).
    void read_signals(const SourceLine& line, std::size_t from, Satellite satellite,
                      MeasuredEpoch& epoch) {
        const bool modern = header_.version >= 300;
        if (!is_used(satellite.system)) {
            if (from == 0) ++facts_.set_aside[satellite.system];
            return;
        }
        const Types& types = header_.types[static_cast<std::size_t>(satellite.system)];
        if (modern && types.empty())
            lines_.fail(line, 0,
                        fmt::format("the header names no types of {}", name_of(satellite.system)),
                        as_written);
        const std::size_t to = modern ? types.size() : std::min(types.size(), from + 5);
        for (std::size_t i = from; i < to; ++i) {
            const std::size_t at = modern ? 3 + 16 * i : 16 * (i - from);
            if (at >= line.text.size()) break;
            if (types[i].what != ' ') read_value(line, at, types[i], satellite, epoch);
        }
        if (modern && line.text.size() > 3 + 16 * types.size() &&
            !trim(line.text.substr(3 + 16 * types.size())).empty())
            lines_.fail(line, 3 + 16 * types.size(),
                        fmt::format("the line has more observations than the header's {} types",
                                    types.size()),
                        as_written);
    }

    void read_value(const SourceLine& line, std::size_t at, const ObservationType& type,
                    Satellite satellite, MeasuredEpoch& epoch) const {
        const std::string_view text = trim(characters(line.text, at, 14));
        if (text.empty()) return;
        const auto value = parse_double(text);
        if (!value || std::abs(*value) > 1e12)
            lines_.fail(line, at, fmt::format("\"{}\" is no observation", escape_for_message(text)),
                        as_written);
        if (*value == 0.0) return;  // how RINEX writes one that is missing
        SignalMeasurement& measured = signal_of(satellite, type.signal, line.number, epoch);
        switch (type.what) {
            case 'C':
                if (std::abs(*value) > 1e9)
                    lines_.fail(line, at, "no satellite is so far away", as_written);
                measured.pseudorange_m = *value;
                break;
            case 'D':
                measured.doppler_hz = *value;
                break;
            case 'S':
                measured.strength_db_hz = *value;
                break;
            case 'L': {
                measured.phase_cycles = *value;
                const std::string_view mark = characters(line.text, at + 14, 1);
                const int bits = mark.empty() || !is_digit(mark[0]) ? 0 : mark[0] - '0';
                measured.loss_of_lock = (bits & 1) != 0;
                measured.half_cycle = (bits & 2) != 0;
                break;
            }
            default:
                break;
        }
    }

    /// The satellite's measurement of that signal in the epoch, a new one where there is none yet.
    static SignalMeasurement& signal_of(Satellite satellite, SignalCode signal, std::int64_t line,
                                        MeasuredEpoch& epoch) {
        auto& all = epoch.measurements;
        for (std::size_t i = all.size(); i-- > 0 && all[i].satellite == satellite;)
            if (all[i].signal == signal) return all[i];
        return all.emplace_back(SignalMeasurement{
            .satellite = satellite, .signal = signal, .line = static_cast<std::int32_t>(line)});
    }

    /// Goes on at what looks like the beginning of an epoch.
    void find_next_epoch() {
        while (const auto line = lines_.next()) {
            const bool begins =
                header_.version >= 300 ? line->text.starts_with(">") : begins_epoch_2(*line);
            if (!begins) continue;
            lines_.put_back();
            return;
        }
    }

    bool begins_epoch_2(const SourceLine& line) const {
        try {
            (void)read_instant(line, false);
            (void)read_count(lines_, line, 29, 3, 1, most_satellites, "number of satellites");
            (void)read_satellite(lines_, line, 32);
            return true;
        } catch (const Failure&) {
            return false;
        }
    }

    void note_counts() {
        for (const auto& [system, count] : facts_.set_aside)
            facts_.notes.push_back(
                fmt::format("Measurements of {} are not used: {}.", name_of(system), count));
        if (events_ > 0)
            facts_.notes.push_back(
                fmt::format("Records of events, which were passed over: {}.", events_));
    }

    Lines lines_;
    ObservationHeader header_;
    const TakeMeasurements& take_;
    MeasurementFacts facts_;
    RecordLog log_;
    std::optional<GpsTime> last_time_;
    std::int64_t epochs_ = 0;
    std::int64_t events_ = 0;
    std::vector<SignalMeasurement> spare_;
};

}  // namespace

MeasurementFacts read_measurements(const RecordingBytes& recording, const TakeMeasurements& take) {
    return MeasurementReader(recording, take).read();
}

}  // namespace runcert::rinex
