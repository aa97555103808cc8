#include "witness/roster.h"

// Another receiver of the same craft: `receiver_witness` makes the witness.

namespace runcert::witnesses {
namespace {

/// It errs as the judged one does.
FaultPrior fault_of_receiver(const FaultPrior& positions) {
    return positions;
}

}  // namespace

extern const WitnessEntry receiver{
    .kind = WitnessKind::receiver,
    .fault = fault_of_receiver,
    .silent = "the two recordings have no common time or frame, or it has no estimate",
    .screening = ScreeningTest{
        .reason = Reason::baseline, .hypothesis = Hypothesis::baseline, .only_fast = true}};

}  // namespace runcert::witnesses
