#include "stages/import/ubx/raw.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/failure.h"
#include "stages/import/byte_order.h"
#include "stages/import/cell.h"
#include "stages/import/row_collector.h"
#include "stages/import/ubx/frames.h"

namespace runcert::ubx {
namespace {

constexpr MessageId raw_message = 0x0215;         ///< RXM-RAWX
constexpr MessageId navigation_message = 0x0213;  ///< RXM-SFRBX
constexpr std::size_t raw_header_size = 16;
constexpr std::size_t raw_measurement_size = 32;
/// Lock times are counted up to this, in ms.
constexpr std::uint16_t longest_lock_ms = 64'500;

double real_at(std::string_view payload, std::size_t at) {
    return std::bit_cast<double>(little_endian<std::uint64_t>(payload, at));
}

std::uint8_t byte_at(std::string_view payload, std::size_t at) {
    return little_endian<std::uint8_t>(payload, at);
}

struct RawSignal {
    std::uint8_t system, number;
    std::string_view code;
};

/// Signal identifiers of generation 9 and 10 ("F9 HPG interface description", 1.5.4); generation
/// 8 has 0 for its one signal. 8 to 10 of Galileo are E6, which an early table took for E5b.
constexpr std::array<RawSignal, 14> raw_signals{{// System, number, code.
                                                 {0, 0, "1C"},
                                                 {0, 3, "2L"},
                                                 {0, 4, "2S"},
                                                 {0, 6, "5I"},
                                                 {0, 7, "5Q"},
                                                 {2, 0, "1C"},
                                                 {2, 1, "1B"},
                                                 {2, 3, "5I"},
                                                 {2, 4, "5Q"},
                                                 {2, 5, "7I"},
                                                 {2, 6, "7Q"},
                                                 {2, 8, "6B"},
                                                 {2, 9, "6C"},
                                                 {2, 10, "6A"}}};

constexpr std::array<SatelliteSystem, 8> raw_systems{
    SatelliteSystem::gps,  SatelliteSystem::sbas, SatelliteSystem::galileo, SatelliteSystem::beidou,
    SatelliteSystem::qzss, SatelliteSystem::qzss, SatelliteSystem::glonass, SatelliteSystem::navic};

class RawReader {
  public:
    RawReader(const RecordingBytes& recording, const TakeMeasurements& take)
        : recording_(recording), take_(take) {}

    RawFile read() {
        FrameReader frames(recording_, frame_kind);
        while (const auto frame = frames.next()) {
            if (!frame->good())
                log_.count_bad(RecordPlace(frame->offset), frames.failure_of(*frame), epochs_);
            else if (id_of(frame->bytes) == raw_message)
                take_raw(*frame);
            else if (id_of(frame->bytes) == navigation_message)
                take_navigation(*frame);
        }
        file_.facts.records = std::move(log_).finish(file_.facts.notes);
        if (epochs_ == 0)
            throw Failure(recording_.name, "the recording has no raw measurements (RXM-RAWX)",
                          "Switch UBX-RXM-RAWX and UBX-RXM-SFRBX on, and record again");
        // What came before the first epoch was dated by none.
        for (const Frame& frame : early_)
            (void)collector_.take(payload_of(frame), static_cast<std::int64_t>(frame.offset),
                                  *first_time_);
        file_.ephemerides = collector_.ephemerides();
        file_.facts.format = "UBX RXM-RAWX";
        for (const auto& [system, count] : file_.facts.set_aside)
            file_.facts.notes.push_back(
                fmt::format("Measurements of {} are not used: {}.", name_of(system), count));
        if (unknown_signals_ > 0)
            file_.facts.notes.push_back(fmt::format(
                "Measurements of signals that are not known were left out: {}.", unknown_signals_));
        return std::move(file_);
    }

  private:
    void take_navigation(const Frame& frame) {
        if (!last_time_) {
            early_.push_back(frame);
            return;
        }
        (void)collector_.take(payload_of(frame), static_cast<std::int64_t>(frame.offset),
                              *last_time_);
    }

    void take_raw(const Frame& frame) {
        try {
            read_epoch(frame);
        } catch (const Failure& failure) {
            log_.count_bad(RecordPlace(frame.offset), failure, epochs_);
        }
    }

    [[noreturn]] void fail(const Frame& frame, const std::string& what) const {
        throw Failure(place_in(recording_, RecordPlace(frame.offset)), what,
                      "Take the recording as the receiver wrote it");
    }

