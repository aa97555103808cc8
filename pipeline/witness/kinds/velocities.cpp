#include "witness/roster.h"

// Recorded velocities: `recorded_velocities` makes the witness, and screening determines its
// errors.

namespace runcert::witnesses {
namespace {

FaultPrior fault_of_velocities(const FaultPrior& /*positions*/) {
    return faults_of_speeds;
}

}  // namespace

extern const WitnessEntry velocities{
    .kind = WitnessKind::velocities,
    .fault = fault_of_velocities,
    .silent = "nothing bounds their errors",
    .remedy = "Check that they are the receiver's own Doppler velocities, in the unit stated.",
    .screening = ScreeningTest{.reason = Reason::velocity, .hypothesis = Hypothesis::velocity}};

}  // namespace runcert::witnesses
