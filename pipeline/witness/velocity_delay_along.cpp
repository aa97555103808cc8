#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.h"
#include "core/uncertainty.h"
#include "witness/velocity_delay.h"

namespace runcert::velocities {
namespace {

using Pairs = std::span<const SpeedPair>;
using JoinedTimes = std::vector<double>;

constexpr std::size_t bins_of_block = 10;
/// A stretch determines no delay with fewer bins, or in less time. For a recording shorter than
/// twice this time, the limit is half of it, but at least a minute.
constexpr std::size_t least_bins = 30;
constexpr double least_s = 120.0;
/// The price of a change of the delay: the spread of the speeds times this many seconds.
constexpr double change_s = 30.0;
/// Least spread of the speeds (m/s, mean), and the largest fraction of it that a delay may leave.
constexpr double least_change_m_s = 0.2;
constexpr double unexplained = 0.3;
constexpr double better_than_within = 0.8;

/// Times (s) with long gaps and backward steps of the clock removed. No delay reaches across
/// either.
JoinedTimes joined_times(Pairs pairs) {
    constexpr double apart_s = 2.0 * delay_range_s;
    JoinedTimes times_s;
    times_s.reserve(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const double step_s = i == 0 ? 0.0 : pairs[i].time_s - pairs[i - 1].time_s;
        const double joined_s = step_s < 0.0 ? apart_s : std::min(step_s, apart_s);
        times_s.push_back(i == 0 ? 0.0 : times_s.back() + joined_s);
    }
    return times_s;
}

double median_step_s(const JoinedTimes& times_s) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < times_s.size(); ++i)
        if (times_s[i] > times_s[i - 1]) steps.push_back(times_s[i] - times_s[i - 1]);
    return steps.empty() ? 0.0 : median(std::move(steps));
}

/// Both speeds averaged in bins of equal length, NaN if there is none.
struct Binned {
    double interval_s = 1.0;  ///< between rows
    double step_s = 1.0;
    std::ptrdiff_t range = 0;  ///< largest delay, in steps
    std::vector<double> by_positions, recorded;
    double spread_m_s = 0.0;  ///< mean absolute difference from their median

    /// The difference in a bin that has both speeds. Where the motion at the delay is unknown, a
    /// fraction of the spread replaces it.
    double difference(std::size_t bin, std::ptrdiff_t delay) const {
        constexpr double unknown = 0.25;
        const auto by = at(bin, delay);
        return by ? std::abs(recorded[bin] - *by) : unknown * spread_m_s;
    }
    bool has_both(std::size_t bin) const {
        return !std::isnan(recorded[bin]) && !std::isnan(by_positions[bin]);
    }
    std::optional<double> at(std::size_t bin, std::ptrdiff_t delay) const {
        const std::ptrdiff_t before = static_cast<std::ptrdiff_t>(bin) - delay;
        if (before < 0 || before >= std::ssize(by_positions)) return std::nullopt;
        const double speed = by_positions[static_cast<std::size_t>(before)];
        return std::isnan(speed) ? std::nullopt : std::optional(speed);
    }
};

/// Ratio of the recorded speeds to those by positions, whatever their delay. Takes the medians of
/// both over equally many of the fastest: those that move at half the speed of nearly the fastest
/// or more.
double scale_of_speeds(Pairs pairs) {
    constexpr double nearly_all = 0.98;  // the rest may be outliers
    std::vector<double> recorded, by_positions;
    for (const SpeedPair& pair : pairs) {
        if (!pair.recorded_m_s || !pair.by_positions_m_s) continue;
        recorded.push_back(*pair.recorded_m_s);
        by_positions.push_back(*pair.by_positions_m_s);
    }
    if (recorded.empty()) return 1.0;
    std::ranges::sort(recorded);
    std::ranges::sort(by_positions);
    const auto last = static_cast<double>(by_positions.size() - 1);
    const double fast_m_s = 0.5 * by_positions[static_cast<std::size_t>(nearly_all * last)];
    const auto slow = std::ranges::lower_bound(by_positions, fast_m_s) - by_positions.begin();
    const std::size_t middle = (static_cast<std::size_t>(slow) + by_positions.size() - 1) / 2;
    const double scale = recorded[middle] / by_positions[middle];
    return scale > 0.0 && std::isfinite(scale) ? scale : 1.0;
}

