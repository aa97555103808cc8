#include "reports/audit/screening.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {
namespace {

/// The part along one axis: "0.174 m east", "0.057 m south".
std::string part(double value, std::string_view unit, std::string_view towards,
                 std::string_view away, const std::string& uncertainty = {}) {
    return fmt::format("{} {}{} {}", format_fixed(std::abs(value), 3), unit, uncertainty,
                       value < 0.0 ? away : towards);
}

/// Whether two rows left out one after the other were left out by the same decision.
bool same_decision(const ScreenedEpoch& a, const ScreenedEpoch& b) {
    if (a.reason != b.reason || a.hypothesis != b.hypothesis || a.tested_axes != b.tested_axes)
        return false;
    switch (a.reason) {
        case Reason::outlier:
            return false;
        case Reason::other_fix:
            return a.fix == b.fix;
        case Reason::burst:
        case Reason::model:
        case Reason::short_arc:
            return a.statistic == b.statistic && a.threshold == b.threshold;
        case Reason::accuracy_absurd:
            return a.threshold == b.threshold &&
                   (a.statistic > a.threshold) == (b.statistic > b.threshold);
        default:
            return true;
    }
}

struct Quantity {
    std::string_view name;
    std::string_view unit;
    int decimals;
    std::optional<double> MinimalDetectableBias::*size;
};

constexpr Quantity quantities[] = {
    {"An outlier of one epoch", "m", 3, &MinimalDetectableBias::outlier_m},
    {"A step of the positions", "m", 3, &MinimalDetectableBias::step_m},
    {"A drift of the positions", "m/s", 3, &MinimalDetectableBias::ramp_m_s},
    {"A jump of the time stamps", "s", 4, &MinimalDetectableBias::time_s},
    {"A height outlier of one epoch", "m", 3, &MinimalDetectableBias::outlier_up_m},
    {"A step of the heights", "m", 3, &MinimalDetectableBias::step_up_m}};

std::string line_of(const Quantity& quantity, const DetectableSizes& sizes) {
    const auto text = [&](double value) {
        return fmt::format("{} {}", format_fixed(value, quantity.decimals), quantity.unit);
    };
    std::string line = fmt::format("{}: {}, at worst {} (epoch {})", quantity.name,
                                   text(sizes.median), text(sizes.worst), sizes.worst_epoch);
    if (sizes.without > 0)
        line += fmt::format("; at {} no size could be found", counted(sizes.without, "epoch"));
    return line + ".";
}

/// By how much a step inside a window changes its speed, for the window of each rule.
std::string change_by(double step_m, const std::vector<AuditedWindow>& windows) {
    if (windows.empty())
        return fmt::format("{} m over the duration of the window", format_fixed(step_m, 3));
    std::vector<std::string> changes;
    for (const AuditedWindow& window : windows)
        changes.push_back(
            fmt::format("{} {} under {} ({} s)",
                        uncertainty_rounded_up(step_m / window.duration_s * window.unit.per_m_s),
                        window.unit.name, window.profile, format_fixed(window.duration_s, 3)));
    return listed(changes);
}

/// What an undiscovered step makes of a speed.
std::string consequence(const DetectableSizes& step, const std::vector<AuditedWindow>& windows) {
    return fmt::format(
        "An undetected step of {} m in the middle of a window moves one end of it against the "
        "other. It changes the speed by at most {}. The worst, of {} m, changes it by at most {}.",
        format_fixed(step.median, 3), change_by(step.median, windows), format_fixed(step.worst, 3),
        change_by(step.worst, windows));
}

/// The minimal detectable biases, and what they would do to a speed.
std::vector<Block> smallest_blocks(const ScreenedTable& table, const AuditSubject& subject) {
    std::vector<std::string> lines;
    for (const Quantity& quantity : quantities)
        if (const auto sizes = detectable_sizes(table.rows, quantity.size))
            lines.push_back(line_of(quantity, *sizes));
    if (lines.empty())
        return {paragraph("No epoch used has one: no error of any size could be found.")};
    std::vector<Block> blocks{
        paragraph(fmt::format(
            "Found with a probability of {} %, in the direction in which they are hardest to find. "
            "The first figure is the median over the epochs used at which a size could be found.",
            format_fixed(100.0 * table.basis.power, 1))),
        list_of(std::move(lines))};
    if (const auto step = detectable_sizes(table.rows, &MinimalDetectableBias::step_m))
        blocks.push_back(paragraph(consequence(*step, subject.windows)));
    return blocks;
}

std::string tests_text(const ScreeningBasis& basis) {
    std::string text = fmt::format("{} planned, the recording gone through {}.",
                                   counted(basis.tests, "test"), counted(basis.passes, "time"));
    if (basis.test_size > 0.0)
        text += fmt::format(" One test rejects by chance {}.", once_in(basis.test_size));
    return text + fmt::format(
                      " An error of the minimal detectable size (see the end) is found with a "
                      "probability of {} %.",
                      format_fixed(100.0 * basis.power, 1));
}

}  // namespace

