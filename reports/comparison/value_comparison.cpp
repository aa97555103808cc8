#include "reports/comparison/value_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/speed_unit.h"
#include "store/document_schema.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

/// What names the entries of a list; their places where nothing does.
std::vector<std::string> keys_of(const Json& list) {
    std::vector<std::string> keys;
    for (const Json& entry : list) {
        keys.push_back(fmt::format("{}", keys.size()));
        for (const char* name : {"id", "profile", "clause", "receiver", "symbol", "role", "name"})
            if (const Json* key = member_of(&entry, name); key != nullptr && key->is_string()) {
                keys.back() = key->get<std::string>();
                break;
            }
    }
    return keys;
}

std::string below(const std::string& path, const std::string& name) {
    return path.empty() ? name : fmt::format("{}.{}", path, name);
}

/// Adds the places at which two values differ; `at` says where they are, and holds them.
void find_differences(std::vector<TreeDifference>& found, const TreeDifference& at) {
    const bool both = at.a != nullptr && at.b != nullptr;
    if (both && *at.a == *at.b) return;
    TreeDifference inner = at;
    if (both && at.a->is_object() && at.b->is_object()) {
        inner.maps.push_back(at.a);
        inner.map_b = at.b;
        const auto find_in = [&](const std::string& name) {
            inner.path = below(at.path, name);
            inner.declared = below(at.declared, name);
            inner.a = member_of(at.a, name);
            inner.b = member_of(at.b, name);
            find_differences(found, inner);
        };
        for (const auto& [name, value] : at.a->items())
            find_in(name);
        for (const auto& [name, value] : at.b->items())
            if (!at.a->contains(name)) find_in(name);
    } else if (both && at.a->is_array() && at.b->is_array()) {
        const auto keys_a = keys_of(*at.a), keys_b = keys_of(*at.b);
        inner.declared += "[]";
        inner.keys.emplace_back();
        for (const MatchedPlaces& place : match_by_key(keys_a, keys_b)) {
            inner.path = below(at.path, fmt::format("{}", place.a ? *place.a : *place.b));
            inner.keys.back() = place.a ? keys_a[*place.a] : keys_b[*place.b];
            inner.a = place.a ? &(*at.a)[*place.a] : nullptr;
            inner.b = place.b ? &(*at.b)[*place.b] : nullptr;
            find_differences(found, inner);
        }
    } else {
        found.push_back(at);
    }
}

