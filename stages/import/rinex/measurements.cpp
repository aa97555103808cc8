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
constexpr int most_types = 200;
constexpr const char* as_written = "Take the file as the receiver or its converter wrote it";

/// One type of observation of a system: what it is, and of which signal.
struct ObservationType {
    char what = ' ';  ///< 'C', 'L', 'D', 'S'; ' ' for others
    SignalCode signal;
};

using Types = std::vector<ObservationType>;

/// The time scale of the file's epochs, against GPS time.
enum class Scale : std::uint8_t { gps, utc, beidou };

bool is_used(SatelliteSystem system) {
    return system == SatelliteSystem::gps || system == SatelliteSystem::galileo;
}

class MeasurementReader {
  public:
    MeasurementReader(const RecordingBytes& recording, const TakeMeasurements& take)
        : lines_(recording), take_(take) {}

    MeasurementFacts read() {
        read_header();
        while (const auto line = lines_.next()) {
            try {
                read_epoch(*line);
            } catch (const Failure& failure) {
                log_.count_bad(lines_.last(), failure, epochs_);
                find_next_epoch();
            }
        }
        facts_.records = std::move(log_).finish(facts_.notes);
        if (epochs_ == 0)
            throw Failure(place(1), "the file has a header and no epochs", "Take the whole file");
        note_counts();
        return std::move(facts_);
    }

  private:
    std::string place(std::int64_t line) const {
        return fmt::format("{}:{}", lines_.recording().name, line);
    }

    // The header.

    void read_header() {
        const FirstLine first = read_first_line(lines_);
        version_ = first.version;
        const bool known =
            (version_ >= 210 && version_ < 300) || (version_ >= 300 && version_ < 500);
        if (first.kind != 'O' || !known)
            throw Failure(
                place(1),
                fmt::format("RINEX {}.{:02} of kind \"{}\" is not read as observations",
                            version_ / 100, version_ % 100, escape_for_message({&first.kind, 1})),
                "Give observations (kind O) in RINEX 2.10 to 4.02");
        facts_.format = fmt::format("RINEX {}.{:02}", version_ / 100, version_ % 100);
        // Version 2 of one system may leave out its letter, and its time system.
        if (first.system == 'R') scale_ = Scale::utc;
        if (first.system == 'C' && version_ >= 300) scale_ = Scale::beidou;
        bool ended = false;
        while (const auto line = lines_.next()) {
            if (label_of(line->text) == "END OF HEADER") {
                ended = true;
                break;
            }
            read_header_line(*line);
        }
        if (!ended)
            throw Failure(place(1), "the header has no end (END OF HEADER)", "Take the whole file");
        require_types();
    }

    void require_types() const {
        const auto has_phase = [](const Types& types) {
            return std::ranges::any_of(types, [](const auto& type) { return type.what == 'L'; });
        };
        for (const Types& types : types_)
            if (has_phase(types)) return;
        throw Failure(place(1),
                      "the header names no carrier phase of a system that is used (GPS, Galileo)",
                      "Record and convert with carrier phases (types L1, L1C)");
    }

    void read_header_line(const SourceLine& line) {
        const std::string_view label = label_of(line.text);
        if (label == "# / TYPES OF OBSERV" && version_ < 300) return read_types_2(line);
        if (label == "SYS / # / OBS TYPES" && version_ >= 300) return read_types_3(line);
        if (label == "WAVELENGTH FACT L1/2") return note_wavelengths(line);
        if (label == "TIME OF FIRST OBS") return read_time_system(line);
        if (label == "SYS / SCALE FACTOR") return read_scale_factor(line);
        if (label == "APPROX POSITION XYZ") return read_position(line);
        if (label == "REC # / TYPE / VERS")
            facts_.device = std::string(trim(characters(line.text, 20, 20)));
    }

    void read_types_2(const SourceLine& line) {
        const std::string_view count = trim(characters(line.text, 0, 6));
        if (!count.empty()) {
            type_count_ = read_count(lines_, line, 0, 6, 1, most_types, "number of types");
            type_names_.clear();
        }
        for (std::size_t i = 0; i < 9 && std::ssize(type_names_) < type_count_; ++i)
            type_names_.emplace_back(trim(characters(line.text, 6 + 6 * i, 6)));
        if (std::ssize(type_names_) == type_count_) set_types_2();
    }

