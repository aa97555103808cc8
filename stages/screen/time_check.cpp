#include "stages/screen/time_check.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

#include "core/statistics.h"
#include "schemas/enu/measured_position.h"
#include "witness/continuity.h"

namespace runcert {
namespace {

constexpr std::size_t faults_kept = 1000;
constexpr double largest_clock_error = 2e-2;
constexpr double time_coverage = 5.0;
constexpr double stamp_rounding_s = 1e-3;

double step_before(const std::vector<EnuEpoch>& rows, std::size_t row) {
    return seconds_between(rows[row - 1], rows[row]);
}

/// The step pattern of a clock without faults.
struct Rhythm {
    double nominal_s = 0.0;
    double longest_s = 0.0;  ///< a longer step is a gap
    double mean_s = 0.0;
    double sd_s = 0.0;
    bool is_regular(double step_s) const { return step_s > 0.0 && step_s <= longest_s; }
};

double median_forward_step(const std::vector<EnuEpoch>& rows) {
    std::vector<double> forward;
    for (std::size_t row = 1; row < rows.size(); ++row)
        if (const double step_s = step_before(rows, row); step_s > 0.0) forward.push_back(step_s);
    return forward.empty() ? 0.0 : median(std::move(forward));
}

Rhythm find_rhythm(const std::vector<EnuEpoch>& rows, const TimeCheckOptions& options) {
    Rhythm rhythm;
    rhythm.nominal_s =
        options.nominal_interval_s > 0.0 ? options.nominal_interval_s : median_forward_step(rows);
    rhythm.longest_s = options.gap_factor * rhythm.nominal_s;
    rhythm.mean_s = rhythm.nominal_s;
    std::vector<double> regular;
    std::int64_t total_ns = 0;
    for (std::size_t row = 1; row < rows.size(); ++row) {
        const double step_s = step_before(rows, row);
        if (!rhythm.is_regular(step_s)) continue;
        regular.push_back(step_s);
        total_ns += rows[row].time.nanoseconds - rows[row - 1].time.nanoseconds;
    }
    if (regular.empty()) return rhythm;
    rhythm.mean_s = static_cast<double>(total_ns) * 1e-9 / static_cast<double>(regular.size());
    if (regular.size() > 1) rhythm.sd_s = standard_deviation(regular);
    return rhythm;
}

/// The interval that the receiver was set to.
double set_interval(const Rhythm& rhythm) {
    const double mean_s = rhythm.mean_s;
    const bool in_hertz = mean_s < 1.0;
    const double whole =
        std::clamp(std::round(in_hertz ? 1.0 / mean_s : mean_s), 1.0, in_hertz ? 100.0 : 10.0);
    const double offered_s = in_hertz ? 1.0 / whole : whole;
    // The next interval that receivers offer is 1 / whole away. In between, the set interval is
    // undetermined.
    const double tolerance = std::min(largest_clock_error, 0.25 / whole);
    return std::abs(mean_s / offered_s - 1.0) <= tolerance ? offered_s : rhythm.nominal_s;
}

/// Rates in common use on receivers, Hz.
constexpr std::array usual_rates_hz{1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 12,
                                    15, 16, 18, 20, 25, 30, 40, 50, 60, 100};

/// The nearest interval in common use: of those rates, also in whole milliseconds from 100 ms on
/// (333 ms), or whole seconds.
double usual_interval(double mean_s) {
    if (mean_s > 1.25) return std::round(mean_s);
    double nearest_s = 1.0;
    const auto offer = [&](double interval_s) {
        if (std::abs(mean_s - interval_s) < std::abs(mean_s - nearest_s)) nearest_s = interval_s;
    };
    for (const int rate_hz : usual_rates_hz) {
        offer(1.0 / rate_hz);
        if (rate_hz < 10) offer(std::round(1e3 / rate_hz) * 1e-3);
    }
    return nearest_s;
}

/// How far consecutive steps lead away from an interval, to one side.
class Departure {
  public:
    /// Adds the next step, which exceeds the interval to that side by `excess_s` (s).
    void add(double excess_s, double step_s) {
        const double tolerance_s = rate_tolerance * step_s;
        sum_s_ += excess_s - tolerance_s;
        steps_ += excess_s > tolerance_s ? 1 : excess_s < -tolerance_s ? -1 : 0;
        if (sum_s_ <= 0.0) *this = {};
    }
    /// Zero where single stamps are off and return after a few, which is no rate.
    double found_s() const {
        return steps_ >= steps_of_a_rate || sum_s_ > most_of_stamps_s ? sum_s_ : 0.0;
    }

