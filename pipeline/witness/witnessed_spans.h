#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "witness/witness.h"

namespace runcert {

/// A measured position (m) with its standard deviation of each axis.
template <int Axes>
struct TimedPosition {
    double time_s = 0.0;
    PositionVector<Axes> position = PositionVector<Axes>::Zero();
    double sigma_m = 0.0;
    std::int64_t stretch = 0;  ///< those of different ones are never compared
};

/// How displacements by a witness and by positions differ over spans of one length.
struct DisplacementSpread {
    double span_s = 0.0;
    std::int64_t spans = 0;        ///< compared; they overlap
    double independent = 0.0;      ///< so many lengths of span are covered
    double sd_m = 0.0;             ///< robust standard deviation, each axis
    double sd_upper_m = 0.0;       ///< not exceeded with a probability of 95 %, for normal errors
    double least_speed_m_s = 0.0;  ///< of the spans that were compared
};

/// The spread over spans of `span_s`, of those during which the craft moved at half the speed of
/// its fastest tenth or more; nothing where these cover less than five times the length.
template <int Axes>
std::optional<DisplacementSpread> displacement_spread(
    const Witness<Axes>& witness, std::span<const TimedPosition<Axes>> positions, double span_s);

/// The motion by a witness beside that of the positions, over spans of one length.
struct WitnessedMotionComparison {
    std::int64_t spans = 0;  ///< compared, spread over the recording
    double median_difference_m = 0.0;
    double median_displacement_m = 0.0;  ///< by the positions
    bool contradicts = false;            ///< the typical difference is another motion's
    /// By so many whole seconds the positions' clock is ahead of the witness's: shifted by this the
    /// two agree. Looked for up to a minute where the two contradict one another.
    std::optional<std::int64_t> positions_ahead_s = std::nullopt;
};

/// Compares up to 500 spans. A motion is another where the median difference exceeds half a metre,
/// a tenth of the median displacement, and four standard deviations of a displacement as stated;
/// fewer than ten spans are not enough to say so.
WitnessedMotionComparison compare_motion(std::span<const TimedPosition<2>> positions,
                                         const Witness<2>& witness, double span_s);

/// How spans are tested.
struct SpanTest {
    double span_s = 0.0;
    double spread_m = 0.0;  ///< by which such spans differ in this recording, each axis
    /// What such spans differ by at positions that state this standard deviation (m); those that
    /// state more may differ by as many times more. 0: what is stated counts beside the spread.
    double typical_sigma_m = 0.0;
    double lasting_m_s = 0.0;  ///< an error that lasts, too small to be a drift of the positions
    /// The arc must go on for so long beyond the span: what a witness is asked for there must not
    /// be of another arc.
    double ahead_s = 0.0;
    double least_speed_m_s = 0.0;  ///< slower spans are not tested
    double threshold = 0.0;        ///< of chi-squared with two degrees of freedom
};

/// A span (places of its first and last position) whose displacement a witness contradicts.
struct ContradictedSpan {
    std::size_t first = 0;
    std::size_t last = 0;
    PositionVector<2> difference_m = PositionVector<2>::Zero();  ///< by positions less by witness
    double statistic = 0.0;
    /// The part of it in which the difference comes about: from the last position before at which a
    /// tenth of it is there to the first at which nine tenths are.
    std::size_t core_first = 0;
    std::size_t core_last = 0;
};

/// The spans of one length whose displacement by positions (in order of time) and by the witness
/// differ by more than the test allows: the spread, what both positions state, and the witness's
/// own covariance.
std::vector<ContradictedSpan> contradicted_spans(std::span<const TimedPosition<2>> positions,
                                                 const Witness<2>& witness, const SpanTest& test);

}  // namespace runcert
