#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "estimation/phase_record.h"
#include "schemas/phase/phase.h"

namespace runcert {

/// Takes rows of 1-phase.ecsv in their order into the record that estimation works on: one signal a
/// row, so that the signal of a row has its number.
class PhaseRecordBuilder {
  public:
    /// The head says what ephemerides the rows' positions are of.
    explicit PhaseRecordBuilder(const PhaseTable& head);

    /// Failure where the rows are not in the order of time, satellite and signal.
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
    std::int64_t epochs_ = 0;  ///< as the head has them
    std::int64_t epoch_ = 0;
};

}  // namespace runcert