    /// The signals of version 2's types, which name no attribute.
    void set_types_2() {
        const auto has = [&](std::string_view type) {
            return std::ranges::find(type_names_, type) != type_names_.end();
        };
        for (const SatelliteSystem system : {SatelliteSystem::gps, SatelliteSystem::galileo}) {
            Types types;
            for (const std::string& name : type_names_) {
                ObservationType type;
                if (name.size() == 2 && name[1] >= '1' && name[1] <= '9') {
                    const char band = name[1];
                    type.what = name[0] == 'P' ? 'C' : name[0];
                    char attribute = 'X';
                    if (system == SatelliteSystem::gps && band == '1')
                        attribute = name[0] == 'P' || !has("C1") ? 'W' : 'C';
                    if (system == SatelliteSystem::gps && band == '2')
                        attribute = name[0] == 'P' || (name[0] != 'C' && has("P2")) ? 'W' : 'X';
                    type.signal = {static_cast<std::uint8_t>(band - '0'), attribute};
                }
                types.push_back(type);
            }
            types_[static_cast<std::size_t>(system)] = std::move(types);
        }
    }

    void read_types_3(const SourceLine& line) {
        const std::string_view letter = characters(line.text, 0, 1);
        if (letter.empty() || letter[0] != ' ') {
            const auto system = letter.empty() ? std::nullopt : system_of_letter(letter[0]);
            if (!system)
                lines_.fail(
                    line, 0,
                    fmt::format("\"{}\" is no satellite system", escape_for_message(letter)),
                    as_written);
            system_ = *system;
            type_count_ = read_count(lines_, line, 3, 3, 1, most_types, "number of types");
            types_[static_cast<std::size_t>(system_)].clear();
        }
        Types& types = types_[static_cast<std::size_t>(system_)];
        for (std::size_t i = 0; i < 13 && std::ssize(types) < type_count_; ++i) {
            const std::string_view name = characters(line.text, 7 + 4 * i, 3);
            ObservationType type;
            if (name.size() == 3 && from_text(name.substr(1), type.signal)) type.what = name[0];
            types.push_back(type);
        }
    }

    /// Version 2 says so of receivers that square the signal. What they record since is whole but
    /// for slips, which are looked for by halves, too; an open half has its indicator.
    void note_wavelengths(const SourceLine& line) {
        if (characters(line.text, 0, 12).find('2') != std::string_view::npos)
            facts_.notes.push_back(fmt::format(
                "Line {}: the receiver's phases may slip by half a cycle (wavelength factor 2).",
                line.number));
    }

    void read_time_system(const SourceLine& line) {
        const std::string_view name = trim(characters(line.text, 48, 3));
        if (name == "GPS" || name == "GAL" || name == "QZS" || name == "IRN")
            scale_ = Scale::gps;
        else if (name == "GLO" || name == "UTC")
            scale_ = Scale::utc;
        else if (name == "BDT")
            scale_ = Scale::beidou;
        else if (!name.empty())
            lines_.fail(
                line, 48,
                fmt::format("the time system \"{}\" is not known", escape_for_message(name)),
                "Convert with GPS time (GPS)");
    }

    void read_scale_factor(const SourceLine& line) {
        const int factor = read_count(lines_, line, 2, 4, 1, 10'000, "scale factor");
        if (factor != 1)
            lines_.fail(line, 2, fmt::format("observations scaled by {} are not read", factor),
                        "Convert without scale factors");
    }

    void read_position(const SourceLine& line) {
        Eigen::Vector3d position;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto value = parse_double(trim(characters(line.text, 14 * i, 14)));
            if (!value || std::abs(*value) > 1e8) return;
            position[static_cast<Eigen::Index>(i)] = *value;
        }
        if (position.norm() > 6.0e6) facts_.approximate_position = Ecef{position};
    }

    // Epochs.

    void read_epoch(const SourceLine& line) {
        if (trim(line.text).empty()) return;
        const bool modern = version_ >= 300;
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
        if (scale_ == Scale::gps) return written;
        if (scale_ == Scale::beidou)
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
            if (flag == 4) read_header_line(*special);
        }
        if (flag == 4) require_types();
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
        const Types& types = types_[0];
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
        const bool modern = version_ >= 300;
        if (!is_used(satellite.system)) {
            if (from == 0) ++facts_.set_aside[satellite.system];
            return;
        }
        const Types& types = types_[static_cast<std::size_t>(satellite.system)];
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
                version_ >= 300 ? line->text.starts_with(">") : begins_epoch_2(*line);
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
    const TakeMeasurements& take_;
    MeasurementFacts facts_;
    RecordLog log_;
    int version_ = 0;
    Scale scale_ = Scale::gps;
    std::array<Types, 7> types_;           ///< by system; of version 2 the same for all
    std::vector<std::string> type_names_;  ///< of version 2
    int type_count_ = 0;
    SatelliteSystem system_ = SatelliteSystem::gps;  ///< whose types are continued
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
