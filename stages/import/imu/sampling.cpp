#include "stages/import/imu/sampling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/statistics.h"
#include "core/text.h"

namespace runcert::imu {
namespace {

constexpr double gap_steps = 1.5;
/// Stamps on either side of a step that tell a gap from jitter.
constexpr std::ptrdiff_t looked_at = 20;
/// Samples whose mean step is one measurement of the rate.
constexpr std::size_t block = 100;
constexpr double rate_tolerance = 0.01;
/// Shorter stretches have the interval of the longest one.
constexpr std::ptrdiff_t fitted_from = 200;
/// Of the samples, or of an interval: beyond, stamps need a nominal rate.
constexpr double uneven_share = 0.05, uneven_jitter = 0.25;

std::string place_of(const RawSample& sample, const RecordingBytes& file) {
    return fmt::format("{}:{}", file.name, sample.line);
}

/// A rate as people write it: four significant digits.
std::string rate_text(double step_ns) {
    return fmt::format("{:.4g}", 1e9 / step_ns);
}

bool repeats(const RawSample& sample, const RawSample& before) {
    return sample.gyro == before.gyro && sample.accelerometer == before.accelerometer;
}

/// The samples without those that only repeat the one before.
std::vector<RawSample> measured(const std::vector<RawSample>& samples) {
    std::vector<RawSample> remaining;
    for (const RawSample& sample : samples)
        if (remaining.empty() || !repeats(sample, remaining.back())) remaining.push_back(sample);
    return remaining;
}

/// A straight line through the stamps of a stretch: the first one's time and the step (ns).
struct EvenTimes {
    double first = 0.0, step = 0.0;
};

/// By least squares where `step` is 0, else through the mean with that step. Times count from that
/// of the stretch's first sample.
EvenTimes even_times(const std::vector<RawSample>& samples, std::ptrdiff_t begin,
                     std::ptrdiff_t end, double step) {
    const auto n = static_cast<double>(end - begin);
    const std::int64_t zero = samples[static_cast<std::size_t>(begin)].time_ns;
    double mean = 0.0, slope = 0.0;
    const double middle = (n - 1.0) / 2.0;
    for (std::ptrdiff_t i = begin; i < end; ++i) {
        const auto time = static_cast<double>(samples[static_cast<std::size_t>(i)].time_ns - zero);
        mean += time / n;
        slope += (static_cast<double>(i - begin) - middle) * time;
    }
    if (step == 0.0) step = slope * 12.0 / (n * (n * n - 1.0));
    return {mean - middle * step, step};
}

/// Evens out the stamps by a nominal interval.
class Evening {
  public:
    Evening(const RecordingBytes& file, double period_ns, std::vector<RawSample>& samples)
        : file_(file), period_(period_ns), samples_(samples) {
        for (std::size_t i = 0; i < samples.size(); ++i)
            residual_.push_back(static_cast<double>(samples[i].time_ns - samples[0].time_ns) -
                                static_cast<double>(i) * period_);
    }

    Sampling settle() {
        const std::vector<std::ptrdiff_t> begins = stretches();
        Sampling made;
        made.gap_before.resize(samples_.size(), false);
        double longest = 0.0, squares = 0.0;
        std::ptrdiff_t longest_size = 0;
        for (std::size_t k = 0; k + 1 < begins.size(); ++k)
            if (begins[k + 1] - begins[k] > longest_size) {
                longest_size = begins[k + 1] - begins[k];
                longest = longest_size < fitted_from
                              ? period_
                              : even_times(samples_, begins[k], begins[k + 1], 0.0).step;
            }
        if (!is_near(longest)) longest = period_;
        for (std::size_t k = 0; k + 1 < begins.size(); ++k) {
            const std::ptrdiff_t begin = begins[k], end = begins[k + 1];
            const std::int64_t zero = at(begin).time_ns;
            EvenTimes even =
                even_times(samples_, begin, end, end - begin < fitted_from ? longest : 0.0);
            if (!is_near(even.step)) even = even_times(samples_, begin, end, longest);
            // Where stamps jitter by more than the gap, the stretches must not overlap.
            if (begin > 0)
                even.first = std::max(even.first,
                                      static_cast<double>(at(begin - 1).time_ns - zero) + period_);
            for (std::ptrdiff_t i = begin; i < end; ++i) {
                const double time = even.first + even.step * static_cast<double>(i - begin);
                const double off = static_cast<double>(at(i).time_ns - zero) - time;
                squares += off * off;
                at(i).time_ns = zero + std::llround(time);
            }
            if (begin == 0) continue;
            const double missing_s =
                (static_cast<double>(at(begin).time_ns - at(begin - 1).time_ns) - period_) * 1e-9;
            made.gap_before[static_cast<std::size_t>(begin)] = true;
            if (made.gaps++ == 0) made.first_gap = static_cast<std::size_t>(begin);
            made.longest_gap_s = std::max(made.longest_gap_s, missing_s);
        }
        made.clock = {.times = ImuTimes::even,
                      .samples = {},
                      .interval_s = longest * 1e-9,
                      .rate_hz = 1e9 / longest,
                      .jitter_s = std::sqrt(squares / static_cast<double>(samples_.size())) * 1e-9,
                      .drift = longest / period_ - 1.0,
                      .offset_s = 0.0};
        return made;
    }

