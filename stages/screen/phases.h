#pragma once

#include <functional>
#include <memory>

#include "schemas/attempt/attempt.h"
#include "schemas/enu/enu.h"
#include "schemas/phase/phase.h"
#include "schemas/screened_phase/screened_phase.h"
#include "witness/phase_motion.h"
#include "witness/screened_phases.h"

namespace runcert {

/// The figures of the phases' screening, as the attempt states them.
PhaseScreeningConfig phase_screening_config(const Attempt& attempt);

/// A receiver's phases, screened.
struct ScreenedPhases {
    ScreenedPhaseTable head;  ///< without the rows; the header is the caller's
    std::shared_ptr<const JudgedPhases> phases;

    /// As a witness of the positions of a table whose first epoch and frame these are; nothing
    /// where the positions have no times or no place on the Earth. A motion that is another than
    /// the positions' is a contradiction that the witness shows, wherever it is asked.
    template <int Axes>
    std::optional<PhaseWitness<Axes>> witness(const EnuTable& positions,
                                              double jerk_density) const {
        return phase_witness<Axes>(phases, head.first_epoch, positions.facts.first_epoch,
                                   positions.origin, jerk_density);
    }
};

/// Screens a receiver's phases for cycle slips (`screen_phases`), and compares the motion that they
/// show with that of its recorded positions, which also say where it was: where there are none, or
/// others', its pseudoranges do. A contradiction is a finding with a note, and so is too little to
/// say.
ScreenedPhases screen_receiver_phases(const PhaseTable& head, PhaseRecord record,
                                      const EnuTable& positions,
                                      const PhaseScreeningConfig& config);

/// The rows of the table, in the order of the record.
void give_screened_rows(const ScreenedPhases& screened,
                        const std::function<void(const ScreenedPhase& row)>& take);

}  // namespace runcert
