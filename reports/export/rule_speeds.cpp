#include <optional>
#include <utility>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/export/export.h"
#include "reports/run_speeds/run_speeds.h"

namespace runcert {
namespace {

constexpr int rule_speed_decimals = 6;  // those of the trajectory

std::string rule_speed_cell(const std::optional<double>& speed_m_s) {
    return speed_m_s ? format_fixed(*speed_m_s, rule_speed_decimals) : std::string();
}

std::string rule_instant_cell(const TrajectoryTable& trajectory, const TrajectoryEpoch& row) {
    const auto& first = trajectory.facts.first_epoch;
    return first ? to_utc_iso(first->plus_nanoseconds(row.time.nanoseconds), 3) : std::string();
}

}  // namespace

std::string rule_speeds_csv(const TrajectoryTable& trajectory,
                            const std::vector<Profile>& profiles) {
    std::string csv = "epoch,time_s,utc,speed_m_s";
    std::vector<std::vector<std::optional<double>>> columns;
    for (const Profile& profile : profiles) {
        auto speeds = speeds_over_length(trajectory, profile);
        if (speeds.empty()) continue;
        csv += "," + csv_cell("speed_" + profile.id + "_m_s");
        columns.push_back(std::move(speeds));
    }
    csv += '\n';
    for (std::size_t k = 0; k < trajectory.rows.size(); ++k) {
        const TrajectoryEpoch& row = trajectory.rows[k];
        csv += std::to_string(row.epoch) + ',' + format_fixed(row.time.seconds(), 9) + ',' +
               rule_instant_cell(trajectory, row) + ',' + rule_speed_cell(row.speed_m_s);
        for (const auto& column : columns)
            csv += ',' + rule_speed_cell(column[k]);
        csv += '\n';
    }
    return csv;
}

}  // namespace runcert
