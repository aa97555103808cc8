#include "reports/diff/value_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/speed_unit.h"
#include "core/text.h"
#include "store/document_schema.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* absent = "absent";

std::string text_of(const Json& value) {
    if (value.is_number_float()) return fmt::format("{}", value.get<double>());
    return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Digits after the point of a number in its shortest form.
int decimals_of(double value) {
    const std::string text = fmt::format("{}", value);
    const std::size_t exponent = text.find('e');
    const std::size_t point = text.find('.');
    const std::size_t end = std::min(exponent, text.size());
    const int written = point < end ? static_cast<int>(end - point) - 1 : 0;
    if (exponent == std::string::npos) return written;
    const auto power = parse_integer(text.substr(exponent + 1)).value_or(0);
    return std::max(0, written - static_cast<int>(power));
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

/// The standard uncertainty of a speed (m/s) that a map states for what is in it.
std::optional<double> speed_uncertainty(const Json& map) {
    if (const auto standard = number_in(map, "standard_uncertainty_m_s")) return standard;
    if (const auto expanded = number_in(map, "expanded_uncertainty_m_s")) return *expanded / 2.0;
    return std::nullopt;
}

/// The standard uncertainty that a map states for the one quantity that it is about.
std::optional<double> own_uncertainty(const Json& map, const std::string& key) {
    if (key != "value" && key != "estimate") return std::nullopt;
    if (const auto standard = number_in(map, "standard_uncertainty")) return standard;
    if (const auto expanded = number_in(map, "expanded_uncertainty")) return *expanded / 2.0;
    if (const auto relative = number_in(map, "relative_uncertainty"))
        return std::abs(*relative * map[key].get<double>());
    return std::nullopt;
}

/// Whether a quantity says how sure another is: its tolerance is a part of itself.
bool is_uncertainty(std::string_view name) {
    for (const std::string_view word : {"uncertainty", "sigma", "_sd_", "contribution", "r95",
                                        "degrees_of_freedom", "size", "variance_factor"})
        if (name.find(word) != std::string_view::npos) return true;
    return false;
}

/// Whether it says how the noise was searched for, and not what came of it: the result of a search
/// moves where its likelihood is flat, and what it does to positions and speeds is compared there.
bool is_of_search(std::string_view path) {
    for (const std::string_view part :
         {".noise.", ".health.", "screening.models.", "estimation.largest_"})
        if (path.find(part) != std::string_view::npos) return true;
    return path.starts_with("estimation.variance_factor");
}

/// Whether two texts have the same words, and numbers within one unit of their last digit.
bool is_same_prose(std::string_view a, std::string_view b) {
    constexpr std::string_view digits = "0123456789.";
    const auto word_at = [&](std::string_view text) {
        const bool number = digits.find(text.front()) != std::string_view::npos;
        const std::size_t end =
            number ? text.find_first_not_of(digits) : text.find_first_of(digits);
        return text.substr(0, std::min(end, text.size()));
    };
    while (!a.empty() && !b.empty()) {
        const std::string_view one = word_at(a);
        const std::string_view other = word_at(b);
        const auto from = parse_double(one);
        const auto to = parse_double(other);
        const std::size_t point = std::max(one.size() - std::min(one.find('.'), one.size()),
                                           other.size() - std::min(other.find('.'), other.size()));
        const bool near =
            from && to && point > 0 &&
            std::abs(*from - *to) <= last_digit_tolerance(static_cast<int>(point) - 1);
        if (one != other && !near) return false;
        a.remove_prefix(one.size());
        b.remove_prefix(other.size());
    }
    return a.empty() && b.empty();
}

/// "profiles.0.best.speed_m_s" as a field table has it: "profiles[].best.speed_m_s".
std::string declared_path(std::string_view path) {
    std::string declared;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find('.', begin), path.size());
        const std::string_view name = path.substr(begin, end - begin);
        if (parse_integer(name))
            declared += "[]";
        else
            declared += (declared.empty() ? "" : ".") + std::string(name);
        begin = end + 1;
    }
    return declared;
}

/// The declaration of a value, where there is one: of free members (`map.*`) that of them all.
const FieldRule* declaration_of(const DocumentSchema& schema, std::string_view path) {
    const std::string declared = declared_path(path);
    if (const FieldRule* rule = schema.find(declared)) return rule;
    return schema.find(declared.substr(0, declared.rfind('.')) + ".*");
}

class Comparison {
  public:
    explicit Comparison(const ComparisonRules& rules) : rules_(rules) {}
    void compare(const Json& a, const Json& b, const std::string& path,
                 std::optional<double> uncertainty_m_s) {
        if (a.is_object() && b.is_object())
            compare_maps(a, b, path, uncertainty_m_s);
        else if (a.is_array() && b.is_array())
            compare_lists(a, b, path, uncertainty_m_s);
        else if (a.is_number() && b.is_number())
            compare_numbers(a, b, path, uncertainty_m_s);
        else if (a != b)
            found_.push_back({.path = path,
                              .a = text_of(a),
                              .b = text_of(b),
                              .tolerated = rules_.declared == nullptr && a.is_string() &&
                                           b.is_string() &&
                                           is_same_prose(a.get_ref<const std::string&>(),
                                                         b.get_ref<const std::string&>())});
    }
    std::vector<ValueDifference> take() && { return std::move(found_); }

