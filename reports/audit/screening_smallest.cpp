#include <fmt/format.h>

#include "core/text.h"
#include "reports/audit/screening_parts.h"
#include "reports/audit/words.h"

namespace runcert {
namespace {

constexpr double km_h_per_m_s = 3.6;

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
        changes.push_back(fmt::format("{} km/h under {} ({} s)",
                                      format_fixed(step_m / window.duration_s * km_h_per_m_s, 3),
                                      window.profile, format_fixed(window.duration_s, 3)));
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

}  // namespace

std::vector<Block> smallest_blocks(const ScreenedTable& table, const AuditSubject& subject) {
    Entries lines;
    for (const Quantity& quantity : quantities)
        if (const auto sizes = detectable_sizes(table.rows, quantity.size))
            lines.items.push_back(line_of(quantity, *sizes));
    if (lines.items.empty())
        return {Paragraph{"No epoch used has one: no error of any size could be found."}};
    std::vector<Block> blocks{Paragraph{
        fmt::format("Found with a probability of {} %, in the direction in which they are hardest "
                    "to find. The first figure is the median over the epochs used at which a size "
                    "could be found.",
                    format_fixed(100.0 * table.basis.power, 1))}};
    blocks.emplace_back(std::move(lines));
    if (const auto step = detectable_sizes(table.rows, &MinimalDetectableBias::step_m))
        blocks.emplace_back(Paragraph{consequence(*step, subject.windows)});
    return blocks;
}

}  // namespace runcert