  private:
    /// Whether a fitted step can be that of the nominal rate.
    bool is_near(double step) const { return std::abs(step / period_ - 1.0) < 0.1; }
    RawSample& at(std::ptrdiff_t i) { return samples_[static_cast<std::size_t>(i)]; }
    double step(std::ptrdiff_t i) const {
        return residual_[static_cast<std::size_t>(i)] - residual_[static_cast<std::size_t>(i - 1)] +
               period_;
    }
    double median_of(std::ptrdiff_t begin, std::ptrdiff_t end) const {
        return median({residual_.begin() + begin, residual_.begin() + end});
    }

    /// Where the stretches begin, and the end of the last.
    std::vector<std::ptrdiff_t> stretches() {
        const std::ptrdiff_t n = std::ssize(residual_);
        std::vector<std::ptrdiff_t> begins{0};
        for (std::ptrdiff_t i = 1; i < n; ++i) {
            if (step(i) < gap_steps * period_ && step(i) > -gap_steps * period_) continue;
            const std::ptrdiff_t end = std::min(i + looked_at, n);
            bool is_largest = true;
            for (std::ptrdiff_t k = i + 1; k < end; ++k)
                is_largest = is_largest && std::abs(step(k)) <= std::abs(step(i));
            if (!is_largest) continue;  // that step is looked at in its turn
            const double shift_ns =
                median_of(i, end) - median_of(std::max(begins.back(), i - looked_at), i);
            if (shift_ns < -period_ / 2.0)
                throw Failure(
                    place_of(at(i), file_),
                    fmt::format("the time goes back by {} s", format_fixed(-shift_ns * 1e-9, 3)),
                    "Hand in each session in a file of its own: the clock was set, or two "
                    "files were put together");
            if (shift_ns > period_ / 2.0) begins.push_back(i);
        }
        begins.push_back(n);
        return begins;
    }

    const RecordingBytes& file_;
    double period_;
    std::vector<RawSample>& samples_;
    std::vector<double> residual_;  ///< of each stamp from an even one (ns)
};

[[noreturn]] void ask_for_rate(const RawSample& first, const RecordingBytes& file, double step_ns,
                               const std::string& what) {
    throw Failure(place_of(first, file), what,
                  fmt::format("Write rate_hz: {}, the mean rate of the stamps, in imu: the samples "
                              "are then evenly spaced",
                              rate_text(step_ns)));
}

Sampling as_stamped(const RecordingBytes& file, std::vector<RawSample>& samples) {
    const double usual = usual_step(samples);
    Sampling made;
    std::vector<RawSample> remaining;
    for (const RawSample& sample : samples)
        if (remaining.empty() || sample.time_ns > remaining.back().time_ns)
            remaining.push_back(sample);
        else
            ++made.left_out;
    if (static_cast<double>(made.left_out) > uneven_share * static_cast<double>(samples.size()))
        ask_for_rate(samples.front(), file, std::max(usual, 1.0),
                     fmt::format("{} of {} samples have a time that is not after that of the one "
                                 "before",
                                 made.left_out, samples.size()));
    samples = std::move(remaining);
    const double step = samples.size() > 1 ? usual_step(samples) : 1e9;
    std::vector<double> steps;
    for (std::size_t i = 1; i < samples.size(); ++i)
        steps.push_back(static_cast<double>(samples[i].time_ns - samples[i - 1].time_ns));
    double squares = 0.0, counted = 0.0;
    made.gap_before.resize(samples.size(), false);
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (steps[i] < gap_steps * step) {
            squares += (steps[i] - step) * (steps[i] - step);
            counted += 1.0;
            continue;
        }
        made.gap_before[i + 1] = true;
        if (made.gaps++ == 0) made.first_gap = i + 1;
        made.longest_gap_s = std::max(made.longest_gap_s, (steps[i] - step) * 1e-9);
    }
    // The difference of two stamps has twice the variance of one.
    const double jitter = counted > 0.0 ? std::sqrt(squares / counted / 2.0) : 0.0;
    if (jitter > uneven_jitter * step ||
        static_cast<double>(made.gaps) > uneven_share * static_cast<double>(samples.size()))
        ask_for_rate(samples.front(), file, usual,
                     fmt::format("the stamps of the samples are uneven: they jitter by {} ms, and "
                                 "{} of {} steps are longer than one and a half",
                                 format_fixed(jitter * 1e-6, 2), made.gaps, steps.size()));
    made.clock = {.times = ImuTimes::stamps,
                  .samples = {},
                  .interval_s = step * 1e-9,
                  .rate_hz = 1e9 / step,
                  .jitter_s = jitter * 1e-9,
                  .drift = 0.0,
                  .offset_s = 0.0};
    return made;
}

Sampling counted(double period_ns, std::vector<RawSample>& samples) {
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i].time_ns = std::llround(static_cast<double>(i) * period_ns);
    Sampling made;
    made.gap_before.resize(samples.size(), false);
    made.clock = {.times = ImuTimes::counted,
                  .samples = {},
                  .interval_s = period_ns * 1e-9,
                  .rate_hz = 1e9 / period_ns,
                  .jitter_s = 0.0,
                  .drift = 0.0,
                  .offset_s = 0.0};
    return made;
}