  private:
    static constexpr double rate_tolerance = 1e-4;
    static constexpr int steps_of_a_rate = 5;  ///< steps to one side minus those to the other
    static constexpr double most_of_stamps_s = 0.02;
    double sum_s_ = 0.0;
    int steps_ = 0;
};

double largest_departure(const std::vector<EnuEpoch>& rows, const Rhythm& rhythm,
                         double interval_s) {
    Departure late, early;
    double largest_s = 0.0;
    for (std::size_t row = 1; row < rows.size(); ++row) {
        const double step_s = step_before(rows, row);
        if (rhythm.is_regular(step_s)) {
            late.add(step_s - interval_s, step_s);
            early.add(interval_s - step_s, step_s);
            largest_s = std::max({largest_s, late.found_s(), early.found_s()});
        } else {
            late = early = {};
        }
    }
    return largest_s;
}

/// A step that is not regular.
struct Jump {
    std::size_t row = 0;  ///< the later one
    double step_s = 0.0;
    double advance_s = 0.0;  ///< beyond the latest earlier stamp, or the step itself if negative
    bool for_good = true;    ///< for a backward step: never caught up with
};

/// A stamp before a backward step, as long as no later stamp has reached it.
struct Ahead {
    std::size_t row = 0;
    std::size_t jump = 0;
};

std::vector<Jump> find_jumps(const std::vector<EnuEpoch>& rows, double longest_s,
                             double session_gap_s) {
    std::vector<Jump> jumps;
    std::vector<Ahead> ahead;  // in descending order, the earliest stamp last
    for (std::size_t row = 1; row < rows.size(); ++row) {
        const double step_s = step_before(rows, row);
        if (step_s < 0.0) ahead.push_back({row - 1, jumps.size()});
        double advance_s = step_s;
        std::size_t still_ahead = ahead.size();
        while (still_ahead > 0 && rows[row].time >= rows[ahead[still_ahead - 1].row].time)
            advance_s = seconds_between(rows[ahead[--still_ahead].row], rows[row]);
        // If a session ends before its clock has caught up, the clock was set back for good.
        if (advance_s <= session_gap_s)
            for (std::size_t caught = still_ahead; caught < ahead.size(); ++caught)
                jumps[ahead[caught].jump].for_good = false;
        ahead.resize(still_ahead);
        if (step_s <= 0.0 || advance_s > longest_s) jumps.push_back({row, step_s, advance_s});
    }
    return jumps;
}

bool is_located(const EnuEpoch& row) {
    return row.fix != FixType::none && row.east_m && row.north_m && row.sigma_east_m &&
           row.sigma_north_m;
}

/// The positions on both sides of a step.
struct Sides {
    Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  ///< m, over the step
    Eigen::Vector2d before = Eigen::Vector2d::Zero();        ///< velocity, m/s
    Eigen::Vector2d after = Eigen::Vector2d::Zero();
    double sigma_m = 0.0;  ///< of displacement minus mean velocity times interval, in any direction
    double sigma_velocity_m_s = 0.0;  ///< of either velocity
};

std::optional<Sides> sides_of(const std::vector<EnuEpoch>& rows, std::size_t row,
                              const Rhythm& rhythm) {
    if (row < 3 || row + 2 >= rows.size()) return std::nullopt;
    for (const std::size_t later : {row - 2, row - 1, row + 1, row + 2})
        if (!rhythm.is_regular(step_before(rows, later))) return std::nullopt;
    for (const std::size_t used : {row - 3, row - 1, row, row + 2})
        if (!is_located(rows[used])) return std::nullopt;
    const auto position = [&](std::size_t k) { return measured_position<2>(rows[k]); };
    const auto variance = [&](std::size_t k) {
        return std::pow(*rows[k].sigma_east_m, 2) + std::pow(*rows[k].sigma_north_m, 2);
    };
    const double two_steps_s = 2.0 * rhythm.mean_s;
    Sides sides;
    sides.displacement = position(row) - position(row - 1);
    sides.before = (position(row - 1) - position(row - 3)) / two_steps_s;
    sides.after = (position(row + 2) - position(row)) / two_steps_s;
    // Each velocity contributes half an interval, so each outer position contributes a quarter.
    const double inner = variance(row - 1) + variance(row);
    const double outer = variance(row - 3) + variance(row + 2);
    sides.sigma_m = std::sqrt(1.25 * 1.25 * inner + 0.25 * 0.25 * outer);
    sides.sigma_velocity_m_s = std::sqrt(std::max(variance(row - 3) + variance(row - 1),
                                                  variance(row) + variance(row + 2))) /
                               two_steps_s;
    return sides;
}

/// Whether the craft moved over the step as in one interval, and certainly not as in the stamped
/// time.
bool moved_as_in_one_interval(const Sides& sides, double step_s, double interval_s) {
    const double allowed_m =
        time_coverage * sides.sigma_m + craft_acceleration_m_s2 * interval_s * interval_s / 2.0;
    const Eigen::Vector2d expected = (sides.before + sides.after) / 2.0 * interval_s;
    const double sure_speed_m_s = std::min(sides.before.norm(), sides.after.norm()) -
                                  time_coverage * sides.sigma_velocity_m_s;
    if (sure_speed_m_s <= 0.0) return false;
    if (least_displacement_m(sure_speed_m_s, step_s) <= expected.norm() + 2.0 * allowed_m)
        return false;
    const double change_m_s = (sides.after - sides.before).norm();
    if (change_m_s > 3.0 * craft_acceleration_m_s2 * interval_s +
                         time_coverage * std::sqrt(2.0) * sides.sigma_velocity_m_s)
        return false;
    return (sides.displacement - expected).norm() <= allowed_m;
}

/// The clock's jump in whole seconds, if it was the clock that jumped.
std::optional<double> clock_shift(const std::vector<EnuEpoch>& rows, const Jump& jump,
                                  const Rhythm& rhythm) {
    const double size_s = jump.step_s - rhythm.mean_s;
    const double whole_s = std::round(size_s);
    const double tolerance_s =
        std::min(std::max(time_coverage * rhythm.sd_s, stamp_rounding_s), rhythm.mean_s / 4.0);
    if (whole_s == 0.0 || std::abs(size_s - whole_s) > tolerance_s) return std::nullopt;
    const std::optional<Sides> sides = sides_of(rows, jump.row, rhythm);
    if (!sides || !moved_as_in_one_interval(*sides, jump.step_s, rhythm.mean_s))
        return std::nullopt;
    return whole_s;
}

/// Whether the step leads to a single stamp that is out of time, or back from it.
bool is_of_one_stamp(const std::vector<EnuEpoch>& rows, std::size_t row, const Rhythm& rhythm) {
    const auto in_time = [&](std::size_t earlier, std::size_t later) {
        const double time_s = seconds_between(rows[earlier], rows[later]);
        return time_s > 0.0 && time_s <= rhythm.longest_s + rhythm.nominal_s;
    };
    return (row + 1 < rows.size() && in_time(row - 1, row + 1)) ||
           (row >= 2 && in_time(row - 2, row));
}

bool begins_session(const std::vector<EnuEpoch>& rows, const Jump& jump, const Rhythm& rhythm,
                    double session_gap_s) {
    const bool far = jump.step_s > 0.0 ? jump.advance_s > session_gap_s
                                       : jump.for_good && -jump.step_s > session_gap_s;
    return far && !is_of_one_stamp(rows, jump.row, rhythm);
}

TimeFault fault_of(const std::vector<EnuEpoch>& rows, const Jump& jump, const Rhythm& rhythm,
                   const TimeCheckOptions& options) {
    const std::int64_t epoch = rows[jump.row].epoch;
    if (jump.step_s == 0.0) return {epoch, TimeFaultKind::duplicate, 0.0};
    if (const auto shift_s = clock_shift(rows, jump, rhythm))
        return {epoch, TimeFaultKind::whole_second_shift, *shift_s};
    const double size_s = jump.advance_s - rhythm.mean_s;
    if (begins_session(rows, jump, rhythm, options.session_gap_s))
        return {epoch, TimeFaultKind::session, size_s};
    return {epoch, jump.step_s < 0.0 ? TimeFaultKind::backward : TimeFaultKind::gap, size_s};
}

}  // namespace

TimeStampSummary examine_time(const std::vector<EnuEpoch>& rows, const TimeCheckOptions& options) {
    TimeStampSummary summary;
    const Rhythm rhythm = find_rhythm(rows, options);
    if (rhythm.mean_s > 0.0) summary.rate_deviation = rhythm.mean_s / set_interval(rhythm) - 1.0;
    summary.jitter_s = rhythm.sd_s;
    if (rhythm.mean_s > 0.0) {
        summary.interval_s = rhythm.mean_s;
        summary.usual_interval_s = usual_interval(rhythm.mean_s);
        summary.departure_s = largest_departure(rows, rhythm, *summary.usual_interval_s);
    }
    for (const Jump& jump : find_jumps(rows, rhythm.longest_s, options.session_gap_s)) {
        if (jump.step_s == 0.0)
            ++summary.duplicates;
        else if (jump.step_s < 0.0)
            ++summary.backward;
        else {
            ++summary.gaps;
            summary.longest_gap_s = std::max(summary.longest_gap_s, jump.advance_s);
        }
        TimeFault fault = fault_of(rows, jump, rhythm, options);
        if (fault.kind == TimeFaultKind::session) ++summary.sessions;
        if (summary.faults.size() < faults_kept) summary.faults.push_back(std::move(fault));
    }
    return summary;
}

}  // namespace runcert