std::vector<double> means(Pairs pairs, const JoinedTimes& times_s, double step_s,
                          std::optional<double> SpeedPair::*which) {
    std::vector<double> sums(static_cast<std::size_t>(times_s.back() / step_s) + 1, 0.0);
    std::vector<double> counts(sums.size(), 0.0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (!(pairs[i].*which)) continue;
        const auto bin = static_cast<std::size_t>(times_s[i] / step_s);
        sums[bin] += *(pairs[i].*which);
        counts[bin] += 1.0;
    }
    for (std::size_t k = 0; k < sums.size(); ++k)
        sums[k] = counts[k] > 0.0 ? sums[k] / counts[k] : std::nan("");
    return sums;
}

/// The binned speeds. Empty if there is too little to compare.
std::optional<Binned> binned(Pairs pairs, const JoinedTimes& times_s) {
    Binned bins;
    bins.interval_s = median_step_s(times_s);
    if (bins.interval_s <= 0.0) return std::nullopt;
    bins.step_s = std::max(1.0, bins.interval_s);
    bins.range = static_cast<std::ptrdiff_t>(delay_range_s / bins.step_s);
    bins.by_positions = means(pairs, times_s, bins.step_s, &SpeedPair::by_positions_m_s);
    bins.recorded = means(pairs, times_s, bins.step_s, &SpeedPair::recorded_m_s);
    std::vector<double> speeds;
    for (const double speed : bins.by_positions)
        if (!std::isnan(speed)) speeds.push_back(speed);
    if (speeds.size() < least_bins) return std::nullopt;
    const double typical_m_s = median(speeds);
    for (const double speed : speeds)
        bins.spread_m_s += std::abs(speed - typical_m_s) / static_cast<double>(speeds.size());
    return bins;
}

/// The differences in a block of bins, integrated over time (m), at each delay of the range.
std::vector<double> costs_of_block(const Binned& bins, std::size_t first) {
    std::vector<double> costs;
    const std::size_t end = std::min(first + bins_of_block, bins.recorded.size());
    for (std::ptrdiff_t delay = -bins.range; delay <= bins.range; ++delay) {
        double sum_m = 0.0;
        for (std::size_t bin = first; bin < end; ++bin)
            if (!std::isnan(bins.recorded[bin])) sum_m += bins.step_s * bins.difference(bin, delay);
        costs.push_back(sum_m);
    }
    return costs;
}

/// The delay of each block, as a number of steps.
std::vector<std::ptrdiff_t> delays_of_blocks(const Binned& bins) {
    const std::size_t blocks = (bins.recorded.size() + bins_of_block - 1) / bins_of_block;
    const auto states = static_cast<std::size_t>(2 * bins.range + 1);
    const double price_m = change_s * bins.spread_m_s;
    // Favours late over early delays, and small over large ones, where they explain the speeds
    // equally.
    constexpr double late = 0.05, early = 0.5;
    std::vector<double> least(states);
    for (std::size_t s = 0; s < states; ++s) {
        const double delay_s =
            bins.step_s * static_cast<double>(static_cast<std::ptrdiff_t>(s) - bins.range);
        least[s] = bins.spread_m_s * std::max(late * delay_s, -early * delay_s);
    }
    const std::vector<double> preference = least;
    std::vector<std::vector<std::size_t>> before(blocks, std::vector<std::size_t>(states));
    for (std::size_t b = 0; b < blocks; ++b) {
        const std::vector<double> costs = costs_of_block(bins, b * bins_of_block);
        const auto cheapest =
            static_cast<std::size_t>(std::ranges::min_element(least) - least.begin());
        const double changed_m = least[cheapest] + price_m;
        for (std::size_t s = 0; s < states; ++s) {
            const bool change = b > 0 && changed_m + preference[s] < least[s];
            before[b][s] = change ? cheapest : s;
            least[s] = (change ? changed_m + preference[s] : least[s]) + costs[s];
        }
    }
    std::vector<std::ptrdiff_t> delays(blocks);
    auto state = static_cast<std::size_t>(std::ranges::min_element(least) - least.begin());
    for (std::size_t b = blocks; b-- > 0;) {
        delays[b] = static_cast<std::ptrdiff_t>(state) - bins.range;
        state = before[b][state];
    }
    return delays;
}

