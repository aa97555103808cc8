#pragma once

#include <string>
#include <vector>

#include "schemas/screened/screened.h"
#include "witness/roster.h"
#include "witness/witnessed_spans.h"

namespace runcert {

/// The usable rows of the arcs, as spans are tested: their positions, and which rows they are.
struct UsablePositions {
    std::vector<TimedPosition<2>> positions;
    std::vector<std::size_t> rows;
};
UsablePositions usable_positions(const std::vector<ScreenedEpoch>& rows);

/// Marks the epochs in which the difference of contradicted spans comes about, with the size and
/// direction of the disagreement, and ends the arc behind them (ramp): positions before and after
/// do not belong together.
void mark_spans(std::vector<ScreenedEpoch>& rows, const UsablePositions& usable,
                const std::vector<ContradictedSpan>& spans, const ScreeningTest& test,
                double threshold);

/// The witness whose displacements positions are tested against, as the roster says.
struct DisplacementTest {
    WitnessKind kind = WitnessKind::phases;
    std::string receiver = {};  ///< id, where the witness is another receiver
    const Witness<2>* witness = nullptr;
};

/// Tests positions against the displacements by a witness: marks an epoch whose displacements from
/// the one before and to the one after are contradicted in opposite directions (an outlier); where
/// there is none, what drifts or steps within spans of 3 and 10 s (`mark_spans`). The two are
/// compared by what such spans of this recording differ by altogether, so that positions worse
/// than they state are not marked for that. `test_size`: false alarm rate of one test.
DisplacementComparison check_displacements(std::vector<ScreenedEpoch>& rows,
                                           const DisplacementTest& test, double nominal_interval_s,
                                           double test_size);

/// Keeps what was found; of one witness asked several times its last figures, and all that it
/// rejected.
void note(DisplacementComparison found, std::vector<DisplacementComparison>& all);

}  // namespace runcert
