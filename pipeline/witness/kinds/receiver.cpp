#include "witness/roster.h"

// Another receiver of the same craft: `receiver_witness` makes the witness.

namespace runcert::witnesses {
namespace {

/// Its errors are as likely and as large as those of the receiver under test.
FaultPrior fault_of_receiver(const FaultPrior& positions) {
    return positions;
}

}  // namespace

extern const WitnessEntry receiver{
    .kind = WitnessKind::receiver,
    .fault = fault_of_receiver,
    .silent = "the two recordings have no common time or frame, or it has no estimate",
    .remedy = "Check that receiver's fixes, its antenna's place on the craft, and its clock.",
    .screening = ScreeningTest{
        .reason = Reason::baseline, .hypothesis = Hypothesis::baseline, .only_fast = true}};

}  // namespace runcert::witnesses
