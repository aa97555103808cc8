#pragma once

#include <cstdint>
#include <optional>

#include "core/gps_time.h"
#include "stages/import/nmea/epoch.h"

namespace runcert::nmea {

/// Carries the day from one time of day to the next: a step back of more than half a day is
/// midnight passed, one forward is midnight passed backwards.
class DayCarry {
  public:
    /// The day of the next epoch, counted from that of the first.
    std::int64_t days_since_first(std::int64_t time_of_day_ns);

  private:
    std::optional<std::int64_t> last_ns_;
    std::int64_t days_ = 0;
};

/// What dates a recording's epochs.
struct FirstDay {
    std::int64_t day = 0;  ///< of its first epoch, days since 1980-01-06
    /// Whether dates of epochs without a fix count: no other epoch has one. A receiver that has no
    /// fix writes what its own clock has kept.
    bool without_fix = false;
};

/// The date of a recording's first epoch, by counting back from the first that is dated; nothing
/// where none is. Reads no further than it must.
std::optional<FirstDay> find_first_day(const RecordingBytes& recording);

/// Gives epochs, in the order of the recording, their instants.
class Dating {
  public:
    /// Without a day, instants count from the midnight before the first epoch as if that were the
    /// GPS epoch.
    explicit Dating(const std::optional<FirstDay>& first) : first_(first) {}

    /// Failure where the epoch is in a leap second that never was.
    GpsTime instant(const Epoch& epoch, const RecordingBytes& recording);

  private:
    GpsTime start_of_day(std::int64_t day, const RecordingBytes& recording,
                         const RecordPlace& place);

    std::optional<FirstDay> first_;
    DayCarry carry_;
    std::int64_t shift_days_ = 0;  ///< of dated epochs against the carried day
    std::optional<std::int64_t> started_day_;
    GpsTime start_;
};

}  // namespace runcert::nmea
