#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/failure.h"
#include "stages/import/recording.h"

namespace runcert::ubx {

/// Class and number of a message, NAV-PVT for one: 0x0107.
using MessageId = std::uint16_t;

/// A frame of a recording, or what began as one.
struct Frame {
    std::size_t offset = 0;  ///< of its first byte in the file
    MessageId id = 0;
    std::string_view payload;  ///< of a good frame
    bool good = false;
    bool cut_off = false;  ///< of a bad one: the recording ends before it does
};

/// The 24-bit cyclic redundancy check of RTCM 10403.3, section 4.2, and [GAL-ICD] 5.1.9.4.
std::uint32_t crc24q(std::string_view bytes);

/// Why a frame that is not good cannot be read.
Failure failure_of(const Frame& frame, const RecordingBytes& recording);

/// The checksum of UBX frames (the 8-bit Fletcher algorithm of RFC 1145) over any stretch of a
/// recording, by running sums of a window that is moved along, so that any number of stretches
/// that each begin behind the one before cost no more than a few passes over the recording.
class RunningChecksum {
  public:
    /// No stretch is longer: a frame's class to the end of its payload.
    static constexpr std::size_t longest = 4 + 0xffff;

    explicit RunningChecksum(std::string_view bytes) : bytes_(bytes) {}

    /// Both bytes, the first one in the lower half. The stretch is in the recording.
    std::uint16_t of(std::size_t begin, std::size_t size);

  private:
    void move_to(std::size_t begin);

    std::string_view bytes_;
    std::size_t begin_ = 0;  ///< of the window
    /// Modulo 256: at i the sum of the window's first i bytes, and the sum of these sums.
    std::vector<std::uint8_t> sums_, sums_of_sums_;
};

/// Goes through a recording frame by frame, over whatever stands between them: NMEA sentences,
/// RTCM 3 messages, junk. Layout: u-blox "F9 HPG interface description" (UBX-22008968), section
/// 3.2: B5 62, class, number, length of the payload, payload, checksum.
///
/// After a bad frame it goes on at the byte behind its sync characters. Two such bytes by chance
/// among others are not taken for a frame that is bad, if what follows is no class of messages.
class FrameReader {
  public:
    explicit FrameReader(std::string_view bytes)
        : bytes_(bytes), checksum_(bytes), rtcm_budget_(bytes.size()) {}

    /// The next frame, good or bad; nothing at the end.
    std::optional<Frame> next();

    /// Bytes that were of no frame, no RTCM message and no text.
    std::int64_t junk_bytes() const { return junk_bytes_; }

  private:
    std::optional<Frame> frame_at(std::size_t offset);
    std::size_t rtcm_message_at(std::size_t offset);

    std::string_view bytes_;
    RunningChecksum checksum_;
    std::size_t at_ = 0;
    bool after_message_ = true;  ///< at the beginning, or right behind a whole message
    std::size_t rtcm_budget_;
    std::int64_t junk_bytes_ = 0;
};

}  // namespace runcert::ubx
