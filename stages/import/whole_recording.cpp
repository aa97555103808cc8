#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text.h"
#include "stages/import/row_collector.h"

// What the rows of any format show as a whole, and no row alone.

namespace runcert {

bool put_in_order(std::vector<Observation>& rows, std::vector<BadRecord>& bad) {
    std::size_t forward = 0, backward = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        forward += rows[i].time > rows[i - 1].time ? 1 : 0;
        backward += rows[i].time < rows[i - 1].time ? 1 : 0;
    }
    constexpr std::size_t least = 2;
    if (backward < least || 20 * forward > backward) return false;
    std::ranges::reverse(rows);
    const std::int64_t count = std::ssize(rows);
    for (std::size_t i = 0; i < rows.size(); ++i)
        rows[i].epoch = static_cast<std::int64_t>(i) + 1;
    for (BadRecord& each : bad)
        each.epoch = std::clamp<std::int64_t>(count - each.epoch, 0, count);
    return true;
}

void fill_heights(Observations& observations) {
    std::vector<Observation>& rows = observations.rows;
    constexpr double longest_s = 2.5, longest_held_s = 1.1, steepest_m_s = 3.0;
    const auto needs = [](const Observation& row) { return row.latitude_deg && !row.height_m; };
    if (std::ranges::none_of(rows, needs)) return;
    std::size_t filled = 0;
    std::vector<std::size_t> known;
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i].height_m) known.push_back(i);
    const auto seconds = [&](std::size_t from, std::size_t to) {
        return rows[to].time.seconds() - rows[from].time.seconds();
    };
    for (std::size_t i = 0, next = 0; i < rows.size(); ++i) {
        while (next < known.size() && known[next] < i)
            ++next;
        if (!needs(rows[i])) continue;
        const bool after = next < known.size();
        const bool before = next > 0;
        if (after && before) {
            const std::size_t a = known[next - 1], b = known[next];
            const double span_s = seconds(a, b);
            const double rise_m = *rows[b].height_m - *rows[a].height_m;
            if (span_s <= 0.0 || span_s > longest_s || seconds(a, i) < 0.0 || seconds(i, b) < 0.0 ||
                std::abs(rise_m) > steepest_m_s * span_s)
                continue;
            rows[i].height_m = *rows[a].height_m + rise_m * seconds(a, i) / span_s;
        } else if (after || before) {
            const std::size_t nearest = known[after ? next : next - 1];
            if (std::abs(seconds(nearest, i)) > longest_held_s) continue;
            rows[i].height_m = *rows[nearest].height_m;
        } else {
            continue;
        }
        ++filled;
    }
    if (filled > 0)
        observations.notes.push_back(fmt::format(
            "{} positions have no height of their own: it was taken between those of the epochs "
            "beside them.",
            filled));
}

std::array<double, 2> single_precision_steps_deg(const std::vector<Observation>& rows,
                                                 double written_step_m) {
    constexpr std::size_t least = 30;
    constexpr double metres_per_degree = 6'371e3 * std::numbers::pi / 180.0;
    std::array<double, 2> step_deg{};
    std::array<bool, 2> single{true, true};
    std::array<std::size_t, 2> changes{};
    const Observation* before = nullptr;
    std::size_t seen = 0;
    // Written to the nearest of its decimals.
    const double half_deg = 0.51 * written_step_m / metres_per_degree;
    for (const Observation& row : rows) {
        if (!row.latitude_deg) continue;
        ++seen;
        for (std::size_t i = 0; i < 2; ++i) {
            const double value = i == 0 ? *row.latitude_deg : *row.longitude_deg;
            const float nearest = static_cast<float>(value);
            step_deg[i] = std::max(
                step_deg[i],
                static_cast<double>(std::nextafter(std::abs(nearest), 1e9F) - std::abs(nearest)));
            single[i] = single[i] && std::abs(value - static_cast<double>(nearest)) <= half_deg;
        }
        if (!single[0] && !single[1]) return {};
        changes[0] += before && *before->latitude_deg != *row.latitude_deg ? 1U : 0U;
        changes[1] += before && *before->longitude_deg != *row.longitude_deg ? 1U : 0U;
        before = &row;
    }
    for (std::size_t i = 0; i < 2; ++i)
        // By chance none of so many would lie on a grid so much coarser than what is written.
        if (!single[i] || seen < least || changes[i] < least / 3 || step_deg[i] < 8.0 * half_deg)
            step_deg[i] = 0.0;
    return step_deg;
}

std::string bursts_in(const std::vector<Observation>& rows) {
    constexpr double many_times = 10.0, alike = 3.0, short_s = 0.03;
    constexpr std::size_t least = 20;
    std::vector<double> steps_s;
    std::size_t short_steps = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const double step_s =
            static_cast<double>(rows[i].time.nanoseconds - rows[i - 1].time.nanoseconds) * 1e-9;
        if (step_s <= 0.0) continue;
        steps_s.push_back(step_s);
        short_steps += step_s <= short_s ? 1U : 0U;
    }
    if (steps_s.size() < least || 3 * short_steps < steps_s.size()) return {};
    std::vector<double> sorted = steps_s;
    std::ranges::sort(sorted);
    const double shortest_s = sorted[sorted.size() / 3];
    const auto first_long = std::ranges::lower_bound(sorted, many_times * shortest_s);
    const std::vector<double> pauses_s(first_long, sorted.end());
    // Gaps of a recording are few, or of many lengths.
    if (shortest_s > short_s || 25 * pauses_s.size() < sorted.size() || pauses_s.size() < 5 ||
        pauses_s[pauses_s.size() * 9 / 10] > alike * pauses_s[pauses_s.size() / 10])
        return {};
    const double longest_s = pauses_s[pauses_s.size() / 2];
    // Of one burst, the steps within and the one behind it; most of the recording is such.
    std::vector<std::size_t> sizes;
    std::size_t size = 1;
    double within_s = 0.0, span_s = 0.0;
    for (const double step_s : steps_s) {
        if (step_s < pauses_s.front()) {
            ++size;
            span_s += step_s;
            continue;
        }
        sizes.push_back(size);
        within_s = std::max(within_s, size > 1 ? span_s : 0.0);
        size = 1;
        span_s = 0.0;
    }
    const auto several = std::ranges::count_if(sizes, [](std::size_t n) { return n > 1; });
    if (2 * several < std::ssize(sizes)) return {};
    std::ranges::sort(sizes);
    return fmt::format("{} within {} s, then {} s", sizes[sizes.size() / 2],
                       format_fixed(within_s, 3), format_fixed(longest_s, 3));
}

}  // namespace runcert