std::string one_or_range(const std::string& low, const std::string& high) {
    return low == high ? low : low + " to " + high;
}

std::string once_in(double probability) {
    const double times = 1.0 / probability;
    if (!(times < 1e15)) return fmt::format("less than once in {} million", counted(1'000'000'000));
    const double unit = times < 1e6 ? 1.0 : 1e6;
    const double value = times / unit;
    // Two digits that count.
    const double step = std::pow(10.0, std::max(0.0, std::floor(std::log10(value)) - 1.0));
    const auto whole = static_cast<std::int64_t>(std::llround(value / step) * std::llround(step));
    return fmt::format("once in {}{}", counted(whole), unit > 1.0 ? " million" : "");
}

std::string components(const EstimatedError& error) {
    const auto plus_minus = [](double sigma_m) {
        return fmt::format(" ± {} m", format_fixed(sigma_m, 3));
    };
    if (error.up_m)
        return part(*error.up_m, "m", "up", "down",
                    error.sigma_up_m ? plus_minus(*error.sigma_up_m) : "");
    if (!error.east_m || !error.north_m) return {};
    std::string east_uncertainty;
    std::string north_uncertainty;
    if (error.sigma_east_m && error.sigma_north_m) {
        east_uncertainty = plus_minus(*error.sigma_east_m);
        north_uncertainty = plus_minus(*error.sigma_north_m);
    }
    const bool equal = east_uncertainty == north_uncertainty;
    std::string text = part(*error.east_m, "m", "east", "west", equal ? "" : east_uncertainty) +
                       ", " +
                       part(*error.north_m, "m", "north", "south", equal ? "" : north_uncertainty);
    if (equal && !east_uncertainty.empty()) text += ", each" + east_uncertainty;
    return text;
}

std::optional<double> size_of(const EstimatedError& error) {
    if (error.up_m) return std::abs(*error.up_m);
    if (error.east_m && error.north_m) return std::hypot(*error.east_m, *error.north_m);
    return std::nullopt;
}

std::optional<double> rate_of(const EstimatedError& error) {
    if (error.rate_up_m_s) return std::abs(*error.rate_up_m_s);
    if (error.rate_east_m_s && error.rate_north_m_s)
        return std::hypot(*error.rate_east_m_s, *error.rate_north_m_s);
    return std::nullopt;
}

std::string rate_components(const EstimatedError& error) {
    if (error.rate_up_m_s) return part(*error.rate_up_m_s, "m/s", "up", "down");
    if (!error.rate_east_m_s || !error.rate_north_m_s) return {};
    return part(*error.rate_east_m_s, "m/s", "east", "west") + ", " +
           part(*error.rate_north_m_s, "m/s", "north", "south");
}

std::vector<AuditEntry> audit_entries(const std::vector<ScreenedEpoch>& rows) {
    using Kind = AuditEntry::Kind;
    std::vector<AuditEntry> entries;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        if (rows[row].break_before) entries.push_back({Kind::arc_break, row, row});
        if (rows[row].usable) {
            entries.push_back({Kind::used, row, row});
            continue;
        }
        const bool goes_on = !entries.empty() && entries.back().kind == Kind::left_out &&
                             same_decision(rows[row - 1], rows[row]);
        if (goes_on)
            entries.back().last = row;
        else
            entries.push_back({Kind::left_out, row, row});
    }
    return entries;
}

std::optional<DetectableSizes> detectable_sizes(
    const std::vector<ScreenedEpoch>& rows, std::optional<double> MinimalDetectableBias::*size) {
    DetectableSizes sizes;
    std::vector<double> found;
    for (const ScreenedEpoch& row : rows) {
        if (!row.usable) continue;
        const std::optional<double> here = row.detectable.*size;
        if (!here) {
            ++sizes.without;
            continue;
        }
        if (found.empty() || *here > sizes.worst) {
            sizes.worst = *here;
            sizes.worst_epoch = row.epoch;
        }
        found.push_back(*here);
    }
    if (found.empty()) return std::nullopt;
    sizes.epochs = std::ssize(found);
    sizes.median = median(std::move(found));
    return sizes;
}

std::vector<Block> screening_blocks(const ScreenedTable& table, const AuditSubject& subject,
                                    bool all) {
    std::vector<Block> blocks{heading("Basis of the tests")};
    add(blocks, screening_results(table, table.basis.time.faults.size()));
    blocks.push_back(facts({{.name = "Tests", .value = tests_text(table.basis)}}));
    blocks.push_back(heading("Decisions"));
    add(blocks, decision_blocks(table, subject, all));
    blocks.push_back(heading("Minimal detectable biases"));
    add(blocks, smallest_blocks(table, subject));
    return blocks;
}

}  // namespace runcert
