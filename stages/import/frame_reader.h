#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/failure.h"
#include "stages/import/recording.h"

namespace runcert {

/// The 24-bit cyclic redundancy check of RTCM 10403.3, section 4.2, and [GAL-ICD] 5.1.9.4.
std::uint32_t crc24q(std::string_view bytes);

/// The checksum of u-blox frames (the 8-bit Fletcher algorithm of RFC 1145) over any stretch of a
/// recording, by running sums of a window that is moved along, so that any number of stretches
/// that each begin behind the one before cost no more than a few passes over the recording.
class RunningChecksum {
  public:
    /// No stretch is longer: a UBX frame's class to the end of its payload.
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

/// How a format frames its records.
struct FrameKind {
    /// The size of the frame that begins here, as its first bytes announce it; 0 where none does.
    std::size_t (*size)(std::string_view ahead);
    /// Whether a frame of that size, which begins at `offset`, is whole and undamaged. To cost
    /// little on hostile files it looks at few bytes, or at the running sums.
    bool (*is_good)(std::string_view frame, std::size_t offset, RunningChecksum& sums);
    /// Names a damaged frame, "the UBX frame of class 01, number 07"; null for "the record".
    std::string (*name)(std::string_view frame) = nullptr;
    /// Whether what is not good is a damaged frame wherever it stands, and not only behind a whole
    /// message: false where the bytes may begin as one by chance. Null where all are.
    bool (*is_likely)(std::string_view frame) = nullptr;
    /// Whether other protocols share the recording: their bytes are no damage.
    bool among_others = false;
    /// Damaged bytes count as so many records as would fit there, of this size. 0, of a kind whose
    /// frames have many sizes: stray bytes count as one, and behind a damaged frame as none.
    std::size_t record_size = 0;
};

/// A frame of a recording, what began as one, or bytes that are of none.
struct Frame {
    enum class Damage : std::uint8_t { none, cut_off, checksum, stray };

    std::size_t offset = 0;  ///< of its first byte in the file
    std::string_view bytes;  ///< as many as are there; none of stray bytes
    Damage damage = Damage::none;

    bool good() const { return damage == Damage::none; }
};

/// Goes through a recording frame by frame, over whatever stands between them: NMEA sentences,
/// RTCM 3 messages, junk, room that was never written. After a damaged frame it goes on at the byte
/// behind the two that begin it.
class FrameReader {
  public:
    FrameReader(const RecordingBytes& recording, const FrameKind& kind);

    /// The next frame, good or damaged, or the beginning of stray bytes; nothing at the end.
    std::optional<Frame> next();

    /// Why a frame that is not good cannot be read.
    Failure failure_of(const Frame& frame) const;

    /// Bytes, among other protocols, that were of no frame, no RTCM message and no text.
    std::int64_t junk_bytes() const { return junk_bytes_; }

  private:
    Frame frame_at(std::size_t offset);
    std::size_t rtcm_message_at(std::size_t offset);
    void pass_other_bytes();

    RecordingBytes recording_;
    const FrameKind& kind_;
    std::string_view bytes_;
    RunningChecksum checksum_;
    std::size_t at_ = 0;
    std::size_t written_end_;      ///< behind it are 0x00 or 0xFF alone
    std::size_t next_damage_ = 0;  ///< what stands before it is of damage that was given
    bool after_message_ = true;    ///< at the beginning, or right behind a whole message
    std::size_t rtcm_budget_;
    std::int64_t junk_bytes_ = 0;
};

}  // namespace runcert