std::string text_of(const Json* value) {
    if (value == nullptr) return "absent";
    if (value->is_number_float()) return fmt::format("{}", value->get<double>());
    return value->dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// The factor from m/s to the unit that a speed's name ends with; nothing of what is no speed.
std::optional<double> speed_unit(std::string_view name) {
    constexpr std::pair<std::string_view, double> units[] = {
        {"_m_s", 1.0},
        {"_km_h", km_h_per_m_s},
        {"_knots", km_h_per_m_s / (metres_per_nautical_mile / 1000.0)},
        {"_mph", km_h_per_m_s / (metres_per_statute_mile / 1000.0)}};
    for (const auto& [end, factor] : units)
        if (name.ends_with(end)) return factor;
    return std::nullopt;
}

/// The standard uncertainty that a map states, for a speed (m/s) or for what it is about.
std::optional<double> stated_uncertainty(const Json* map, const std::string& unit) {
    if (const auto standard = number_in(map, "standard_uncertainty" + unit)) return standard;
    if (const auto expanded = number_in(map, "expanded_uncertainty" + unit)) return *expanded / 2.0;
    return std::nullopt;
}

/// The standard uncertainty of a number of that name, as the first document states it; 0 where it
/// does not.
double uncertainty_of(const TreeDifference& at, std::string_view name) {
    if (at.maps.empty()) return 0.0;
    if (name == "value" || name == "estimate") {
        const Json* map = at.maps.back();
        if (const auto own = stated_uncertainty(map, "")) return *own;
        if (const auto relative = number_in(map, "relative_uncertainty"))
            return std::abs(*relative * at.a->get<double>());
    }
    if (const auto unit = speed_unit(name))
        for (auto map = at.maps.rbegin(); map != at.maps.rend(); ++map)
            if (const auto stated = stated_uncertainty(*map, "_m_s")) return *stated * *unit;
    return 0.0;
}

bool holds_any(std::string_view text, std::initializer_list<std::string_view> parts) {
    return std::ranges::any_of(
        parts, [&](std::string_view part) { return text.find(part) != std::string_view::npos; });
}

/// Whether a quantity says how sure another is: its tolerance is a part of itself.
bool is_uncertainty(std::string_view name) {
    return holds_any(name, {"uncertainty", "sigma", "_sd_", "contribution", "r95",
                            "degrees_of_freedom", "size", "variance_factor"});
}

/// Whether it says how the noise was searched for, and not what came of it: the result of a search
/// moves where its likelihood is flat, and what it does to positions and speeds is compared there.
bool is_of_search(std::string_view path) {
    return holds_any(path, {".noise.", ".health.", "screening.models.", "estimation.largest_"}) ||
           path.starts_with("estimation.variance_factor");
}

constexpr double deciding_part_of_uncertainty = 1e-6;
constexpr double deciding_part_of_value = 1e-9;
constexpr double part_of_search = 0.01;
constexpr double least = 1e-8;  ///< what is zero but for rounding
/// By how much a probability changes where the speed does by a standard uncertainty.
constexpr double largest_normal_density = 0.4;

/// By how much a number of that name, of a standard uncertainty, may differ.
double tolerance_of(const TreeDifference& at, std::string_view name, double uncertainty,
                    const ComparisonRules& rules) {
    if (rules.declared == nullptr) return 0.0;
    const double value = std::abs(at.a->get<double>());
    if (rules.deciding)
        return std::max(deciding_part_of_uncertainty * uncertainty, deciding_part_of_value * value);
    const FieldRule* rule = rules.declared->find(at.declared);
    if (rule == nullptr)  // of free members one declaration holds for them all
        rule = rules.declared->find(at.declared.substr(0, at.declared.rfind('.')) + ".*");
    if (rule == nullptr || std::ranges::find(rule->types, "real") == rule->types.end()) return 0.0;
    if (is_of_search(at.path)) return part_of_search * value + least;
    if (is_uncertainty(name)) uncertainty = std::max(uncertainty, value);
    if (name == "probability") uncertainty = std::max(uncertainty, largest_normal_density);
    return std::max(last_digit_tolerance(rule->decimals),
                    tolerated_fraction_of_uncertainty * uncertainty);
}

ValueDifference judged(const TreeDifference& at, const ComparisonRules& rules) {
    ValueDifference found{.path = at.path, .a = text_of(at.a), .b = text_of(at.b)};
    if (at.a == nullptr || at.b == nullptr || !at.a->is_number() || !at.b->is_number())
        return found;
    const std::string name = at.path.substr(at.path.rfind('.') + 1);
    const double uncertainty = uncertainty_of(at, name);
    found.difference = at.b->get<double>() - at.a->get<double>();
    const double size = std::abs(*found.difference);
    if (uncertainty > 0.0) found.ratio = size / uncertainty;
    const double tolerance = tolerance_of(at, name, uncertainty, rules);
    // Two large whole numbers may be no difference apart as reals.
    found.tolerated = tolerance > 0.0 && size <= tolerance;
    return found;
}

}  // namespace

const Json* member_of(const Json* map, const std::string& name) {
    if (map == nullptr || !map->is_object()) return nullptr;
    const auto found = map->find(name);
    return found == map->end() ? nullptr : &*found;
}

std::optional<double> number_in(const Json* map, const std::string& name) {
    const Json* found = member_of(map, name);
    return found != nullptr && found->is_number() ? std::optional(found->get<double>())
                                                  : std::nullopt;
}

std::string text_in(const Json* map, const std::string& name) {
    const Json* found = member_of(map, name);
    return found != nullptr && found->is_string() ? found->get<std::string>() : "none";
}

double last_digit_tolerance(int decimals) {
    constexpr double unit_and_its_own_rounding = 1.01;
    return unit_and_its_own_rounding * std::pow(10.0, -decimals);
}

std::vector<TreeDifference> tree_differences(const Json& a, const Json& b) {
    std::vector<TreeDifference> found;
    find_differences(found, {.path = {}, .declared = {}, .a = &a, .b = &b});
    return found;
}

std::vector<ValueDifference> value_differences(const Json& a, const Json& b,
                                               const ComparisonRules& rules) {
    std::vector<ValueDifference> values;
    for (const TreeDifference& difference : tree_differences(a, b))
        values.push_back(judged(difference, rules));
    return values;
}

std::string maker_of(const nlohmann::ordered_json& header) {
    const nlohmann::ordered_json* stage = member_of(&header, "stage");
    return fmt::format("runcert {}, source {}", text_in(stage, "version"),
                       text_in(stage, "source_revision"));
}

}  // namespace runcert
