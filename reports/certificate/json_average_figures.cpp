#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "reports/certificate/json_figures.h"
#include "reports/run_speeds/run_speeds.h"
#include "schemas/verdict/figures.h"

namespace runcert {
namespace {

constexpr std::array colours{"blue", "vermilion", "green", "purple", "orange", "grey", "black"};

std::string average_caption(std::size_t every) {
    return "The speed over the length that each rule asks for, at the end of that length: over a "
           "time the mean of the smoothed speeds, over a distance path over time. Shaded: the "
           "windows. Dashed: the required speed. The measured speed is by the rule's own "
           "definition, less the bias of choosing the fastest window." +
           thinning_words(every);
}

/// Adds a rule's curve. Whether it has a point.
bool add_average(const TrajectoryTable& table, const Profile& profile, std::size_t colour,
                 Range& times, Range& speeds, const SpeedUnit& unit, Json& figure) {
    const auto averages = speeds_over_length(table, profile);
    const std::size_t every = thinning(table.rows.size());
    Curve curve({fmt::format("speed over {}", window_words(profile)), "line",
                 colours[colour % colours.size()]});
    bool has_line = false;
    for (std::size_t i = 0; i < averages.size(); ++i) {
        if (!averages[i]) {
            curve.interrupt();
            has_line = false;
            continue;
        }
        const double speed = *averages[i] * unit.per_m_s;
        const double time_s = table.rows[i].time.seconds();
        times.widen(time_s);
        speeds.widen(speed);
        if (!has_line || i % every == 0) curve.add(time_s, speed);
        has_line = true;
    }
    curve.add_to(figure);
    return !curve.empty();
}

Json average_figure(const ReportInputs& inputs, Dimension dimension) {
    const SpeedUnit& unit = speed_unit(rule_unit_name(inputs.profiles.front()));
    const TrajectoryTable& table = inputs.receivers.front().trajectory;
    const std::string speed(words_of(dimension));
    Json figure = empty_figure("average", "The " + speed + " over the rules' lengths",
                               average_caption(thinning(table.rows.size())), time_label,
                               fmt::format("{} ({})", speed, unit.name));
    Range times, speeds;
    std::set<std::string> drawn;  // rules of one length have one curve
    for (std::size_t i = 0; i < inputs.profiles.size(); ++i) {
        const Profile& profile = inputs.profiles[i];
        if (profile.dimension != dimension) continue;
        const std::string length = window_words(profile);
        if (!drawn.contains(length)) {
            if (!add_average(table, profile, drawn.size(), times, speeds, unit, figure)) continue;
            drawn.insert(length);
        }
        const ProfileVerdict& verdict = inputs.verdict.profiles[i];
        if (verdict.window)
            add_window_span(figure["spans"], *verdict.window, "window, " + profile.id, "window");
        add_required_speed(figure, speeds, verdict, unit);
    }
    if (drawn.empty()) return nullptr;
    set_axes(figure, *times.least, *times.most, *speeds.least, *speeds.most);
    return figure;
}

}  // namespace

std::vector<Json> average_figures(const ReportInputs& inputs) {
    std::vector<Json> figures;
    for (const Dimension dimension : {Dimension::horizontal, Dimension::vertical, Dimension::space})
        if (Json figure = average_figure(inputs, dimension); !figure.is_null())
            figures.push_back(std::move(figure));
    return figures;
}

}  // namespace runcert
