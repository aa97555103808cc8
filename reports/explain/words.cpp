#include "reports/explain/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rounding.h"
#include "core/speed_unit.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr std::size_t label_columns = 20;

}  // namespace

std::string labelled(std::string_view label, std::string_view text) {
    return fmt::format("  {:<{}}{}", label, label_columns - 2,
                       wrapped(text, label_columns, label_columns));
}

std::string heading(std::string_view outcome, std::string_view text) {
    const std::string word = upper_case(outcome);
    return fmt::format("{}  {}", word, wrapped(text, word.size() + 2, word.size() + 2));
}

std::string sentence(std::string text) {
    if (text.empty()) return text;
    text = capitalised(text);
    if (!text.ends_with('.') && !text.ends_with('?') && !text.ends_with('!')) text += '.';
    return text;
}

std::string plain_figure(double value, std::string_view unit) {
    return fmt::format("{:.9g}{}{}", value, unit.empty() ? "" : " ", unit);
}

std::string figure_words(const Figure& figure) {
    const std::string unit = figure.unit.empty() ? "" : " " + figure.unit;
    std::string text = figure.name + ": ";
    if (figure.expanded_uncertainty && *figure.expanded_uncertainty > 0.0) {
        const double uncertainty = *figure.expanded_uncertainty;
        text += fmt::format("{}{} +/- {}{} (k = 2)",
                            format_fixed(figure.value, uncertainty_decimals(uncertainty)), unit,
                            uncertainty_rounded_up(uncertainty), unit);
    } else {
        const bool tiny = figure.value != 0.0 && std::abs(figure.value) < 1e-4;
        text += (tiny ? format_fixed(figure.value, 6) : fmt::format("{:.6g}", figure.value)) + unit;
    }
    if (!figure.note.empty()) text += "; " + figure.note;
    return text;
}

std::string speed_words(double speed_m_s, std::string_view unit) {
    const std::string km_h = format_fixed(speed_m_s * 3.6, 3) + " km/h";
    if (unit == "km/h") return km_h;
    return fmt::format("{} {} ({})", format_fixed(speed_m_s / metres_per_second(unit), 3), unit,
                       km_h);
}

std::string uncertainty_words(double uncertainty_m_s, std::string_view unit) {
    const std::string km_h = uncertainty_rounded_up(uncertainty_m_s * 3.6) + " km/h";
    if (unit == "km/h") return km_h;
    return fmt::format("{} {} ({})",
                       uncertainty_rounded_up(uncertainty_m_s / metres_per_second(unit)), unit,
                       km_h);
}

}  // namespace runcert
