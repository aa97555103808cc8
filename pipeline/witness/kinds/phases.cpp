#include "witness/roster.h"

// Time-differenced carrier phases: `phase_witness` and `phase_motion` make the witness.

namespace runcert::witnesses {
namespace {

FaultPrior fault_of_phases(const FaultPrior& /*positions*/) {
    return {.probability = 0.001, .largest_m_s = 0.1};
}

}  // namespace

extern const WitnessEntry phases{
    .kind = WitnessKind::phases,
    .fault = fault_of_phases,
    .silent = "the positions have no times or no place on the Earth to compare them with",
    .remedy =
        "Check that raw signals, navigation data and positions are of one receiver and one run.",
    .screening = ScreeningTest{.reason = Reason::phase, .hypothesis = Hypothesis::phase}};

}  // namespace runcert::witnesses
