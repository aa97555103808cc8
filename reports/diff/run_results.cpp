#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/text.h"
#include "core/uncertainty.h"
#include "reports/diff/run_difference.h"
#include "reports/diff/value_comparison.h"

// What people ask of two runs first: views of the differences of two trees.

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

/// A figure of a window, as it is written.
struct WindowFigure {
    const char* key;
    const char* name;
    const char* unit;
    int decimals;

    std::string text(double value) const {
        return fmt::format("{} {}", format_fixed(value, decimals), unit);
    }
};

constexpr WindowFigure start{"start_time_s", "start", "s", 3};
constexpr WindowFigure speed{"speed_m_s", "speed", "m/s", 6};
constexpr WindowFigure window_figures[] = {
    start,
    {"duration_s", "duration", "s", 3},
    speed,
    {"standard_uncertainty_m_s", "standard uncertainty", "m/s", 6}};

/// The maps that a difference is, or is in.
std::pair<const Json*, const Json*> maps_of(const TreeDifference& at, bool itself) {
    if (itself) return {at.a, at.b};
    return {at.maps.back(), at.map_b};
}

std::string presence(const Json* window) {
    if (window == nullptr) return "none";
    return fmt::format("{} from {} on", speed.text(number_in(window, speed.key).value_or(0.0)),
                       start.text(number_in(window, start.key).value_or(0.0)));
}

std::string refusals_of(const Json* indicated) {
    if (indicated == nullptr) return "none";
    std::vector<std::string> refusals;
    if (const Json* all = member_of(indicated, "refusals"))
        for (const Json& refusal : *all)
            if (refusal.is_string()) refusals.push_back(refusal.get<std::string>());
    return refusals.empty() ? "not refused" : fmt::format("refused: {}", fmt::join(refusals, "; "));
}

std::string in_uncertainties(const Json* a, const Json* b, double difference_m_s) {
    const auto u_a = number_in(a, "standard_uncertainty_m_s");
    const auto u_b = number_in(b, "standard_uncertainty_m_s");
    const double expanded =
        usual_coverage_factor * std::hypot(u_a.value_or(0.0), u_b.value_or(0.0));
    if (!u_a || !u_b || !(expanded > 0.0)) return {};
    return fmt::format(", {} of the combined expanded uncertainty (k = 2)",
                       format_fixed(std::abs(difference_m_s) / expanded, 4));
}

void add(std::vector<Change>& changes, Change change) {
    if (change.a != change.b && (changes.empty() || changes.back() != change))
        changes.push_back(std::move(change));
}

void add_figure(std::vector<Change>& changes, const std::string& window, const WindowFigure& figure,
                const Json* a, const Json* b) {
    const auto from = number_in(a, figure.key), to = number_in(b, figure.key);
    if (!from || !to) return;
    std::string note = (*to > *from ? "+" : "") + figure.text(*to - *from);
    if (figure.key == speed.key) note += in_uncertainties(a, b, *to - *from);
    changes.push_back({fmt::format("{}, {}", window, figure.name), figure.text(*from),
                       figure.text(*to), std::move(note)});
}

/// What a difference says of the window of that name ("best", "indicated") of a rule.
void add_window_change(std::vector<Change>& changes, const std::string& rule,
                       const std::string& window, const TreeDifference& at) {
    const std::string path = "profiles[]." + window;
    if (!at.declared.starts_with(path)) return;
    const std::string name = fmt::format("{}, {} window", rule, window);
    const std::string member = at.declared.substr(path.size());
    const auto [a, b] = maps_of(at, member.empty());
    if (member.empty()) add(changes, {name, presence(at.a), presence(at.b)});
    for (const WindowFigure& figure : window_figures)
        if (member == std::string(".") + figure.key) add_figure(changes, name, figure, a, b);
    if (window == "indicated" && (member.empty() || member.starts_with(".refusals")))
        add(changes, {name, refusals_of(a), refusals_of(b)});
}

}  // namespace

std::vector<Change> window_changes(const Json& a, const Json& b, const std::string& receiver) {
    std::vector<Change> changes;
    const auto claimed = [](const Json* rule) {
        return rule == nullptr ? "not claimed" : "claimed";
    };
    for (const TreeDifference& at : tree_differences(a, b)) {
        if (!at.declared.starts_with("profiles[]")) continue;
        const std::string rule = at.keys.front() + receiver;
        if (at.declared == "profiles[]") add(changes, {rule, claimed(at.a), claimed(at.b)});
        for (const char* window : {"best", "indicated"})
            add_window_change(changes, rule, window, at);
    }
    return changes;
}

std::vector<Change> verdict_changes(const Json& a, const Json& b) {
    std::vector<Change> changes;
    for (const TreeDifference& at : tree_differences(a, b)) {
        const bool of_outcome = at.declared == "profiles[]" || at.declared == "profiles[].outcome";
        const bool of_status = at.declared == "profiles[].requirements[]" ||
                               at.declared == "profiles[].requirements[].status";
        if (!of_outcome && !of_status) continue;
        const auto [in_a, in_b] = maps_of(at, at.declared.ends_with("[]"));
        const char* member = of_outcome ? "outcome" : "status";
        add(changes, {fmt::format("{}, {}", at.keys.front(), of_outcome ? member : at.keys.back()),
                      text_in(in_a, member), text_in(in_b, member)});
    }
    return changes;
}

}  // namespace runcert