/// Bins with one delay.
struct Run {
    std::size_t first = 0, end = 0;
    std::ptrdiff_t delay = 0;
};

/// The mean differences of a run, where the motion at its delay is known. Empty if they
/// determine no delay.
std::optional<DelayStretch> stretch_of(const Binned& bins, const Run& run, double limit_s) {
    const auto limit = static_cast<std::ptrdiff_t>(std::ceil(limit_s / bins.step_s));
    std::vector<double> within(static_cast<std::size_t>(2 * limit + 1), 0.0);
    std::vector<double> speeds;
    double sum = 0.0;
    for (std::size_t bin = run.first; bin < run.end; ++bin) {
        if (!bins.has_both(bin) || !bins.at(bin, run.delay)) continue;
        speeds.push_back(bins.recorded[bin]);
        sum += bins.difference(bin, run.delay);
        for (std::ptrdiff_t delay = -limit; delay <= limit; ++delay)
            within[static_cast<std::size_t>(delay + limit)] += bins.difference(bin, delay);
    }
    const double compared_s = bins.step_s * static_cast<double>(speeds.size());
    const double whole_s = bins.step_s * static_cast<double>(bins.recorded.size());
    if (speeds.size() < least_bins ||
        compared_s < std::clamp(0.5 * whole_s, 0.5 * least_s, least_s))
        return std::nullopt;
    const auto count = static_cast<double>(speeds.size());
    const double typical = median(speeds);
    double change = 0.0;
    for (const double speed : speeds)
        change += std::abs(speed - typical) / count;
    DelayStretch stretch;
    stretch.difference_m_s = sum / count;
    stretch.difference_within_m_s = *std::ranges::min_element(within) / count;
    const bool beyond = std::abs(run.delay) > limit;
    if (change < least_change_m_s || stretch.difference_m_s > unexplained * change ||
        (beyond && stretch.difference_m_s > better_than_within * stretch.difference_within_m_s))
        return std::nullopt;
    return stretch;
}

/// Speed by positions, interpolated linearly between rows but not over a gap.
std::optional<double> speed_at(Pairs pairs, const JoinedTimes& times_s, double at_s, double gap_s) {
    const auto after = std::ranges::upper_bound(times_s, at_s);
    if (after == times_s.begin() || after == times_s.end()) return std::nullopt;
    const auto b = static_cast<std::size_t>(after - times_s.begin()), a = b - 1;
    if (!pairs[a].by_positions_m_s || !pairs[b].by_positions_m_s || times_s[b] - times_s[a] > gap_s)
        return std::nullopt;
    const double part = (at_s - times_s[a]) / (times_s[b] - times_s[a]);
    return *pairs[a].by_positions_m_s +
           part * (*pairs[b].by_positions_m_s - *pairs[a].by_positions_m_s);
}

