#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schemas/screened/screened.h"
#include "witness/witness.h"

namespace runcert {

/// A measured position (m) with its standard deviation on each axis.
template <int Axes>
struct TimedPosition {
    double time_s = 0.0;
    PositionVector<Axes> position = PositionVector<Axes>::Zero();
    double sigma_m = 0.0;
    std::int64_t stretch = 0;  ///< positions of different stretches are never compared
};

/// How much displacements by a witness and by positions differ over spans of one length.
struct DisplacementSpread : VelocitySpread {
    double independent = 0.0;      ///< covered time in span lengths
    double along_m = 0.0;          ///< robust standard deviation along the way
    double least_speed_m_s = 0.0;  ///< of the spans compared
};

/// Half of the speed that a tenth of them exceed: a craft that is faster counts as moving fast. 0
/// if there are none.
double half_of_fastest_tenth(std::vector<double> speeds_m_s);

/// The spread over spans of `span_s` in which the craft moved at half the speed of its fastest
/// tenth or more. Empty if these cover less than five span lengths.
template <int Axes>
std::optional<DisplacementSpread> displacement_spread(
    const Witness<Axes>& witness, std::span<const TimedPosition<Axes>> positions, double span_s);

/// The motion by a witness compared with that by positions, over spans of one length.
struct WitnessedMotionComparison {
    std::int64_t spans = 0;  ///< number compared, spread over the recording
    double median_difference_m = 0.0;
    double median_displacement_m = 0.0;  ///< by the positions
    bool contradicts = false;            ///< the typical difference indicates another motion
    /// Whole seconds by which the positions' clock is ahead of the witness's, if shifting by them
    /// makes the two agree. Searched up to a minute where the two contradict each other.
    std::optional<std::int64_t> positions_ahead_s = std::nullopt;
};

/// Compares up to 500 spans. The motions differ where the median difference exceeds all of half a
/// metre, a tenth of the median displacement, and four stated standard deviations of a
/// displacement. At least ten spans are needed for this finding.
WitnessedMotionComparison compare_motion(std::span<const TimedPosition<2>> positions,
                                         const Witness<2>& witness, double span_s);

/// The time span of each position's stretch.
std::vector<TimeSpan> stretches_of(std::span<const TimedPosition<2>> positions);

/// Whether a stretch contains a span (s) and the same a lag later (`SpanTest`).
bool holds(const TimeSpan& stretch, double from_s, double to_s, double lag_s);

/// Parameters of a test of spans.
struct SpanTest {
    double span_s = 0.0;
    double spread_m = 0.0;  ///< by which spans of this length differ in this recording, each axis
    /// Stated standard deviation (m) at which the spread applies. Where positions state more, the
    /// spread grows in proportion. 0: the stated standard deviations are added to the spread.
    double typical_sigma_m = 0.0;
    /// The witness knows the motion by what it recorded this much later (s; negative: earlier). The
    /// stretch must contain that too, so that it is not asked about another one.
    double lag_s = 0.0;
    double least_speed_m_s = 0.0;  ///< slower spans are not tested
    double threshold = 0.0;        ///< on chi-squared with two degrees of freedom
};

/// A span (indices of its first and last position) whose displacement a witness contradicts.
struct ContradictedSpan {
    std::size_t first = 0;
    std::size_t last = 0;
    PositionVector<2> difference_m = PositionVector<2>::Zero();  ///< by positions minus by witness
    double statistic = 0.0;
    /// The part of the span in which the difference arises: from the last position at which at most
    /// a tenth of it is present to the first at which nine tenths are.
    std::size_t core_first = 0;
    std::size_t core_last = 0;
};

/// The spans of one length whose displacements by positions (in order of time) and by the witness
/// differ by more than the test allows. The test includes the spread, what both positions state,
/// and the witness's own covariance.
std::vector<ContradictedSpan> contradicted_spans(std::span<const TimedPosition<2>> positions,
                                                 const Witness<2>& witness, const SpanTest& test);

}  // namespace runcert
