#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/gps_time.h"
#include "core/satellite.h"
#include "stages/import/recording.h"

namespace runcert::rinex {

inline constexpr const char* as_written = "Take the file as the receiver or its converter wrote it";

/// A file's lines, one of which may be put back.
class Lines {
  public:
    explicit Lines(const RecordingBytes& recording) : recording_(recording), reader_(recording) {}

    std::optional<SourceLine> next();
    /// The line that `next` gave last is given again.
    void put_back() { again_ = true; }
    /// The line that was given last; one was.
    const SourceLine& last() const { return *last_; }
    const RecordingBytes& recording() const { return recording_; }
    /// Failure at a byte of a line, counted from 0.
    [[noreturn]] void fail(const SourceLine& line, std::size_t at, const std::string& what,
                           const std::string& remedy) const;

  private:
    const RecordingBytes& recording_;
    LineReader reader_;
    std::optional<SourceLine> last_;
    bool again_ = false;
};

/// The label of a header line: what stands from its 61st character on, without blanks around it.
std::string_view label_of(std::string_view line);

/// So many characters of a line, as far as it has them.
std::string_view characters(std::string_view line, std::size_t at, std::size_t size);

/// The first line of any RINEX file ([RINEX3] table A1): version (3.03 is 303) and kind ('O', 'N').
/// Failure where it is not one.
struct FirstLine {
    int version = 0;
    char kind = ' ';
    char system = ' ';
};
FirstLine read_first_line(Lines& lines);

/// Where the parts of a time stand in a line.
struct TimeFields {
    std::size_t year, year_digits, month, day, hour, minute, second, second_digits;
};

/// The calendar time in a line, its seconds with up to seven decimals, on the file's time scale,
/// as if that were GPS time. Failure at what is no time.
GpsTime read_time(const Lines& lines, const SourceLine& line, const TimeFields& at);

/// A whole number, blanks around it; Failure where there is none, or it is outside the bounds.
int read_count(const Lines& lines, const SourceLine& line, std::size_t at, std::size_t size,
               int least, int most, std::string_view meaning);

/// The satellite in three characters; a blank system is GPS, a blank ten 0. Failure where there is
/// none.
Satellite read_satellite(const Lines& lines, const SourceLine& line, std::size_t at);

/// One type of observation of a system: what it is, and of which signal.
struct ObservationType {
    char what = ' ';  ///< 'C', 'L', 'D', 'S'; ' ' for others
    SignalCode signal;
};

using Types = std::vector<ObservationType>;

/// The time scale of the file's epochs, against GPS time.
enum class Scale : std::uint8_t { gps, utc, beidou };

/// The header of observations, whose lines may come again among the epochs.
class ObservationHeader {
  public:
    explicit ObservationHeader(Lines& lines) : lines_(lines) {}

    /// Reads up to its end. Failure with the line where it is not understood.
    void read();
    void read_line(const SourceLine& line);
    /// Failure where no carrier phase of a system that is used is named.
    void require_types() const;

    int version = 0;
    Scale scale = Scale::gps;
    std::array<Types, 7> types;  ///< by system; of version 2 the same for all
    std::string format, device;  ///< as MeasurementFacts has them; so the next two
    std::optional<Ecef> approximate_position;
    std::vector<std::string> notes;

  private:
    void read_types_2(const SourceLine& line);
    void set_types_2();
    void read_types_3(const SourceLine& line);
    void read_time_system(const SourceLine& line);
    void read_scale_factor(const SourceLine& line);
    void read_position(const SourceLine& line);

    Lines& lines_;
    std::vector<std::string> type_names_;  ///< of version 2
    int type_count_ = 0;
    SatelliteSystem system_ = SatelliteSystem::gps;  ///< whose types are continued
};

}  // namespace runcert::rinex
