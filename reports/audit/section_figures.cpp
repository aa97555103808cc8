#include <fmt/format.h>

#include "core/text.h"
#include "reports/audit/sections.h"

namespace runcert {

std::string file_speed_text(double speed_m_s) {
    return format_fixed(speed_m_s, 6) + " m/s";
}

std::string span_text(const WindowSpan& span) {
    return fmt::format("{} s from {} s on (epochs {} to {}{})",
                       format_fixed(span.duration.seconds(), 3),
                       format_fixed(span.start.seconds(), 3), span.first_epoch, span.last_epoch,
                       span.start_gps ? "; " + to_utc_iso(*span.start_gps, 3) : "");
}

}  // namespace runcert
