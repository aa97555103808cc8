#pragma once

#include <string>
#include <vector>

#include "motion/epoch_motion.h"
#include "schemas/screened/screened.h"
#include "witness/roster.h"
#include "witness/witnessed_spans.h"

namespace runcert {

/// A test of positions against a witness's displacements, as the roster describes it.
struct DisplacementTest {
    WitnessKind kind = WitnessKind::phases;
    std::string receiver = {};  ///< id, where the witness is another receiver
    const Witness<2>* witness = nullptr;
    /// The same with only those errors that last longer than an interval and those that the test of
    /// single intervals does not see by itself. Null: the witness.
    const Witness<2>* over_intervals = nullptr;
    /// The motion smoothed from the positions, one element for each row, which is compared too.
    /// Null: only the positions are.
    const Motion* motion = nullptr;
    double lag_s = 0.0;  ///< as in `SpanTest`
    /// Whether what positions state is added to the spread, for witnesses whose errors vary more
    /// than the spread says.
    bool adds_stated = false;
};

/// Tests positions against the displacements by a witness.
/// - An epoch is marked whose displacements from the previous epoch and to the next are
///   contradicted in opposite directions: only an outlier does that.
/// - Where there is none, epochs are marked inside three or more consecutive intervals over which
///   the smoothed motion is contradicted in the same direction: positions that drift. A wrong
///   sample of a witness touches two, and so contradicts no position. The smoothed motion contains
///   the mean of many positions, and shows drifts of a second that their noise hides in
///   displacements.
/// - Drifts and steps are marked in the parts of spans of 3 and 10 s in which the difference of the
///   two displacements arises. Positions before and after do not belong together, so the arc ends
///   there (ramp).
///
/// Differences are judged by the overall spread of such spans in this recording, so that positions
/// less accurate than stated are not marked for that alone, and over intervals by the spread of the
/// neighbours where it is larger. `test_size` is the false alarm rate of one test.
DisplacementComparison check_displacements(std::vector<ScreenedEpoch>& rows,
                                           const DisplacementTest& test, double nominal_interval_s,
                                           double test_size);

/// Adds what was found to `all`. For a witness tested several times, it keeps the last figures and
/// the total of rejections.
void note(DisplacementComparison found, std::vector<DisplacementComparison>& all);

}  // namespace runcert