/// Mean square of a stretch's differences at a delay, at a few thousand rows that are evenly
/// spread. Empty if the motion there is unknown.
std::optional<double> mean_square(Pairs pairs, const JoinedTimes& times_s,
                                  const DelayStretch& stretch, double delay_s, double gap_s) {
    constexpr std::size_t enough = 4000;
    const std::size_t stride = 1 + (stretch.last - stretch.first) / enough;
    double sum = 0.0, count = 0.0;
    for (std::size_t i = stretch.first; i <= stretch.last; i += stride) {
        if (!pairs[i].recorded_m_s) continue;
        const auto by = speed_at(pairs, times_s, times_s[i] - delay_s, gap_s);
        if (!by) continue;
        sum += std::pow(*pairs[i].recorded_m_s - *by, 2);
        count += 1.0;
    }
    return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

/// The least-squares delay near that of the bins, from the profile over whole intervals of the
/// recording: between rows, interpolation would lessen the noise. Its standard uncertainty assumes
/// errors that last for two seconds.
void refine(Pairs pairs, const JoinedTimes& times_s, const Binned& bins, double limit_s,
            DelayStretch& stretch) {
    constexpr double lasting_s = 2.0;
    const auto square_at = [&](double delay_s) {
        if (std::abs(delay_s) > delay_range_s) return std::numeric_limits<double>::infinity();
        return mean_square(pairs, times_s, stretch, delay_s, 2.5 * bins.step_s)
            .value_or(std::numeric_limits<double>::infinity());
    };
    const double independent =
        std::max(1.0, (times_s[stretch.last] - times_s[stretch.first]) / lasting_s);
    const auto whole = [&](double delay_s) {
        return bins.interval_s * std::round(delay_s / bins.interval_s);
    };
    const Delay found = delay_of(square_at, whole(stretch.delay_s), bins.step_s + bins.interval_s,
                                 bins.interval_s, independent);
    stretch.delay_s = found.delay_s.value_or(stretch.delay_s);
    // Periodic motion fits one period later as well, by chance perhaps better than at the nearest
    // whole interval. The best delay within the limit, found on a finer grid, must therefore be
    // clearly worse.
    constexpr double clearly = better_than_within * better_than_within;
    constexpr double parts = 8.0;
    double least_within = std::numeric_limits<double>::infinity(), within_s = 0.0;
    for (double delay_s = 0.0; std::abs(stretch.delay_s) > limit_s && delay_s <= limit_s;
         delay_s += std::max(0.05, bins.interval_s / parts))
        for (const double either_s : {delay_s, -delay_s})
            if (const double square = square_at(either_s); square < least_within) {
                least_within = square;
                within_s = either_s;
            }
    if (least_within < std::numeric_limits<double>::infinity() &&
        square_at(whole(stretch.delay_s)) > clearly * least_within) {
        stretch.delay_s = within_s;
        stretch.difference_m_s = stretch.difference_within_m_s;
    }
    stretch.sigma_s = std::hypot(rectangular_uncertainty(0.5 * bins.interval_s),
                                 std::min(found.sigma_s, bins.step_s));
}

}  // namespace

bool DelayStretch::is_beyond(double limit_s) const {
    return std::abs(delay_s) - 2.0 * sigma_s > limit_s;
}

std::vector<DelayStretch> delays_along(Pairs recorded, double limit_s) {
    std::vector<DelayStretch> stretches;
    if (recorded.empty()) return stretches;
    std::vector<SpeedPair> pairs(recorded.begin(), recorded.end());
    const double scale = scale_of_speeds(pairs);
    for (SpeedPair& pair : pairs)
        if (pair.recorded_m_s) *pair.recorded_m_s /= scale;
    const JoinedTimes times_s = joined_times(pairs);
    const auto bins = binned(pairs, times_s);
    if (!bins) return stretches;
    const std::vector<std::ptrdiff_t> delays = delays_of_blocks(*bins);
    for (std::size_t b = 0, end = 0; b < delays.size(); b = end) {
        while (end < delays.size() && delays[end] == delays[b])
            ++end;
        const Run run{.first = b * bins_of_block,
                      .end = std::min(end * bins_of_block, bins->recorded.size()),
                      .delay = delays[b]};
        auto stretch = stretch_of(*bins, run, limit_s);
        if (!stretch) continue;
        const auto row_at = [&](std::size_t bin) {
            return static_cast<std::size_t>(
                std::ranges::lower_bound(times_s, static_cast<double>(bin) * bins->step_s) -
                times_s.begin());
        };
        stretch->first = row_at(run.first);
        stretch->last = row_at(run.end) - 1;
        stretch->delay_s = static_cast<double>(run.delay) * bins->step_s;
        refine(pairs, times_s, *bins, limit_s, *stretch);
        stretches.push_back(*stretch);
    }
    return stretches;
}

}  // namespace runcert::velocities
