#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "satellites/phase_record.h"
#include "schemas/phase/declared.h"

namespace runcert {

/// Adds rows of 1-phase.ecsv, in order, to the record that estimation uses. Each row is one signal,
/// so that row and signal numbers agree.
class PhaseRecordBuilder {
  public:
    /// `head` identifies the ephemerides of the rows' positions.
    explicit PhaseRecordBuilder(const PhaseTable& head);

    /// Failure if the rows are not ordered by time, satellite and signal.
    void add(const PhaseRow& row);

    PhaseRecord take() && { return std::move(record_); }

  private:
    PhaseSatellite satellite_of(const PhaseRow& row) const;
    void make_room();

    struct Health {
        bool healthy = true;
        float group_delay_m = 0.0F;
    };
    std::map<std::pair<Satellite, std::int64_t>, Health> ephemerides_;  ///< by satellite and issue
    PhaseRecord record_;
    std::int64_t epochs_ = 0;  ///< number of epochs that the head announces
    std::int64_t epoch_ = 0;
};

}  // namespace runcert