  private:
    static std::string below(const std::string& path, const std::string& name) {
        return path.empty() ? name : fmt::format("{}.{}", path, name);
    }

    void compare_maps(const Json& a, const Json& b, const std::string& path,
                      std::optional<double> uncertainty_m_s) {
        if (const auto own = speed_uncertainty(a)) uncertainty_m_s = own;
        for (const auto& [key, value] : a.items()) {
            own_ = own_uncertainty(a, key);
            if (b.contains(key))
                compare(value, b[key], below(path, key), uncertainty_m_s);
            else
                found_.push_back({.path = below(path, key), .a = text_of(value), .b = absent});
        }
        for (const auto& [key, value] : b.items())
            if (!a.contains(key))
                found_.push_back({.path = below(path, key), .a = absent, .b = text_of(value)});
    }

    void compare_lists(const Json& a, const Json& b, const std::string& path,
                       std::optional<double> uncertainty_m_s) {
        for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
            const std::string place = below(path, fmt::format("{}", i));
            if (i < a.size() && i < b.size())
                compare(a[i], b[i], place, uncertainty_m_s);
            else
                found_.push_back({.path = place,
                                  .a = i < a.size() ? text_of(a[i]) : absent,
                                  .b = i < b.size() ? text_of(b[i]) : absent});
        }
    }

    void compare_numbers(const Json& a, const Json& b, const std::string& path,
                         std::optional<double> uncertainty_m_s) {
        if (a == b) return;
        ValueDifference different{.path = path, .a = text_of(a), .b = text_of(b)};
        const double from = a.get<double>();
        const double to = b.get<double>();
        different.difference = to - from;
        const double size = std::abs(to - from);
        const auto unit = speed_unit(path);
        std::optional<double> uncertainty = own_;
        if (!uncertainty && unit && uncertainty_m_s) uncertainty = *uncertainty_m_s * *unit;
        if (uncertainty && *uncertainty > 0.0) different.ratio = size / *uncertainty;
        different.tolerated = size <= allowed(a, b, path, uncertainty.value_or(0.0));
        found_.push_back(std::move(different));
    }

    /// By how much two numbers may differ.
    double allowed(const Json& a, const Json& b, const std::string& path,
                   double uncertainty) const {
        const double value = std::abs(a.get<double>());
        if (rules_.deciding)
            return std::max(deciding_part_of_uncertainty * uncertainty,
                            deciding_part_of_value * value);
        const std::optional<int> decimals = decimals_written(a, b, path);
        if (!decimals) return 0.0;
        if (is_of_search(path)) return part_of_search * value + least;
        const std::string name = path.substr(path.rfind('.') + 1);
        if (is_uncertainty(name)) uncertainty = std::max(uncertainty, value);
        if (name == "probability") uncertainty = std::max(uncertainty, largest_normal_density);
        return std::max(last_digit_tolerance(*decimals),
                        tolerated_fraction_of_uncertainty * uncertainty);
    }

    /// The decimals of a real number; none of a whole one.
    std::optional<int> decimals_written(const Json& a, const Json& b,
                                        const std::string& path) const {
        if (rules_.declared != nullptr) {
            const FieldRule* rule = declaration_of(*rules_.declared, path);
            if (rule == nullptr || std::ranges::find(rule->types, "real") == rule->types.end())
                return std::nullopt;
            return rule->decimals;
        }
        if (a.is_number_integer() && b.is_number_integer() && !is_of_search(path))
            return std::nullopt;
        return std::max(decimals_of(std::abs(a.get<double>())),
                        decimals_of(std::abs(b.get<double>())));
    }

    static constexpr double deciding_part_of_uncertainty = 1e-6;
    static constexpr double deciding_part_of_value = 1e-9;
    static constexpr double part_of_search = 0.01;
    static constexpr double least = 1e-8;  ///< what is zero but for rounding
    /// By how much a probability changes where the speed does by a standard uncertainty.
    static constexpr double largest_normal_density = 0.4;

    ComparisonRules rules_;
    std::vector<ValueDifference> found_;
    std::optional<double> own_;  ///< standard uncertainty of the value compared next
};

}  // namespace

std::optional<double> number_in(const Json& map, const std::string& key) {
    const auto found = map.find(key);
    return found != map.end() && found->is_number() ? std::optional(found->get<double>())
                                                    : std::nullopt;
}

double last_digit_tolerance(int decimals) {
    constexpr double unit_and_its_own_rounding = 1.01;
    return unit_and_its_own_rounding * std::pow(10.0, -decimals);
}

std::vector<ValueDifference> value_differences(const Json& a, const Json& b,
                                               const ComparisonRules& rules) {
    Comparison comparison(rules);
    comparison.compare(a, b, {}, std::nullopt);
    return std::move(comparison).take();
}

}  // namespace runcert
