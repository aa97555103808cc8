#include <fmt/format.h>

#include "core/text.h"
#include "reports/audit/screening_parts.h"
#include "reports/audit/words.h"

namespace runcert {
namespace {

constexpr double average_s = 3.0;
constexpr double km_h_per_mps = 3.6;

struct Quantity {
    std::string_view name;
    std::string_view unit;
    int decimals;
    std::optional<double> DetectableError::*size;
};

constexpr Quantity quantities[] = {
    {"A wrong position of one epoch", "m", 3, &DetectableError::outlier_m},
    {"A step of the positions", "m", 3, &DetectableError::step_m},
    {"A drift of the positions", "m/s", 3, &DetectableError::ramp_mps},
    {"A jump of the time stamps", "s", 4, &DetectableError::time_s},
    {"A wrong height of one epoch", "m", 3, &DetectableError::outlier_up_m},
    {"A step of the heights", "m", 3, &DetectableError::step_up_m}};

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

/// What an undiscovered step makes of a speed.
std::string consequence(const DetectableSizes& step) {
    const auto change = [](double step_m) {
        return format_fixed(step_m / average_s * km_h_per_mps, 3) + " km/h";
    };
    return fmt::format(
        "A step of {} m in the middle of a {} s average, not found, makes its speed "
        "wrong by at most {}: it moves one end of the window against the other. The "
        "worst, of {} m, makes it wrong by at most {}.",
        format_fixed(step.median, 3), format_fixed(average_s, 0), change(step.median),
        format_fixed(step.worst, 3), change(step.worst));
}

}  // namespace

std::vector<Block> smallest_blocks(const ScreenedTable& table) {
    if (!table.evidence)
        return {Paragraph{holds_evidence(table)
                              ? "No test was made, so that no size could be found."
                              : "The table does not hold the evidence of revision 1.2: it does not "
                                "tell them."}};
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
                    format_fixed(100.0 * table.evidence->power, 1))}};
    blocks.emplace_back(std::move(lines));
    if (const auto step = detectable_sizes(table.rows, &DetectableError::step_m))
        blocks.emplace_back(Paragraph{consequence(*step)});
    return blocks;
}

}  // namespace runcert
