#pragma once

#include <functional>
#include <memory>

#include "schemas/attempt/attempt.h"
#include "schemas/enu/declared.h"
#include "schemas/phase/declared.h"
#include "schemas/screened_phase/declared.h"
#include "witness/phase_motion.h"
#include "witness/screened_phases.h"

namespace runcert {

/// The parameters of phase screening that the attempt states.
PhaseScreeningConfig phase_screening_config(const Attempt& attempt);

/// A receiver's screened phases.
struct ScreenedPhases {
    ScreenedPhaseTable head;  ///< without the rows; the caller sets the header
    std::shared_ptr<const JudgedPhases> phases;

    /// The phases as a witness of a table's positions, by its first epoch and frame. Empty if
    /// the positions have no times or no geodetic origin. Where the motion of phases and positions
    /// differs, every use of the witness shows the contradiction.
    template <int Axes>
    std::optional<PhaseWitness<Axes>> witness(const EnuTable& positions,
                                              double jerk_density) const {
        return phase_witness<Axes>(phases, head.first_epoch, positions.facts.first_epoch,
                                   positions.origin, jerk_density);
    }
};

/// Screens a receiver's phases for cycle slips (`screen_phases`), and compares their motion with
/// that of the recorded positions. The positions also give the receiver's place. Where there are
/// none, or they are another receiver's, the pseudoranges do. A contradiction is a finding with a
/// note, and so are too few data.
ScreenedPhases screen_receiver_phases(const PhaseTable& head, PhaseRecord record,
                                      const EnuTable& positions,
                                      const PhaseScreeningConfig& config);

/// Passes the rows of the table to `take`, in the order of the record.
void give_screened_rows(const ScreenedPhases& screened,
                        const std::function<void(const ScreenedPhase& row)>& take);

}  // namespace runcert
