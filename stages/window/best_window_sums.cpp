#include "stages/window/best_window_sums.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "witness/window_speed.h"

namespace runcert {
namespace {

bool may_bound(const SampleSeries& series, std::size_t sample) {
    return series.bounds.empty() || series.bounds[sample];
}

/// The place of a value on an increasing scale: a step, and the fraction of it. The first or the
/// last such place where the scale stands still.
struct ScalePoint {
    std::size_t before = 0;
    double fraction = 0.0;
};
template <class Value>
ScalePoint locate_on(const std::vector<Value>& scale, Value value, bool last) {
    const auto at =
        last ? std::ranges::upper_bound(scale, value) : std::ranges::lower_bound(scale, value);
    const auto after = std::clamp<std::ptrdiff_t>(at - scale.begin(), 1, std::ssize(scale) - 1);
    const auto k = static_cast<std::size_t>(after);
    return {k - 1, static_cast<double>(value - scale[k - 1]) /
                       static_cast<double>(scale[k] - scale[k - 1])};
}

double between(const std::vector<double>& values, ScalePoint at) {
    return values[at.before] + at.fraction * (values[at.before + 1] - values[at.before]);
}

/// The instants (ns) at which windows end that begin at `from_ns`, or begin that end there.
class OtherEnds {
  public:
    OtherEnds(const SummedSeries& series, const WindowCriteria& rule)
        : path_m_(series.path_m()), rule_(rule) {
        for (const ElapsedTime time : series.samples->times)
            times_ns_.push_back(time.nanoseconds);
    }

    const std::vector<std::int64_t>& times_ns() const { return times_ns_; }

    std::optional<std::int64_t> of(std::int64_t from_ns, bool later) const {
        const double sign = later ? 1.0 : -1.0;
        if (rule_.kind == WindowKind::time) {
            const auto other_ns = from_ns + std::llround(sign * rule_.duration_s * 1e9);
            if (other_ns < times_ns_.front() || other_ns > times_ns_.back()) return std::nullopt;
            return other_ns;
        }
        const double other_m =
            between(path_m_, locate_on(times_ns_, from_ns, true)) + sign * rule_.distance_m;
        if (other_m < -path_rounding_m || other_m > path_m_.back() + path_rounding_m)
            return std::nullopt;
        const auto [k, fraction] =
            locate_on(path_m_, std::clamp(other_m, 0.0, path_m_.back()), !later);
        return times_ns_[k] +
               std::llround(fraction * static_cast<double>(times_ns_[k + 1] - times_ns_[k]));
    }

  private:
    std::vector<std::int64_t> times_ns_;
    const std::vector<double>& path_m_;
    const WindowCriteria& rule_;
};

}  // namespace

double SpeedSums::speed_m_s(EpochPair window, double duration_s, SpeedDefinition definition) const {
    const auto [first, last] = window;
    if (!is_mean(definition)) return (path_m[last] - path_m[first]) / duration_s;
    const std::size_t before = definition == SpeedDefinition::mean_n ? first + 1 : first;
    return (speeds_m_s[last] - (before > 0 ? speeds_m_s[before - 1] : 0.0)) /
           static_cast<double>(last + 1 - before);
}

bool window_allowed(const SampleSeries& series, std::size_t first, std::size_t last) {
    return may_bound(series, first) && may_bound(series, last) &&
           (series.obstacles.empty() || series.obstacles[first] == series.obstacles[last]);
}

SummedSeries summed(const SampleSeries& series, std::size_t index) {
    assert(series.positions.size() == series.times.size());
    assert(series.speeds_m_s.empty() || series.speeds_m_s.size() == series.times.size());
    assert(series.obstacles.empty() || series.obstacles.size() == series.times.size());
    assert(series.bounds.empty() || series.bounds.size() == series.times.size());
    SummedSeries result{.samples = &series, .index = index};
    std::vector<double>& path_m = result.sums.path_m;
    path_m = series.path_m;
    for (std::size_t k = path_m.size(); k < series.times.size(); ++k)
        path_m.push_back(
            k == 0 ? 0.0 : path_m.back() + (series.positions[k] - series.positions[k - 1]).norm());
    double sum_m_s = 0.0;
    for (const double speed_m_s : series.speeds_m_s)
        result.sums.speeds_m_s.push_back(sum_m_s += speed_m_s);
    return result;
}

SampleSeries with_instants(const SampleSeries& series, const WindowCriteria& rule,
                           const std::vector<ElapsedTime>& instants) {
    if (series.times.size() < 2) return series;
    const SummedSeries sums = summed(series, 0);
    const OtherEnds ends(sums, rule);
    std::vector<std::int64_t> all = ends.times_ns();
    for (const ElapsedTime instant : instants)
        all.push_back(instant.nanoseconds);
    for (std::size_t i = 0, given = all.size(); i < given; ++i)
        for (const bool later : {false, true})
            if (const auto other = ends.of(all[i], later)) all.push_back(*other);
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    SampleSeries dense;
    for (const std::int64_t time_ns : all) {
        const ScalePoint at = locate_on(ends.times_ns(), time_ns, false);
        const std::size_t a = at.before, b = a + 1;
        const std::size_t nearest = at.fraction == 0.0 ? a : b;
        const bool is_sample = at.fraction == 0.0 || at.fraction == 1.0;
        dense.times.push_back({time_ns});
        dense.positions.push_back(
            is_sample ? series.positions[nearest]
                      : Eigen::Vector3d(series.positions[a] +
                                        at.fraction * (series.positions[b] - series.positions[a])));
        dense.path_m.push_back(is_sample ? sums.path_m()[nearest] : between(sums.path_m(), at));
        dense.bounds.push_back(is_sample ? may_bound(series, nearest)
                                         : window_allowed(series, a, b));
        if (!series.obstacles.empty()) dense.obstacles.push_back(series.obstacles[nearest]);
    }
    return dense;
}

std::optional<FoundWindow> window_between(const SummedSeries& series, std::size_t first,
                                          std::size_t last, SpeedDefinition definition) {
    const SampleSeries& samples = *series.samples;
    if (last <= first || !window_allowed(samples, first, last)) return std::nullopt;
    const ElapsedTime from = samples.times[first], to = samples.times[last];
    const double time_s = to.seconds() - from.seconds();
    const double speed_m_s =
        definition == SpeedDefinition::displacement
            ? (samples.positions[last] - samples.positions[first]).norm() / time_s
            : series.sums.speed_m_s({first, last}, time_s, definition);
    return FoundWindow{series.index, first, last, from, to, speed_m_s * time_s, speed_m_s};
}

}  // namespace runcert
