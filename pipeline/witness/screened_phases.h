#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/geodesy.h"
#include "core/gps_time.h"
#include "satellites/phase_pairs.h"
#include "satellites/phase_record.h"
#include "satellites/phase_screening.h"
#include "schemas/enu/frame_origin.h"
#include "schemas/screened_phase/declared.h"
#include "witness/phase_motion.h"
#include "witness/phase_rows.h"

namespace runcert {

/// The table's word for what begins an arc of phases. Empty if no arc begins.
std::optional<ArcStart> start_of(PhaseBreak begins);

/// The place of a receiver over GPS time, from its recorded positions.
class ReceiverTrack {
  public:
    /// Empty if the positions have no times or no geodetic origin. `Rows` holds EnuEpoch or a
    /// type derived from it.
    template <class Rows>
    ReceiverTrack(const std::optional<FrameOrigin>& origin,
                  const std::optional<GpsTime>& first_epoch, const Rows& rows) {
        if (!origin || !first_epoch) return;
        const PlaceFrames frames(*origin);
        for (const EnuEpoch& row : rows)
            add(frames, *first_epoch, row);
        put_in_order();
    }

    bool empty() const { return positions_m_.empty(); }

    /// WGS 84 Earth-centred position (m), interpolated between neighbours at most three seconds
    /// apart. Empty elsewhere.
    std::optional<Eigen::Vector3d> at(std::int64_t time_ns) const;

  private:
    void add(const PlaceFrames& frames, const GpsTime& first_epoch, const EnuEpoch& row);
    void put_in_order();

    std::vector<std::pair<std::int64_t, Eigen::Vector3d>> positions_m_;  ///< in ascending order of
                                                                         ///< time
};

/// How a record was given its places.
struct PhasePositions {
    bool by_positions = false;
    /// Median distance (m) between the places by pseudoranges and by recorded positions. Empty
    /// if no epoch has both.
    std::optional<double> apart_m;
};

/// Sets a record's receiver places from its recorded positions, or from pseudoranges (to some
/// metres) where there is no recorded position. If the two are too far apart, all places come from
/// pseudoranges. `first_ns` is the GPS time of the record's first epoch.
PhasePositions set_receiver_positions(PhaseRecord& record, std::int64_t first_ns,
                                      const ReceiverTrack& positions);

/// Adds the rows of 3-phase.ecsv, in order, to the record of 1-phase.ecsv.
class PhaseScreeningBuilder {
  public:
    /// The record must have its places. `mask_deg` is screening's elevation mask.
    PhaseScreeningBuilder(const PhaseRecord& record, const ScreenedPhaseTable& head,
                          double mask_deg);

    /// Failure if the row's signal differs from the record's.
    void add(const ScreenedPhase& row);

    /// Failure if rows are missing.
    PhaseScreening take() &&;

  private:
    void step_to_next();

    const PhaseRecord& record_;
    SignalChoice choice_;
    PhaseScreening screening_;
    std::size_t epoch_ = 0;
    std::size_t satellite_ = 0;
    std::size_t signal_ = 0;
};

/// The phases of 1-phase.ecsv with their screening in 3-phase.ecsv, both read row by row. Only
/// epochs with a time (s) from `from_s` to `to_s` are included.
template <class PhaseRows, class ScreenedRows>
JudgedPhases judged_phases(PhaseRows& phases, ScreenedRows& screened,
                           const ReceiverTrack& positions, double mask_deg,
                           double from_s = -std::numeric_limits<double>::infinity(),
                           double to_s = std::numeric_limits<double>::infinity()) {
    const auto wanted = [&](const ElapsedTime& time) {
        return time.seconds() >= from_s && time.seconds() <= to_s;
    };
    JudgedPhases judged;
    PhaseRecordBuilder record(phases.head());
    for (PhaseRow row; phases.next(row);)
        if (wanted(row.time)) record.add(row);
    judged.record = std::move(record).take();
    set_receiver_positions(judged.record, phases.head().first_epoch.nanoseconds(), positions);
    PhaseScreeningBuilder screening(judged.record, screened.head(), mask_deg);
    for (ScreenedPhase row; screened.next(row);)
        if (wanted(row.time)) screening.add(row);
    judged.screening = std::move(screening).take();
    return judged;
}

/// The phases as a witness of positions. Empty if the positions have no times or no geodetic
/// origin.
template <int Axes>
std::optional<PhaseWitness<Axes>> phase_witness(std::shared_ptr<const JudgedPhases> phases,
                                                const GpsTime& first_of_phases,
                                                const std::optional<GpsTime>& first_of_positions,
                                                const std::optional<FrameOrigin>& origin,
                                                double jerk_density) {
    if (!first_of_positions || !origin) return std::nullopt;
    std::vector<FrameTurn> turns;
    for (std::size_t number = 0; number <= origin->places.size(); ++number) {
        const FramePlace place = origin->place(number);
        turns.push_back({.from_s = place.from.seconds(),
                         .enu_from_ecef = rotation_enu_from_ecef(place.position.latitude,
                                                                 place.position.longitude)});
    }
    const auto later_ns = first_of_positions->nanoseconds_since(first_of_phases);
    return PhaseWitness<Axes>(std::move(phases), static_cast<double>(later_ns) * 1e-9,
                              std::move(turns), jerk_density);
}

}  // namespace runcert
