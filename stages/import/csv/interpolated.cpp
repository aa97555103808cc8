#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/statistics.h"
#include "stages/import/csv/csv.h"
#include "stages/import/inspect.h"

namespace runcert::csv {
namespace {

/// Of an interval of the fixes, by which a row may be off its multiple.
constexpr double share_of_interval = 0.125;

/// From fewer steps between fixes their interval is not known.
constexpr std::size_t steps_to_judge = 10;

/// What a row shows of a quantity, and by how much arithmetic in decimals may have rounded it.
struct Shown {
    std::optional<double> value;
    double step = 0.0;
};

/// Heights and speeds are interpolated to more decimals than these.
constexpr double height_step_m = 0.05, speed_step_m_s = 0.001;

double step_of(std::string_view text) {
    const std::size_t point = text.find('.');
    std::size_t decimals = point == std::string_view::npos ? 0 : text.size() - point - 1;
    double step = 1.0;
    for (; decimals > 0; --decimals)
        step *= 0.1;
    return step;
}

using ShownRow = std::array<Shown, 4>;

ShownRow shown(const TimedRow& row) {
    const Observation& seen = row.observation;
    std::optional<double> speed;
    if (const auto found = horizontal_speed(seen)) speed = *found;
    std::optional<double> height;
    if (seen.height_m) height = *seen.height_m;
    return {{{*seen.latitude_deg, step_of(row.written.coordinates[0])},
             {*seen.longitude_deg, step_of(row.written.coordinates[1])},
             {height, height_step_m},
             {speed, speed_step_m_s}}};
}

double seconds_between(const PlacedRow& from, const PlacedRow& to) {
    return static_cast<double>(to.row.instant.nanoseconds() - from.row.instant.nanoseconds()) *
           1e-9;
}

/// Whether the second of three rows lies between the others; from them what they show, and the
/// steps between them (s).
bool is_linear(const ShownRow& a, const ShownRow& b, const ShownRow& c, double first_s,
               double second_s) {
    if (first_s <= 0.0 || second_s <= 0.0) return false;
    const double weight = first_s / (first_s + second_s);
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!a[i].value || !b[i].value || !c[i].value) continue;
        const double step = std::min({a[i].step, b[i].step, c[i].step});
        const double between = (1.0 - weight) * *a[i].value + weight * *c[i].value;
        if (std::abs(*b[i].value - between) > 1.01 * step) return false;
    }
    return true;
}

std::vector<bool> linear_rows(const std::vector<PlacedRow>& rows) {
    std::vector<bool> linear(rows.size(), false);
    if (rows.size() < 3) return linear;
    ShownRow a = shown(rows[0].row), b = shown(rows[1].row);
    for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
        const ShownRow c = shown(rows[i + 1].row);
        linear[i] = is_linear(a, b, c, seconds_between(rows[i - 1], rows[i]),
                              seconds_between(rows[i], rows[i + 1]));
        a = b;
        b = c;
    }
    return linear;
}

/// The median step between rows that were surely measured; 0 where too few were.
double interval_of_fixes_s(const std::vector<PlacedRow>& rows, const std::vector<bool>& linear) {
    std::vector<double> steps_s;
    const PlacedRow* before = nullptr;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (linear[i]) continue;
        if (before && seconds_between(*before, rows[i]) > 0.0)
            steps_s.push_back(seconds_between(*before, rows[i]));
        before = &rows[i];
    }
    return steps_s.size() < steps_to_judge ? 0.0 : median(std::move(steps_s));
}

}  // namespace

std::size_t remove_interpolated(std::vector<PlacedRow>& rows) {
    const std::vector<bool> linear = linear_rows(rows);
    const double interval_s = interval_of_fixes_s(rows, linear);
    if (interval_s <= 0.0) return 0;
    std::size_t remaining = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (linear[i]) {
            const double intervals = seconds_between(rows[remaining - 1], rows[i]) / interval_s;
            if (intervals < 0.5 || std::abs(intervals - std::round(intervals)) > share_of_interval)
                continue;
        }
        if (remaining != i) rows[remaining] = std::move(rows[i]);
        ++remaining;
    }
    const std::size_t taken = rows.size() - remaining;
    rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(remaining), rows.end());
    return taken;
}

}  // namespace runcert::csv
