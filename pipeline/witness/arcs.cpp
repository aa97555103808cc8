#include "witness/arcs.h"

#include "schemas/enu/measured_position.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert {
namespace {

bool has_measurement(const ScreenedEpoch& row, Measurements measurements) {
    return row.usable ||
           (measurements == Measurements::before_rejection && row.reason == Reason::outlier);
}

}  // namespace

template <int Axes>
std::vector<Arc<Axes>> arcs_of(const ScreenedTable& table, Measurements measurements) {
    std::vector<Arc<Axes>> arcs;
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const ScreenedEpoch& row = table.rows[i];
        if (!row.arc) continue;
        if (arcs.empty() || arcs.back().number != *row.arc) {
            arcs.emplace_back();
            arcs.back().number = *row.arc;
        }
        ArcEpoch<Axes> epoch;
        epoch.time_s = row.time.seconds();
        epoch.step_before = row.break_before == ArcBreak::bridged;
        if (has_measurement(row, measurements))
            epoch.measurement =
                PositionMeasurement<Axes>{.position = measured_position<Axes>(row),
                                          .covariance = stated_covariance<Axes>(row)};
        arcs.back().rows.push_back(i);
        arcs.back().epochs.push_back(epoch);
    }
    return arcs;
}

template std::vector<Arc<1>> arcs_of<1>(const ScreenedTable&, Measurements);
template std::vector<Arc<2>> arcs_of<2>(const ScreenedTable&, Measurements);

}  // namespace runcert