    void read_epoch(const Frame& frame) {
        const std::string_view payload = payload_of(frame);
        if (payload.size() < raw_header_size ||
            payload.size() != raw_header_size + raw_measurement_size * byte_at(payload, 11))
            fail(frame, fmt::format("an RXM-RAWX message of {} bytes is not of the size that its "
                                    "measurements need",
                                    payload.size()));
        const double of_week_s = real_at(payload, 0);
        const auto week = little_endian<std::uint16_t>(payload, 8);
        if (!(of_week_s >= 0.0 && of_week_s <= 604'800.0) || week < 1024 || week > 10'000)
            fail(frame, "the receiver did not know the time of an RXM-RAWX message");
        MeasuredEpoch epoch{.time = GpsTime::from_week(week, std::llround(of_week_s * 1e9)),
                            .measurements = {},
                            .byte = static_cast<std::int64_t>(frame.offset)};
        if (last_time_ && epoch.time <= *last_time_)
            fail(frame, "an RXM-RAWX message is not later than the one before");
        const double step_s = last_time_ ? epoch.time.seconds_since(*last_time_) : 0.0;
        for (std::size_t at = raw_header_size; at < payload.size(); at += raw_measurement_size)
            read_measurement(payload.substr(at, raw_measurement_size), step_s, epoch);
        const SignalMeasurement* same = order_measurements(epoch);
        if (same)
            fail(frame, fmt::format("an RXM-RAWX message has {} {} twice", to_text(same->satellite),
                                    to_text(same->signal)));
        last_time_ = epoch.time;
        if (!first_time_) first_time_ = epoch.time;
        ++epochs_;
        log_.count_good();
        take_(epoch);
    }

    void read_measurement(std::string_view bytes, double step_s, MeasuredEpoch& epoch) {
        const std::uint8_t system = byte_at(bytes, 20), number = byte_at(bytes, 21);
        if (system >= raw_systems.size()) {
            ++unknown_signals_;
            return;
        }
        const SatelliteSystem known = raw_systems[system];
        if (known != SatelliteSystem::gps && known != SatelliteSystem::galileo) {
            ++file_.facts.set_aside[known];
            return;
        }
        const auto signal = std::ranges::find_if(raw_signals, [&](const RawSignal& each) {
            return each.system == system && each.number == byte_at(bytes, 22);
        });
        SignalMeasurement measured;
        if (signal == raw_signals.end() || number < 1 || number > 99 ||
            !from_text(signal->code, measured.signal)) {
            ++unknown_signals_;
            return;
        }
        measured.satellite = {known, number};
        const std::uint8_t state = byte_at(bytes, 30);
        const auto within = [](double value, double bound) { return std::abs(value) < bound; };
        const double pseudorange_m = real_at(bytes, 0), phase_cycles = real_at(bytes, 8);
        const auto doppler_hz =
            static_cast<double>(std::bit_cast<float>(little_endian<std::uint32_t>(bytes, 16)));
        if ((state & 0b0001) != 0 && within(pseudorange_m, 1e9))
            measured.pseudorange_m = pseudorange_m;
        if ((state & 0b0010) != 0 && within(phase_cycles, 1e12))
            measured.phase_cycles = phase_cycles;
        if (within(doppler_hz, 1e6)) measured.doppler_hz = doppler_hz;
        measured.strength_db_hz = static_cast<double>(byte_at(bytes, 26));
        measured.half_cycle = measured.phase_cycles && (state & 0b0100) == 0;
        const auto lock_ms = little_endian<std::uint16_t>(bytes, 24);
        measured.lock_time_s = lock_ms * 1e-3;
        measured.loss_of_lock = is_lost(measured, lock_ms, step_s);
        epoch.measurements.push_back(measured);
    }

    /// Whether the phase was lost since the signal's last epoch: its lock time went down, or is
    /// shorter than the step.
    bool is_lost(const SignalMeasurement& measured, std::uint16_t lock_ms, double step_s) {
        std::uint16_t& before_ms = lock_ms_[{measured.satellite, measured.signal}];
        // A millisecond of rounding at either end.
        const bool lost = lock_ms < std::min(before_ms, longest_lock_ms) ||
                          lock_ms + 2.0 < std::min(step_s * 1e3, double{longest_lock_ms});
        before_ms = lock_ms;
        return lost && measured.phase_cycles;
    }

    const RecordingBytes& recording_;
    const TakeMeasurements& take_;
    RawFile file_;
    RecordLog log_;
    NavigationCollector collector_;
    std::vector<Frame> early_;
    std::map<std::pair<Satellite, SignalCode>, std::uint16_t> lock_ms_;
    std::optional<GpsTime> first_time_, last_time_;
    std::int64_t epochs_ = 0;
    std::int64_t unknown_signals_ = 0;
};

}  // namespace

bool has_raw(std::string_view bytes) {
    FrameReader frames({{}, bytes}, frame_kind);
    while (const auto frame = frames.next())
        if (frame->good() && id_of(frame->bytes) == raw_message) return true;
    return false;
}

RawFile read_raw(const RecordingBytes& recording, const TakeMeasurements& take) {
    return RawReader(recording, take).read();
}

}  // namespace runcert::ubx
