#include "stages/window/window_fault.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/uncertainty.h"

namespace runcert {
namespace {

/// Undetected errors of positions of a fix type: how often, relative to fixed ambiguities, and of
/// what size at most. An incorrect fix is off by 1 to 3 m (manuals of receivers), a reflection
/// leaves up to a tenth of a chip of the C/A code. 0.05 is the largest of the rates that manuals
/// state of an initialisation, 25 times 0.002.
struct FixErrors {
    double times = 1.0, largest_m = 0.0;
};

FixErrors errors_of(FixType fix) {
    constexpr double by_phases_m = 3.0, by_code_m = 30.0;
    constexpr double not_fixed = 25.0;
    if (fix == FixType::fixed) return {1.0, by_phases_m};
    const bool by_phases = fix == FixType::float_ambiguities || fix == FixType::ppp;
    return {not_fixed, by_phases ? by_phases_m : by_code_m};
}

/// The larger of both among the usable epochs of a window.
FixErrors errors_in(const ScreenedTable& screened, EpochPair rows) {
    FixErrors all = errors_of(FixType::fixed);
    for (std::size_t i = rows.first; i <= rows.last; ++i)
        if (const ScreenedEpoch& row = screened.rows[i]; row.usable) {
            const FixErrors one = errors_of(row.fix);
            all = {std::max(all.times, one.times), std::max(all.largest_m, one.largest_m)};
        }
    return all;
}

/// Whether a test of screening rejected an epoch's position near a window, as in streets: there an
/// urban drive has five times the errors of open sky.
bool is_disturbed(const ScreenedTable& screened, const FoundWindow& found) {
    constexpr double near_s = 60.0;
    return std::ranges::any_of(screened.rows, [&](const ScreenedEpoch& row) {
        return row.time.seconds() >= found.start.seconds() - near_s &&
               row.time.seconds() <= found.end.seconds() + near_s && !row.usable && row.hypothesis;
    });
}

/// Increase of a window's fault probability by its rivals, in units of that probability.
double by_rivals(const FoundWindow& found, const std::vector<FoundWindow>& all,
                 double largest_m_s) {
    if (largest_m_s <= 0.0) return 0.0;
    std::vector<const FoundWindow*> near;
    for (const FoundWindow& window : all)
        if (found.speed_m_s - window.speed_m_s < largest_m_s) near.push_back(&window);
    std::ranges::stable_sort(near, std::greater<>(),
                             [](const FoundWindow* window) { return window->speed_m_s; });
    std::vector<std::pair<ElapsedTime, ElapsedTime>> taken{{found.start, found.end}};
    double sum = 0.0;
    for (const FoundWindow* const window : near) {
        const auto after = std::ranges::lower_bound(taken, window->start, {},
                                                    [](const auto& one) { return one.first; });
        const bool overlaps = (after != taken.end() && after->first < window->end) ||
                              (after != taken.begin() && std::prev(after)->second > window->start);
        if (overlaps) continue;
        taken.insert(after, {window->start, window->end});
        const double slower_m_s = std::max(0.0, found.speed_m_s - window->speed_m_s);
        sum += 0.5 * (1.0 - slower_m_s / largest_m_s);
    }
    return sum;
}

}  // namespace

double WindowFault::standard_uncertainty_m_s(double times) const {
    return std::sqrt(std::min(1.0, times * prior.probability)) *
           rectangular_uncertainty(prior.largest_m_s);
}

void WindowFault::raise(double probability, double largest, std::string finding) {
    prior.probability = std::max(prior.probability, probability);
    chosen_probability = std::max(chosen_probability, probability);
    prior.largest_m_s = std::max(prior.largest_m_s, largest);
    shown = std::move(finding);
}

WindowFault window_fault(const ScreenedTable& screened, const FoundWindow& found,
                         const std::vector<FoundWindow>& all, EpochPair rows,
                         const std::vector<UndetectedError>& reliability, bool by_path,
                         double probability, const LastingDifference& lasting) {
    const double duration_s = found.duration_s();
    WindowFault fault;
    const FixErrors errors = errors_in(screened, rows);
    constexpr double of_disturbed = 5.0;
    const bool disturbed = errors.times == 1.0 && is_disturbed(screened, found);
    fault.prior.probability =
        std::min(largest_rare_probability, probability * (disturbed ? of_disturbed : errors.times) *
                                               std::max(1.0, duration_s / usual_window_s));
    fault.prior.upwards_alone = by_path;
    if (!reliability.empty()) fault.prior.largest_m_s = reliability.front().speed_m_s;
    fault.prior.largest_m_s =
        std::min(fault.prior.largest_m_s, (by_path ? 2.0 : 1.0) * errors.largest_m / duration_s);
    if (lasting.size_m_s > 0.0) {
        // With even odds, twice the standard uncertainty covers what the two axes show together.
        const double largest_m_s = std::max(fault.prior.largest_m_s, 2.0 * lasting.size_m_s);
        const double at_fault = lasting.positions_at_fault(fault.prior.probability, largest_m_s);
        if (at_fault > fault.prior.probability)
            fault.raise(at_fault, largest_m_s,
                        "positions and recorded velocities differ all over the recording by more "
                        "than the errors of either explain");
    }
    // The probability for one window among its rivals, proportional to their number where it is
    // small.
    fault.chosen_probability = 1.0 - std::pow(1.0 - fault.prior.probability,
                                              1.0 + by_rivals(found, all, fault.prior.largest_m_s));
    return fault;
}

}  // namespace runcert
