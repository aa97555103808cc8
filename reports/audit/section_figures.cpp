#include <fmt/format.h>

#include "core/text.h"
#include "reports/audit/sections.h"

namespace runcert {

std::string speed_text(double speed_m_s) {
    constexpr double km_h_per_m_s = 3.6;
    return fmt::format("{} m/s ({} km/h)", format_fixed(speed_m_s, 3),
                       format_fixed(speed_m_s * km_h_per_m_s, 3));
}

std::string span_text(const WindowSpan& span) {
    return fmt::format("{} s from {} s on (epochs {} to {}{})",
                       format_fixed(span.duration.seconds(), 3),
                       format_fixed(span.start.seconds(), 3), span.first_epoch, span.last_epoch,
                       span.start_gps ? "; " + to_utc_iso(*span.start_gps, 3) : "");
}

std::string figure_text(double value) {
    return fmt::format("{:.6g}", value);
}

std::string figure_text(const Figure& figure) {
    const std::string unit = figure.unit.empty() ? "" : " " + figure.unit;
    std::string text = fmt::format("{}: {}{}", figure.name, figure_text(figure.value), unit);
    if (figure.expanded_uncertainty && *figure.expanded_uncertainty > 0.0)
        text += fmt::format(" +/- {:.2g}{} (k = 2)", *figure.expanded_uncertainty, unit);
    return figure.note.empty() ? text : text + " (" + figure.note + ")";
}

}  // namespace runcert
