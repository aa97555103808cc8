#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/gps_time.h"
#include "stages/import/recording.h"
#include "stages/import/row_collector.h"

namespace runcert::oao {

/// The first byte of a frame; the second is always 0x0A.
enum class FrameKind : std::uint8_t {
    header = 0xD0,
    track = 0xD1,
    emergency = 0xD2,
    point_of_interest = 0xD3,
    epoch_on_the_second = 0xD4,
    epoch_between_seconds = 0xD5,
    inertial = 0xD6
};

inline constexpr std::size_t epoch_length = 52;

/// The length that the two bytes at `at` announce; 0 where no frame begins with them.
std::size_t announced_length(std::string_view bytes, std::size_t at);

/// The whole frame with a good checksum that begins at `at`; empty where there is none.
///
/// The checksum is Fletcher's with 8 bits, as in u-blox UBX, over the frame without the checksum's
/// own bytes 2 and 3.
std::string_view frame_at(std::string_view bytes, std::size_t at);

/// Where the next whole frame with a good checksum begins, at `from` or after; the end of `bytes`
/// where there is none.
std::size_t find_frame(std::string_view bytes, std::size_t from);

FrameKind kind_of(std::string_view frame);

/// Reads the epochs of one recording.
class EpochReader {
  public:
    explicit EpochReader(const RecordingBytes& recording) : recording_(recording) {}

    /// The row of an epoch's frame. Failure at `place` for a fix, course, position or time that
    /// cannot be.
    ///
    /// u-blox does not say in how many dimensions the stated standard deviation of the speed
    /// counts. It is taken as that of the speed over ground, the only one recorded: of the two
    /// readings the one that claims less.
    TimedRow read(std::string_view frame, const RecordPlace& place);

  private:
    GpsTime instant(std::int64_t unix_ms, const RecordPlace& place);

    const RecordingBytes& recording_;
    std::int64_t day_ = -1;  ///< since 1970-01-01, of the epoch before
    GpsTime midnight_;       ///< of that day
};

/// What a header frame says of the logger: its number, firmware, name.
std::string device_of(std::string_view header);

/// Whether a header frame carries the logger's signature.
bool is_signed(std::string_view header);

}  // namespace runcert::oao
