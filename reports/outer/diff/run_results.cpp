#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/text.h"
#include "core/uncertainty.h"
#include "reports/comparison/value_comparison.h"
#include "reports/diff/run_difference.h"

// What people ask of two runs first: views of the differences of two trees.

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

/// The figures of a window, and their names.
constexpr std::pair<const char*, const char*> window_figures[] = {
    {"start_time_s", "start"},
    {"duration_s", "duration"},
    {"speed_m_s", "speed"},
    {"standard_uncertainty_m_s", "standard uncertainty"}};

/// A figure as it is written: of a speed, or of a time.
std::string figure_text(std::string_view key, double value) {
    const bool of_speed = key.ends_with("_m_s");
    return format_fixed(value, of_speed ? 6 : 3) + (of_speed ? " m/s" : " s");
}

std::string presence(const Json* window) {
    if (window == nullptr) return "none";
    const auto text = [&](const char* key) {
        return figure_text(key, number_in(window, key).value_or(0.0));
    };
    return fmt::format("{} from {} on", text("speed_m_s"), text("start_time_s"));
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

/// What a difference says of the window of that name ("best", "indicated") of a rule.
void add_window_change(std::vector<Change>& changes, const std::string& rule,
                       const std::string& window, const TreeDifference& at) {
    const std::string path = "profiles[]." + window;
    if (!at.declared.starts_with(path)) return;
    const std::string name = fmt::format("{}, {} window", rule, window);
    const std::string member = at.declared.substr(path.size());
    const Json* a = member.empty() ? at.a : at.maps.back();
    const Json* b = member.empty() ? at.b : at.map_b;
    if (member.empty()) add(changes, {name, presence(a), presence(b)});
    for (const auto& [key, figure] : window_figures) {
        const auto from = number_in(a, key), to = number_in(b, key);
        if (member != std::string(".") + key || !from || !to) continue;
        const std::string size = (*to > *from ? "+" : "") + figure_text(key, *to - *from);
        changes.push_back(
            {fmt::format("{}, {}", name, figure), figure_text(key, *from), figure_text(key, *to),
             member == ".speed_m_s" ? size + in_uncertainties(a, b, *to - *from) : size});
    }
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
        const char* member = of_outcome ? "outcome" : "status";
        const auto text = [&](const Json* value) {
            return value && value->is_string() ? value->get<std::string>() : text_in(value, member);
        };
        add(changes, {fmt::format("{}, {}", at.keys.front(), of_outcome ? member : at.keys.back()),
                      text(at.a), text(at.b)});
    }
    return changes;
}

}  // namespace runcert
