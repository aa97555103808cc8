#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/failure.h"
#include "core/gps_time.h"
#include "core/satellite.h"
#include "stages/import/recording.h"

namespace runcert::rinex {

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
/// Failure where it is none.
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

}  // namespace runcert::rinex
