#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schemas/attempt/attempt.h"

namespace runcert::vbo {

/// The day of the first epoch, and how it was found, as a note for the report.
struct FirstDay {
    std::optional<std::int64_t> utc;  ///< days since 1980-01-06; nothing where no date is to be had
    std::string note;
    bool by_start_gps = false;  ///< the attempt's start_gps was needed
};

/// Finds the UTC date of a first epoch of which the recording gives the time of day alone.
///
/// The attempt's start_date decides. Else the header's `created` ("01/08/2025 @ 14:00:12", day
/// first) is the local time at which the recording began: of the dates by which it differs from
/// the first epoch by at most 14 h, that whose difference is nearest to the attempt's
/// utc_offset_h; without one, nearest to the sun's time at the place (longitude / 15, in hours);
/// without a position, nearest to zero. Else the date nearest to the attempt's start_gps.
FirstDay find_first_day(const Receiver& receiver, std::string_view created,
                        std::int64_t time_of_day_ns, std::optional<double> longitude_deg);

}  // namespace runcert::vbo