bool has_rate(const std::vector<RawSample>& samples, double period_ns) {
    return samples.size() <= block ||
           std::abs(period_ns / usual_step(samples) - 1.0) <= rate_tolerance;
}

/// The rate that the attempt states is that of the stamps, or of what the sensor measured between
/// them. Returns how many samples were taken out for the latter.
std::int64_t settle_rate(const Imu& imu, const RecordingBytes& file, RawFile& raw) {
    const double period = 1e9 / *imu.rate_hz;
    if (has_rate(raw.samples, period)) return 0;
    std::vector<RawSample> remaining = measured(raw.samples);
    if (remaining.size() > block && has_rate(remaining, period)) {
        const std::int64_t held = std::ssize(raw.samples) - std::ssize(remaining);
        raw.samples = std::move(remaining);
        return held;
    }
    const double step = usual_step(raw.samples);
    throw Failure(place_of(raw.samples.front(), file),
                  step > 0.0
                      ? fmt::format("the stamps show {} samples a second, and rate_hz says {}",
                                    rate_text(step), rate_text(period))
                      : "the time of the samples does not go on",
                  "Correct rate_hz, time_unit or the column of the time in imu");
}

}  // namespace

double usual_step(const std::vector<RawSample>& samples) {
    const std::size_t length = std::min(block, samples.size() - 1);
    if (length == 0) return 0.0;
    std::vector<double> steps;
    for (std::size_t i = length; i < samples.size(); i += length)
        steps.push_back(static_cast<double>(samples[i].time_ns - samples[i - length].time_ns) /
                        static_cast<double>(length));
    const double middle = median(steps);
    double sum = 0.0, count = 0.0;
    for (const double step : steps)
        if (std::abs(step - middle) <= 0.1 * std::abs(middle)) sum += step, count += 1.0;
    return sum / count;
}

double measured_share(const std::vector<RawSample>& samples) {
    return static_cast<double>(measured(samples).size()) / static_cast<double>(samples.size());
}

Sampling settle_times(const Imu& imu, const RecordingBytes& file, RawFile& raw) {
    Sampling made;
    if (raw.stamps == Stamps::none) {
        made = counted(1e9 / *imu.rate_hz, raw.samples);
    } else if (imu.rate_hz) {
        const std::int64_t held = settle_rate(imu, file, raw);
        made = Evening(file, 1e9 / *imu.rate_hz, raw.samples).settle();
        made.held = held;
    } else {
        made = as_stamped(file, raw.samples);
    }
    made.clock.samples = to_text(imu.samples);
    const auto note = [&](std::string text) { raw.notes.push_back(std::move(text)); };
    if (made.left_out > 0)
        note(
            fmt::format("{} samples were left out: their time is not after that of the one before.",
                        made.left_out));
    if (made.held > 0)
        note(
            fmt::format("{} samples that only repeat the one before were taken out: the sensor was "
                        "read more often than it measured.",
                        made.held));
    if (made.gaps > 0)
        note(fmt::format("{} gaps in the IMU's samples, the longest of {} s; the first before {}.",
                         made.gaps, format_fixed(made.longest_gap_s, 3),
                         place_of(raw.samples[made.first_gap], file)));
    constexpr double drift_noted = 1e-3;
    if (std::abs(made.clock.drift) > drift_noted)
        note(
            fmt::format("The clock of the IMU's stamps drifts against its sampling: they show {} "
                        "samples a second where rate_hz says {}.",
                        format_fixed(made.clock.rate_hz, 4), format_fixed(*imu.rate_hz, 4)));
    const double share = measured_share(raw.samples);
    if (made.clock.times == ImuTimes::stamps && share < held_share)
        note(
            fmt::format("The sensor was read more often than it measured; with rate_hz: {} each "
                        "measurement counts once.",
                        rate_text(1e9 / (made.clock.rate_hz * share))));
    constexpr double jitter_noted = 0.02;
    if (made.clock.times == ImuTimes::stamps &&
        made.clock.jitter_s > jitter_noted * made.clock.interval_s)
        note(
            fmt::format("The stamps jitter by {} ms; with rate_hz: {} the samples are evenly "
                        "spaced.",
                        format_fixed(made.clock.jitter_s * 1e3, 2),
                        rate_text(1e9 / std::max(made.clock.rate_hz, 1e-9))));
    return made;
}

}  // namespace runcert::imu
