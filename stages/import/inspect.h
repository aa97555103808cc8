#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schemas/observations/observations.h"
#include "schemas/recognition/declared.h"
#include "stages/import/phase_table.h"
#include "stages/import/recording.h"
#include "witness/copies.h"

namespace runcert {

/// The delay of the recorded velocity behind the positions (s), by `velocities::estimate_delay`
/// against the motion that a parabola through the positions within 0.4 s of each epoch shows (two
/// epochs on either side at least). Nothing where the recording does not tell it.
std::optional<double> raw_velocity_delay_s(const Observations& observations);

/// A step between epochs is a gap from this many nominal intervals on.
inline constexpr double gap_factor = 1.5;

/// What screening takes off of a delay where the attempt says nothing else (s).
inline constexpr double longest_velocity_delay_s = 1.0;

/// A delay of the recorded speeds behind the positions over a part of a recording; times from its
/// first epoch (s).
struct RawDelay {
    double from_s = 0.0, to_s = 0.0;
    double delay_s = 0.0, sigma_s = 0.0;
    bool beyond = false;  ///< more than `longest_velocity_delay_s`
};

/// Delays along the recording by the lengths of the speeds, with a course or without, by
/// `velocities::delays_along` against the same motion.
std::vector<RawDelay> raw_velocity_delays(const Observations& observations);

/// Whether the recorded velocities and speeds were computed from the positions, by
/// `made_from`.
VelocityOrigin raw_velocity_origin(const Observations& observations);

/// A fastest stretch, unscreened.
struct RawBest {
    double speed_m_s = 0.0;  ///< horizontal, or vertical
    ElapsedTime start;       ///< since the first epoch
    std::optional<GpsTime> start_gps = std::nullopt;
    double duration_s = 0.0;
    std::int64_t first_epoch = 0;
    std::int64_t last_epoch = 0;
    bool all_fixed = false;  ///< every epoch from the first to the last is "fixed"
};

/// What a recording holds, before anything is judged.
struct Inspection {
    std::optional<GpsTime> first, last;  ///< earliest and latest epoch; empty on relative time
    double span_s = 0.0;
    /// Local time less UTC of the nautical zone of the first position, h.
    std::optional<int> zone_h;
    std::size_t epochs = 0;
    std::size_t without_position = 0;
    double nominal_interval_s = 0.0;
    std::vector<std::pair<FixType, std::size_t>> fixes;  ///< most frequent first
    std::size_t fix_changes = 0;
    std::size_t gaps = 0;  ///< steps longer than 1.5 nominal intervals
    double longest_gap_s = 0.0;
    std::size_t repeated_times = 0;    ///< steps of zero
    std::size_t most_at_one_time = 0;  ///< epochs of one time that follow one another
    std::size_t backward_times = 0;
    std::string bursts;                 ///< as `bursts_in` has it
    std::size_t with_velocity = 0;      ///< epochs with a recorded velocity or speed
    std::size_t speeds_alone = 0;       ///< those of them without a course
    std::size_t velocities_stated = 0;  ///< those of them that state their accuracy
    VelocityOrigin velocity_origin = VelocityOrigin::unclear;
    std::optional<double> velocity_delay_s;  ///< behind the positions
    std::vector<RawDelay> velocity_delays;   ///< by the lengths of the speeds
    /// Stated, as median_horizontal_m.
    std::optional<double> median_velocity_m_s, worst_velocity_m_s;
    std::size_t with_accuracy = 0;           ///< epochs that state a horizontal one
    std::size_t with_vertical_accuracy = 0;  ///< epochs that state one of heights
    /// sqrt(sigma_east^2 + sigma_north^2)
    std::optional<double> median_horizontal_m, worst_horizontal_m;
    std::optional<RawBest> best_by_position, best_by_velocity;
    /// What its positions are instead, where only so the fastest by them is that by velocity.
    std::string misread_positions;
    /// Of heights alone, upwards or downwards.
    std::optional<RawBest> best_vertical_by_position, best_vertical_by_velocity;

    /// Whether it is of something that falls or climbs; heights alone, which err more than
    /// horizontal positions, do not show it.
    bool is_vertical() const;
};

/// Counts and measures a recording.
///
/// The best 3 s are over all windows whose ends are epochs at least 2.999 s and less than 3 s and
/// one nominal interval apart, bad epochs included. By position: the straight line between the
/// ends, projected on the horizontal of its first; by velocity: mean horizontal speed of the
/// window's epochs, all of which must have one. The vertical ones by the difference of height, and
/// by the mean of the vertical velocity. Of several epochs with one time, the first counts.
Inspection inspect(const Observations& observations);

/// What the positions are, in words.
std::vector<FactGroup> positions_said(const Observations& observations,
                                      const Inspection& inspection);

/// What an official should look at, but for what an attempt is asked for, the most important first.
/// `now`: later dates cannot be; empty where that is not asked.
std::vector<Concern> positions_concerns(const Observations& observations,
                                        const Inspection& inspection,
                                        const std::optional<GpsTime>& now = std::nullopt);

/// Adds what raw measurements hold: satellites, signals, gaps, slips, whether the receiver moved,
/// and its fastest 3 s by carrier phase alone. The navigation file is named where there is one, and
/// who wrote the measurements where the files say so.
void add_phases(const StreamedPhases& phases, const std::string& navigation,
                const Observations& said, Recognition& is);

/// Appends a name and what it is, unless that is empty.
void add_fact(FactGroup& group, std::string name, std::string value);

/// That a recording says so itself.
Concern simulated_concern();

}  // namespace runcert
