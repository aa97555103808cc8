#pragma once

#include "stages/import/nmea/epoch.h"

namespace runcert::nmea {

/// Whether an epoch has a sentence that says where the receiver is, or that it does not know.
bool says_position(const Epoch& epoch);

/// Whether every sentence that speaks of it says that there is a solution.
bool has_fix(const Epoch& epoch);

/// Where the row of an epoch comes from: the sentence that gives its position, or could.
RecordPlace place_of(const Epoch& epoch);

/// What the rows of a recording were made of.
struct RowTally {
    std::int64_t above_sea_level = 0;
    std::int64_t without_height = 0;
    std::int64_t in_plane = 0;
    std::int64_t velocities_disagree = 0;
    std::int64_t ellipses_disagree = 0;
};

/// Makes rows of epochs, and counts what is worth saying of them.
class RowMaker {
  public:
    /// The row of an epoch that says_position.
    TimedRow row(const Epoch& epoch, GpsTime instant);
    const RowTally& tally() const { return tally_; }

  private:
    void set_solution(TimedRow& row, const Solution& solution);
    void set_ground_velocity(Observation& row, const Epoch& epoch);
    void set_errors(Observation& row, const ErrorStatistics& errors);

    RowTally tally_;
};

}  // namespace runcert::nmea
