#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/angle.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "reports/certificate/plots.h"
#include "reports/run_speeds/run_speeds.h"
#include "schemas/verdict/figures.h"

namespace runcert {
namespace {

bool is_horizontal(const RuleView& rule) {
    return rule.profile.dimension == Dimension::horizontal;
}

using Rows = std::vector<const TrajectoryEpoch*>;

Rows rows_around(const TrajectoryTable& table, std::pair<double, double> span) {
    Rows rows;
    for (const TrajectoryEpoch& row : table.rows)
        if (row.arc && row.speed_m_s && row.time.seconds() >= span.first &&
            row.time.seconds() <= span.second)
            rows.push_back(&row);
    return thinned(rows);
}

/// A method's speeds; those of the forward filter, far off where it begins, leave the range alone.
void add_method(Plot& plot, Range& speeds, const Rows& rows, Curve curve,
                std::optional<double> TrajectoryEpoch::*speed, const SpeedUnit& unit) {
    const bool is_smoothed = speed == &TrajectoryEpoch::speed_m_s;
    std::optional<std::int64_t> arc;
    for (const TrajectoryEpoch* row : rows) {
        if (row->arc != arc) curve.interrupt();
        arc = row->arc;
        if (!(row->*speed)) continue;
        const double value = *(row->*speed) * unit.per_m_s;
        if (is_smoothed && row->sigma_speed_m_s)
            curve.add(row->time.seconds(), value, 2.0 * *row->sigma_speed_m_s * unit.per_m_s,
                      speeds);
        else
            curve.add(row->time.seconds(), value);
        if (speed != &TrajectoryEpoch::speed_kalman_m_s) speeds.widen(value);
    }
    plot.add(std::move(curve));
}

/// Those that differ most from the others come first, so that they do not hide them.
void add_methods(Plot& plot, Range& speeds, const Rows& rows, const SpeedUnit& unit) {
    using Epoch = TrajectoryEpoch;
    const auto add = [&](Curve curve, std::optional<double> Epoch::*speed) {
        add_method(plot, speeds, rows, std::move(curve), speed, unit);
    };
    add({"method v1 of [DHD22]", "points", "green"}, &Epoch::speed_v1_m_s);
    add({"method v2 of [DHD22]", "points", "vermilion"}, &Epoch::speed_v2_m_s);
    add({"forward filter of [DHD22]", "dashed", "purple"}, &Epoch::speed_kalman_m_s);
    add({"smoothed ± 2 standard uncertainties", "line", "blue"}, &Epoch::speed_m_s);
    add({"batch least squares", "dashed", "black"}, &Epoch::speed_batch_m_s);
}

/// The speed that counts, over its window, and the required speed where it is near.
void add_counting_speeds(Plot& plot, Range& speeds, const RuleView& rule) {
    const double per_m_s = rule.unit().per_m_s;
    const WindowSpan& span = *rule.verdict.window;
    if (rule.verdict.speed_m_s) {
        const double speed = *rule.verdict.speed_m_s * per_m_s;
        speeds.widen(speed);
        Curve counting{"speed that counts", "outline", "black"};
        counting.add(span.start.seconds(), speed);
        counting.add(span.start.seconds() + span.duration.seconds(), speed);
        plot.add(std::move(counting));
    }
    if (!rule.verdict.required_speed_m_s || !speeds.least) return;
    const double required_speed = *rule.verdict.required_speed_m_s * per_m_s;
    const double room = std::max(speeds.span(), 0.1);
    if (required_speed >= *speeds.least - room && required_speed <= *speeds.most + room)
        add_required_speed(plot, speeds, rule);
}

/// The speed by carrier phases, from epoch to epoch.
void add_phase_speed(Plot& plot, Range& speeds, const PhaseView& view, const SpeedUnit& unit,
                     std::pair<double, double> span) {
    Curve curve{"carrier phases ± 2 standard uncertainties", "line", "vermilion"};
    add_values(curve, speeds, view.speed_m_s, span, unit.per_m_s);
    plot.add(std::move(curve));
}

/// The angle of the path below the horizontal.
double dive_angle_deg(const TrajectoryEpoch& row) {
    return std::atan2(-row.velocity_up_m_s.value_or(0.0), row.speed_m_s.value_or(0.0)) *
           degrees_per_radian;
}

/// Adds the curve of a rule's length. Whether it has a point.
bool add_average(Plot& plot, Range& times, Range& speeds, const TrajectoryTable& table,
                 const RuleView& rule, const char* colour) {
    const auto averages = speeds_over_length(table, rule.profile);
    const std::size_t every = thinning(table.rows.size());
    Curve curve{"speed over " + window_words(rule.profile), "line", colour};
    bool has_line = false;
    for (std::size_t i = 0; i < averages.size(); ++i) {
        if (!averages[i]) curve.interrupt();
        const bool begins = averages[i] && !has_line;
        has_line = averages[i].has_value();
        if (!has_line) continue;
        const double speed = *averages[i] * rule.unit().per_m_s;
        times.widen(table.rows[i].time.seconds());
        speeds.widen(speed);
        if (begins || i % every == 0) curve.add(table.rows[i].time.seconds(), speed);
    }
    const bool has_points = !curve.empty();
    plot.add(std::move(curve));
    return has_points;
}

Plots average_plot(const ReportInputs& inputs, Dimension dimension) {
    constexpr std::array colours{"blue", "vermilion", "green", "purple", "orange", "grey", "black"};
    const TrajectoryTable& table = inputs.receivers.front().trajectory;
    const std::string speed(words_of(dimension));
    const std::vector<RuleView> rules = rule_views(inputs);
    Plot plot{.kind = "average",
              .title = "The " + speed + " over the rules' lengths",
              .caption =
                  "The speed over the length that each rule asks for, at the end of "
                  "that length: over a time the mean of the smoothed speeds, over a "
                  "distance path over time. The measured speed is by the rule's own "
                  "definition, less the bias of choosing the fastest window." +
                  thinning_words(thinning(table.rows.size())),
              .x_label = time_label,
              .y_label = fmt::format("{} ({})", speed, rules.front().unit().name)};
    Range times, speeds;
    std::set<std::string> drawn;  // rules of one length have one curve
    std::vector<RuleView> shown;
    for (const RuleView& rule : rules) {
        const std::string length = window_words(rule.profile);
        if (rule.profile.dimension != dimension ||
            (!drawn.contains(length) && !add_average(plot, times, speeds, table, rule,
                                                     colours[drawn.size() % colours.size()])))
            continue;
        drawn.insert(length);
        shown.push_back(rule);
        add_required_speed(plot, speeds, rule);
    }
    if (drawn.empty()) return {};
    plot.spans = window_spans(shown);
    plot.set_axes(times, speeds);
    return {std::move(plot)};
}

}  // namespace

Plots result_plot(const ReportInputs& inputs) {
    const std::vector<RuleView> rules = rule_views(inputs);
    const auto refused = std::ranges::find_if(
        rules, [](const RuleView& rule) { return rule.verdict.indicated.has_value(); });
    const RuleView* certified = first_certified(rules);
    if (!certified && refused == rules.end()) return {};
    const RuleView& rule = certified ? *certified : *refused;
    auto span = around(certified ? *rule.verdict.window : rule.verdict.indicated->span);
    if (rule.verdict.indicated) {
        const auto [from, to] = around(rule.verdict.indicated->span);
        span = {std::min(span.first, from), std::max(span.second, to)};
    }
    const Dimension dimension = rule.profile.dimension;
    const std::string quantity = is_horizontal(rule) ? "speed" : std::string(words_of(dimension));
    Plot plot{.kind = "result",
              .rule = rule.profile.id,
              .title = capitalised(quantity) +
                       (certified ? " around the window" : " around the refused window"),
              .x_label = time_label,
              .y_label = fmt::format("{} ({})", quantity, rule.unit().name)};
    Curve curve{"smoothed speed", "line", "blue"}, angle{"dive angle (°)", "dashed", "green"};
    Range speeds;
    for (const TrajectoryEpoch* row : rows_around(inputs.receivers.front().trajectory, span)) {
        const auto speed = speed_in(*row, dimension);
        if (!speed) continue;
        curve.add(row->time.seconds(), *speed * rule.unit().per_m_s);
        speeds.widen(*speed * rule.unit().per_m_s);
        if (is_horizontal(rule)) continue;
        angle.add(row->time.seconds(), dive_angle_deg(*row));
        speeds.widen(dive_angle_deg(*row));
    }
    if (curve.empty()) return {};
    plot.add(std::move(curve));
    plot.add(std::move(angle));
    if (certified) add_counting_speeds(plot, speeds, rule);
    for (PlotLevel& level : plot.levels)
        level.name = "required speed";
    for (PlotSpan& one : plot.spans = window_spans({rule}))
        one.name.erase(std::min(one.name.find(','), one.name.size()));
    plot.set_axes({span.first, span.second}, speeds);
    return {std::move(plot)};
}

Plots window_plot(const ReportInputs& inputs, const RuleView& rule) {
    if (!rule.verdict.window) return {};
    const SpeedUnit& unit = rule.unit();
    const auto span = around(*rule.verdict.window);
    const bool has_phases = inputs.phase_view && is_horizontal(rule);
    Plot plot{.kind = "window",
              .rule = rule.profile.id,
              .title = "The window under the rule " + rule.profile.id,
              .caption = "The speed by each method around the window.",
              .x_label = time_label,
              .y_label = fmt::format("horizontal speed ({})", unit.name),
              .spans = {window_span(*rule.verdict.window)}};
    if (!is_horizontal(rule))
        plot.caption += " The rule counts another than the horizontal speed, which is not drawn.";
    Range speeds;
    add_methods(plot, speeds, rows_around(inputs.receivers.front().trajectory, span), unit);
    if (has_phases) add_phase_speed(plot, speeds, *inputs.phase_view, unit, span);
    if (is_horizontal(rule)) add_counting_speeds(plot, speeds, rule);
    if (plot.curves.empty()) return {};
    plot.set_axes({span.first, span.second}, speeds);
    return {std::move(plot)};
}

Plots average_plots(const ReportInputs& inputs) {
    Plots plots;
    for (const Dimension dimension : {Dimension::horizontal, Dimension::vertical, Dimension::space})
        std::ranges::move(average_plot(inputs, dimension), std::back_inserter(plots));
    return plots;
}

const RuleView* first_certified(const std::vector<RuleView>& rules) {
    const auto found = std::ranges::find_if(
        rules, [](const RuleView& rule) { return rule.verdict.window.has_value(); });
    return found == rules.end() ? nullptr : &*found;
}

std::pair<double, double> around(const WindowSpan& window) {
    const double start = window.start.seconds(), length = window.duration.seconds();
    const double pad = std::max(0.5 * length, 1.0);
    return {start - pad, start + length + pad};
}

PlotSpan window_span(const WindowSpan& window) {
    const double start = window.start.seconds();
    return {"window", "window", start, start + window.duration.seconds()};
}

std::vector<PlotSpan> window_spans(const std::vector<RuleView>& rules) {
    std::vector<PlotSpan> spans;
    for (const RuleView& rule : rules) {
        const auto add = [&](const WindowSpan& window, std::string name, const char* kind) {
            PlotSpan span = window_span(window);
            spans.push_back(
                {name + (rule.several ? ", " + rule.profile.id : ""), kind, span.from, span.to});
        };
        if (rule.verdict.window) {
            add(*rule.verdict.window, "window", "window");
            if (rule.best() != nullptr)
                for (const FurtherWindow& further : rule.windows->further)
                    add(further.span, "further window", "window");
        }
        if (rule.verdict.indicated) add(rule.verdict.indicated->span, "refused window", "refused");
    }
    return spans;
}

void add_required_speed(Plot& plot, Range& speeds, const RuleView& rule) {
    if (!rule.verdict.required_speed_m_s) return;
    const double required_speed = *rule.verdict.required_speed_m_s * rule.unit().per_m_s;
    speeds.widen(required_speed);
    plot.levels.push_back({"required speed, " + rule.profile.id, required_speed});
}

std::size_t thinning(std::size_t rows, std::size_t most) {
    return 1 + rows / most;
}

std::string thinning_words(std::size_t every) {
    return every > 1 ? fmt::format(" One epoch in {} is drawn.", every) : "";
}

}  // namespace runcert
