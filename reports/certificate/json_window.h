#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/certificate/json_facts.h"
#include "reports/certificate/report_data.h"

namespace runcert {

/// Sets the end of a span on the clock, `end_gps` and `end_utc`, where it has one.
void set_end(nlohmann::ordered_json& json, const WindowSpan& span);

/// One speed, to be shown in every unit.
struct SpeedRow {
    enum Kind {
        measured,     ///< with the decimals of the measured speed, rounded down
        uncertainty,  ///< with two significant digits, rounded up
        limit,        ///< with the decimals of the measured speed, rounded up
        stated        ///< not measured: with the decimals usual for its unit
    };
    std::string label;
    std::optional<double> speed_m_s;
    Kind kind = measured;
};

/// Rows of one speed each, in every unit, the rule's own first, where figures are those of the
/// headline. Rows without a speed are left out.
nlohmann::ordered_json speed_table(const std::vector<SpeedRow>& rows, const Profile& profile,
                                   std::optional<double> uncertainty_m_s);

/// The certified window of a verdict, which has one. `windows` is null where the search's results
/// do not hold the rule.
nlohmann::ordered_json window_json(const ProfileVerdict& verdict, const ProfileWindows* windows,
                                   const Profile& profile);

/// The refused window of a verdict, which has one.
nlohmann::ordered_json indicated_json(const ProfileVerdict& verdict, const Profile& profile);

}  // namespace runcert
