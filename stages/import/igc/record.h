#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "stages/import/cell.h"
#include "stages/import/row_collector.h"

namespace runcert::igc {

/// An addition to the B records that is read.
enum class Extension {
    fix_accuracy,       ///< FXA, m
    vertical_accuracy,  ///< VXA, m
    satellites,         ///< SIU
    decimal_seconds,    ///< TDS
    latitude_digits,    ///< LAD, further decimals of the minutes
    longitude_digits,   ///< LOD
    speed,              ///< GSP, km/h
    track               ///< TRT, degrees
};

inline constexpr std::size_t extensions = 8;

/// Where each extension stands in a B record; size 0 where it is not recorded.
struct Layout {
    struct Span {
        std::size_t begin = 0;  ///< counted from 0
        std::size_t size = 0;
    };
    std::array<Span, extensions> spans;
    std::size_t record_bytes = 35;  ///< of a B record with all that is read

    const Span& of(Extension extension) const { return spans[static_cast<std::size_t>(extension)]; }
};

/// What the GNSS altitude is above (HFALG).
enum class AltitudeReference { not_stated, ellipsoid, geoid, none };

inline constexpr const char* take_whole = "Take the recording as the flight recorder wrote it";

/// The layout of an I record ("I023638FXA3940SIU"). Failure at the cell.
Layout read_extensions(const Cell& record);

/// The date of a record "HFDTE160701" or "HFDTEDATE:160701,01"; nothing where the record is
/// another one. Days since 1980-01-06; years 80 to 99 are of the 20th century. Failure at the cell.
std::optional<std::int64_t> read_date(const Cell& record);

/// The three letters that say what an H record is about ("ALG"); empty where it is none.
std::string_view header_code(std::string_view record);

/// The text of an H record after its colon, or after its code where it has none.
std::string_view header_text(std::string_view record);

/// Of a record HFALG.
AltitudeReference read_altitude_reference(std::string_view record);

/// Whether a line has the shape of a B record: its fixed part, 35 characters.
bool is_fix(std::string_view line);

/// Nanoseconds of the UTC day that a B record states, TDS included; 86 400 s and more in a leap
/// second. Failure at its place.
std::int64_t read_time_of_day(const Cell& record, const Layout& layout);

/// The row of a B record, without its instant. Failure at its place.
TimedRow read_fix(const Cell& record, const Layout& layout, AltitudeReference reference);

}  // namespace runcert::igc
