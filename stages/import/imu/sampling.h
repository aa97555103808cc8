#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schemas/imu/declared.h"
#include "stages/import/imu/raw.h"

namespace runcert::imu {

/// Samples with times to rely on, and what their stamps show.
struct Sampling {
    ImuClock clock;                ///< without the offset
    std::vector<bool> gap_before;  ///< of each sample: whether samples are missing before it
    std::int64_t gaps = 0;
    double longest_gap_s = 0.0;  ///< time without samples
    std::size_t first_gap = 0;   ///< the sample behind the first gap
    std::int64_t left_out = 0;   ///< samples whose time is not after that of the one before
    std::int64_t held = 0;       ///< samples that only repeat the one before, taken out
};

/// The mean step (ns) in blocks of samples, of those blocks whose mean is within a tenth of the
/// median block's: gaps do not count in it. 0 for one sample.
double usual_step(const std::vector<RawSample>& samples);

/// The share of samples that do not only repeat all six readings of the one before.
double measured_share(const std::vector<RawSample>& samples);

/// Below it, a sensor is read more often than it measures.
inline constexpr double held_share = 0.9;

/// Puts the times of samples in order.
///
/// Without `rate_hz`: as stamped; samples whose time is not after that of the one before are taken
/// out, and a step of more than one and a half usual steps is a gap. With it: where the file has
/// more samples than that and no more once those are taken out that only repeat all six readings,
/// the logger read the sensor more often than it measured, and these are taken out. Then each
/// stretch without a gap is evenly spaced, by a straight line through its stamps by least squares.
/// There a gap is what moves the stamps by half an interval or more for good: the median of twenty
/// of them on either side of the step tells it from jitter.
///
/// Failure where the stamps contradict `rate_hz` by more than 1 %, go back for good, or are so
/// uneven that they need `rate_hz`.
Sampling settle_times(const Imu& imu, const RecordingBytes& file, RawFile& raw);

}  // namespace runcert::imu
