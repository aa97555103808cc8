#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "stages/import/row_collector.h"
#include "stages/import/ubx/frames.h"

namespace runcert::ubx {

/// The messages that make an epoch. All from POSLLH on are those of receivers too old for PVT.
enum class Part : std::uint8_t {
    pvt,
    hpposllh,
    cov,
    posllh,
    velned,
    timeutc,
    timegps,
    sol,
    status
};

/// A part as a message of the class NAV. PVT has 84 bytes up to protocol version 14, 92 since, and
/// may have more; the others always have so many.
struct PartMessage {
    std::string_view name;
    MessageId id;
    std::size_t bytes;
};

/// In the order of Part.
inline constexpr std::array<PartMessage, 9> part_messages{{{"PVT", 0x0107, 84},
                                                           {"HPPOSLLH", 0x0114, 36},
                                                           {"COV", 0x0136, 64},
                                                           {"POSLLH", 0x0102, 28},
                                                           {"VELNED", 0x0112, 36},
                                                           {"TIMEUTC", 0x0121, 20},
                                                           {"TIMEGPS", 0x0120, 16},
                                                           {"SOL", 0x0106, 52},
                                                           {"STATUS", 0x0103, 16}}};

/// Which part a message is; nothing for another message, or one of a size that it never has.
std::optional<Part> part_of(const Frame& frame);

/// GPS time of week (ms) of the navigation epoch that a part belongs to.
std::uint32_t time_of_week_ms(Part part, std::string_view payload);

/// The messages of one navigation epoch.
struct Epoch {
    std::uint32_t time_of_week_ms = 0;
    std::array<std::optional<Frame>, part_messages.size()> parts;

    bool has(Part part) const { return parts[static_cast<std::size_t>(part)].has_value(); }
    /// The payload of a part that is there.
    std::string_view operator[](Part part) const {
        return payload_of(*parts[static_cast<std::size_t>(part)]);
    }
    /// Whether it has enough for a row.
    bool is_whole() const { return has(Part::pvt) || (has_position() && has_time()); }
    bool has_position() const {
        return has(Part::pvt) || has(Part::posllh) || has(Part::sol) || has(Part::hpposllh);
    }
    bool has_time() const { return has_utc() || has(Part::timegps) || has(Part::sol); }
    bool has_utc() const { return has(Part::pvt) || has(Part::timeutc); }
    /// The message that the position is taken from, of an epoch that has one.
    Part position() const {
        return has(Part::pvt)      ? Part::pvt
               : has(Part::posllh) ? Part::posllh
               : has(Part::sol)    ? Part::sol
                                   : Part::hpposllh;
    }
    RecordPlace place() const {
        return RecordPlace(parts[static_cast<std::size_t>(position())]->offset);
    }
};

/// Counts of what the rows of a recording were made of.
struct RowTally {
    std::int64_t without_time = 0;    ///< epochs left out
    std::int64_t in_utc = 0;          ///< epochs whose time is of UTC
    std::int64_t other_second = 0;    ///< UTC whole seconds off the GPS time of week
    std::int64_t rolled_over = 0;     ///< dates of a GPS week that was 1024 or 2048 too small
    std::int64_t of_solution = 0;     ///< positions of SOL
    std::int64_t high_precision = 0;  ///< positions of HPPOSLLH
    std::int64_t standard_precision = 0;
    std::int64_t in_plane = 0;  ///< two-dimensional solutions
    std::int64_t with_dead_reckoning = 0;
    std::int64_t by_week = 0;  ///< epochs whose week is that of another epoch
};

/// Makes rows of epochs, and counts what the notes say of them.
class RowMaker {
  public:
    explicit RowMaker(const RecordingBytes& recording) : recording_(recording) {}

    /// The row of an epoch that is_whole, or has a position and no date; nothing where the receiver
    /// did not know the time. Of those without date the week is that of the nearest TIMEGPS, and
    /// the fix type that of the STATUS of the last second. Failure where its time or position is
    /// impossible.
    std::optional<TimedRow> row(const Epoch& epoch);
    const RowTally& tally() const { return tally_; }

  private:
    std::optional<GpsTime> instant(const Epoch& epoch);
    std::optional<GpsTime> by_another_epoch(std::uint32_t time_of_week_ms);
    FixType fix_by_status(const Epoch& epoch);
    std::optional<GpsTime> in_true_week(GpsTime shown, std::int64_t leap_seconds);
    void set_place(Observation& row, const Epoch& epoch);

    const RecordingBytes& recording_;
    RowTally tally_;
    std::optional<GpsTime> dated_;  ///< by a TIMEGPS, the last or the first to come
    bool looked_for_ = false;       ///< whether the first to come was
    std::optional<Frame> status_;   ///< the last
};

}  // namespace runcert::ubx
