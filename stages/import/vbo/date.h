#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"

namespace runcert::vbo {

/// The day of the first epoch, and how it was found, as a note for the report.
struct FirstDay {
    std::optional<std::chrono::sys_days> utc;  ///< nothing where no date is to be had
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

/// Turns times of day into instants. A step back by more than half a day is taken for midnight
/// passed; one forward by more, for midnight passed the other way.
class DayClock {
  public:
    /// Without a day, instants are counted from the first midnight as if it were the GPS epoch.
    explicit DayClock(std::optional<std::chrono::sys_days> first_day) : first_day_(first_day) {}

    /// The instant of a time of day, the next of the recording. Failure at "time" where the day
    /// has no such second, or is out of span.
    GpsTime next(std::int64_t time_of_day_ns);

  private:
    GpsTime midnight_of(std::int64_t day) const;

    std::optional<std::chrono::sys_days> first_day_;
    std::int64_t day_ = 0;  ///< since the first
    std::optional<std::int64_t> before_ns_;
    std::optional<std::int64_t> known_day_;  ///< of which midnight_ and length_ns_ are
    GpsTime midnight_;
    std::int64_t length_ns_ = 0;
};

}  // namespace runcert::vbo
