#pragma once

#include <string>
#include <vector>

#include "schemas/screened/screened.h"
#include "witness/roster.h"
#include "witness/witnessed_spans.h"

namespace runcert {

/// The usable rows of the arcs in the form in which spans are tested: their positions and their row
/// indices.
struct UsablePositions {
    std::vector<TimedPosition<2>> positions;
    std::vector<std::size_t> rows;
};
UsablePositions usable_positions(const std::vector<ScreenedEpoch>& rows);

/// Marks the epochs in which the difference of contradicted spans arises, with the size and
/// direction of the disagreement. The arc ends after them (ramp), because positions before and
/// after do not belong together.
void mark_spans(std::vector<ScreenedEpoch>& rows, const UsablePositions& usable,
                const std::vector<ContradictedSpan>& spans, const ScreeningTest& test,
                double threshold);

/// A test of positions against a witness's displacements, as the roster describes it.
struct DisplacementTest {
    WitnessKind kind = WitnessKind::phases;
    std::string receiver = {};  ///< id, where the witness is another receiver
    const Witness<2>* witness = nullptr;
};

/// Tests positions against the displacements by a witness. It marks an epoch whose displacements
/// from the previous epoch and to the next are contradicted in opposite directions (an outlier).
/// Where there is none, it marks drifts and steps within spans of 3 and 10 s (`mark_spans`).
/// Differences are judged by the overall spread of such spans in this recording, so that positions
/// less accurate than stated are not marked for that alone. `test_size` is the false alarm rate of
/// one test.
DisplacementComparison check_displacements(std::vector<ScreenedEpoch>& rows,
                                           const DisplacementTest& test, double nominal_interval_s,
                                           double test_size);

/// Adds what was found to `all`. For a witness tested several times, it keeps the last figures and
/// the total of rejections.
void note(DisplacementComparison found, std::vector<DisplacementComparison>& all);

}  // namespace runcert
