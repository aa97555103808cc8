#include "witness/phase_rows.h"

#include <fmt/format.h>

#include <cmath>
#include <tuple>

#include "core/angle.h"
#include "core/failure.h"

namespace runcert {
namespace {

constexpr std::size_t epochs_to_estimate = 100;
/// A head that announces more epochs is not trusted in advance.
constexpr std::int64_t most_epochs = 10'000'000;

}  // namespace

PhaseRecordBuilder::PhaseRecordBuilder(const PhaseTable& head) : epochs_(head.epochs) {
    for (const UsedEphemeris& each : head.ephemerides) {
        Satellite satellite;
        if (from_text(each.satellite, satellite))
            ephemerides_[{satellite, each.issue}] = {each.healthy,
                                                     static_cast<float>(each.group_delay_m)};
    }
}

PhaseSatellite PhaseRecordBuilder::satellite_of(const PhaseRow& row) const {
    PhaseSatellite satellite;
    satellite.id = row.satellite;
    if (!row.satellite_x_m || !row.satellite_y_m || !row.satellite_z_m || !row.satellite_clock_m)
        return satellite;
    satellite.position_m = {*row.satellite_x_m, *row.satellite_y_m, *row.satellite_z_m};
    satellite.clock_m = *row.satellite_clock_m;
    satellite.issue = row.issue.value_or(0);
    if (const auto found = ephemerides_.find({row.satellite, satellite.issue});
        found != ephemerides_.end()) {
        satellite.healthy = found->second.healthy;
        satellite.group_delay_m = found->second.group_delay_m;
    }
    if (row.elevation_deg)
        satellite.sine_of_elevation =
            static_cast<float>(std::sin(Angle::from_degrees(*row.elevation_deg).radians()));
    return satellite;
}

/// Reserves memory for all rows, extrapolated from the first epochs, so that growth never copies
/// them.
void PhaseRecordBuilder::make_room() {
    const auto of_all = [&](std::size_t so_far) {
        const double each = static_cast<double>(so_far) / epochs_to_estimate;
        return static_cast<std::size_t>(1.1 * each * static_cast<double>(epochs_));
    };
    record_.epochs.reserve(static_cast<std::size_t>(epochs_));
    record_.satellites.reserve(of_all(record_.satellites.size()));
    record_.signals.reserve(of_all(record_.signals.size()));
}

void PhaseRecordBuilder::add(const PhaseRow& row) {
    const bool same_epoch = row.epoch == epoch_;
    const bool same_satellite = same_epoch && record_.satellites.back().id == row.satellite;
    const bool in_order =
        !same_epoch       ? row.epoch > epoch_ && (record_.epochs.empty() ||
                                             row.time.nanoseconds > record_.epochs.back().time_ns)
        : !same_satellite ? record_.satellites.back().id < row.satellite
                          : record_.signals.back().code < row.signal;
    if (!in_order)
        throw Failure("1-phase.ecsv",
                      fmt::format("the rows of epoch {} are not in the order of time, satellite "
                                  "and signal",
                                  row.epoch),
                      "The file is not as the program writes it; take the original, or run the "
                      "stage again");
    if (!same_epoch) {
        if (record_.epochs.size() == epochs_to_estimate && epochs_ <= most_epochs) make_room();
        PhaseEpoch epoch;
        epoch.time_ns = row.time.nanoseconds;
        epoch.number = row.epoch;
        epoch.first_satellite = static_cast<std::uint32_t>(record_.satellites.size());
        record_.epochs.push_back(epoch);
        epoch_ = row.epoch;
    }
    if (!same_satellite) {
        PhaseSatellite satellite = satellite_of(row);
        satellite.first_signal = static_cast<std::uint32_t>(record_.signals.size());
        record_.satellites.push_back(satellite);
        ++record_.epochs.back().satellites;
    }
    constexpr double missing = std::numeric_limits<double>::quiet_NaN();
    PhaseSignal signal;
    signal.phase_cycles = row.phase_cycles.value_or(missing);
    signal.pseudorange_m = row.pseudorange_m.value_or(missing);
    signal.doppler_hz = static_cast<float>(row.doppler_hz.value_or(missing));
    signal.code = row.signal;
    signal.loss_of_lock = row.mark == PhaseMark::lost || row.mark == PhaseMark::lost_and_half;
    signal.half_cycle = row.mark == PhaseMark::half || row.mark == PhaseMark::lost_and_half;
    record_.signals.push_back(signal);
    ++record_.satellites.back().signals;
}

}  // namespace runcert
