#include "simulation/recording_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/angle.h"
#include "core/failure.h"
#include "core/geodesy.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr int truth_decimals = 6;

/// By which import knows what it is.
constexpr const char* simulated_comment =
    "# runcert simulate (no receiver: this recording is simulated)\n";

// What a simulated receiver has to say that no part of this program relies on.
constexpr int satellites = 20;
constexpr double ratio_fixed = 50.0;
constexpr double ratio_float = 1.5;

std::string seconds_text(const SimulatedEpoch& epoch) {
    return format_fixed(epoch.time_s(), 3);
}

/// "2022/03/18 08:51:22.300"
std::string rtklib_time(GpsTime time) {
    std::string text = to_iso(time, 3);
    std::replace(text.begin(), text.end(), '-', '/');
    std::replace(text.begin(), text.end(), 'T', ' ');
    return text;
}

std::string rtklib_header(const RecordingStyle& style) {
    const std::int64_t width = style.decimals_deg + 5;
    return fmt::format(
        "% program   : runcert simulate (no receiver: this recording is simulated)\n"
        "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,"
        "ns=# of satellites)\n"
        "%  GPST                  {:>{}} {:>{}}  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)"
        "  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio\n",
        "latitude(deg)", width - 1, "longitude(deg)", width);
}

/// The antenna's horizontal speed, and its rate.
std::array<double, 2> antenna_speed(const SimulatedEpoch& epoch) {
    if (!epoch.craft) return {epoch.truth.speed_m_s, epoch.truth.acceleration_m_s2};
    const Eigen::Vector2d velocity_m_s = epoch.craft->antenna_velocity_m_s.head<2>();
    const double speed_m_s = velocity_m_s.norm();
    const double gained = velocity_m_s.dot(epoch.craft->antenna_acceleration_m_s2.head<2>());
    return {speed_m_s, speed_m_s > 0.0 ? gained / speed_m_s : 0.0};
}

std::array<double, 7> craft_values(const CraftTruth& craft) {
    const Eigen::Vector3d& place_m = craft.reference_point_m;
    return {place_m.x(),
            place_m.y(),
            place_m.z(),
            craft.reference_velocity_m_s.head<2>().norm(),
            craft.attitude.roll * degrees_per_radian,
            craft.attitude.pitch * degrees_per_radian,
            craft.attitude.heading * degrees_per_radian};
}

}  // namespace

std::string rtklib_pos_text(const SimulationSpec& spec, std::span<const SimulatedEpoch> epochs) {
    if (!spec.place || !spec.start_gps)
        throw Failure(
            "simulation",
            "a .pos holds geodetic coordinates and GPS time, and place or start_gps is missing",
            "Give place and start_gps");
    const LocalFrame frame(*spec.place);
    const RecordingStyle& style = spec.recording;
    const std::string sigma_horizontal = format_fixed(style.accuracy.horizontal_m, 4);
    const std::string sigma_up = format_fixed(style.accuracy.vertical_m, 4);
    const auto decimals_m = static_cast<int>(style.decimals_m);
    const auto decimals_deg = static_cast<int>(style.decimals_deg);
    std::string text = rtklib_header(style);
    for (const SimulatedEpoch& epoch : epochs) {
        if (!epoch.recorded) continue;
        const Geodetic position = frame.geodetic_from_enu({epoch.measured_enu_m});
        text += fmt::format(
            "{} {:>{}} {:>{}} {:>10} {:>3} {:>3} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>6} {:>6}\n",
            rtklib_time(spec.start_gps->plus_nanoseconds(epoch.time_ms * 1'000'000)),
            format_fixed(position.latitude.degrees(), decimals_deg), decimals_deg + 5,
            format_fixed(position.longitude.degrees(), decimals_deg), decimals_deg + 5,
            format_fixed(position.height_m, decimals_m), epoch.fixed ? 1 : 2, satellites,
            sigma_horizontal, sigma_horizontal, sigma_up, "0.0000", "0.0000", "0.0000", "0.00",
            format_fixed(epoch.fixed ? ratio_fixed : ratio_float, 1));
    }
    return text;
}

std::string plane_csv_text(const SimulationSpec& spec, std::span<const SimulatedEpoch> epochs) {
    const bool with_fix = !spec.faults.float_fixes.empty();
    const auto decimals = static_cast<int>(spec.recording.decimals_m);
    std::string text = simulated_comment;
    text += "epoch,time_s,east_m,north_m";
    if (spec.recording.with_up) text += ",up_m";
    text += with_fix ? ",fix\n" : "\n";
    for (const SimulatedEpoch& epoch : epochs) {
        if (!epoch.recorded) continue;
        const Eigen::Vector3d& enu_m = epoch.measured_enu_m;
        text += fmt::format("{},{},{},{}", epoch.epoch, seconds_text(epoch),
                            format_fixed(enu_m.x(), decimals), format_fixed(enu_m.y(), decimals));
        if (spec.recording.with_up) text += ',' + format_fixed(enu_m.z(), decimals);
        if (with_fix) text += epoch.fixed ? ",fixed" : ",float";
        text += '\n';
    }
    return text;
}

std::string truth_csv_text(std::span<const SimulatedEpoch> epochs) {
    std::string text = simulated_comment;
    text += "time_s,east_m,north_m,up_m,speed_m_s,acceleration_m_s2";
    if (!epochs.empty() && epochs.front().craft)
        text +=
            ",reference_east_m,reference_north_m,reference_up_m,reference_speed_m_s,roll_deg,"
            "pitch_deg,heading_deg";
    text += '\n';
    const auto add = [&](double value) { text += ',' + format_fixed(value, truth_decimals); };
    for (const SimulatedEpoch& epoch : epochs) {
        text += seconds_text(epoch);
        for (const double value : epoch.true_enu_m)
            add(value);
        for (const double value : antenna_speed(epoch))
            add(value);
        if (epoch.craft)
            for (const double value : craft_values(*epoch.craft))
                add(value);
        text += '\n';
    }
    return text;
}

std::string imu_csv_text(std::span<const ImuSample> samples, GpsTime start) {
    std::string text = simulated_comment;
    text += "time_s,gx,gy,gz,ax,ay,az\n";
    const double start_s = static_cast<double>(start.nanoseconds_of_week()) * 1e-9;
    for (const ImuSample& sample : samples) {
        text += format_fixed(start_s + sample.time_s, 4);
        for (const double rate_rad_s : sample.angle_rad)
            text += ',' + format_fixed(rate_rad_s / sample.interval_s, 9);
        for (const double velocity_m_s : sample.velocity_m_s)
            text += ',' + format_fixed(velocity_m_s / sample.interval_s, 8);
        text += '\n';
    }
    return text;
}

std::string wheel_csv_text(std::span<const double> speeds_m_s,
                           std::span<const SimulatedEpoch> epochs,
                           const std::optional<GpsTime>& start) {
    std::string text = simulated_comment;
    text += start ? "time_gps,speed_m_s\n" : "time_s,speed_m_s\n";
    const auto first = std::ranges::find(epochs, true, &SimulatedEpoch::recorded);
    const std::int64_t first_ms = first == epochs.end() ? 0 : first->time_ms;
    for (std::size_t i = 0; i < epochs.size(); ++i) {
        const std::int64_t time_ms = epochs[i].time_ms;
        text += start ? to_iso(start->plus_nanoseconds(time_ms * 1'000'000), 3)
                      : format_fixed(static_cast<double>(time_ms - first_ms) / 1000.0, 3);
        text += ',' + format_fixed(speeds_m_s[i], 4) + '\n';
    }
    return text;
}

}  // namespace runcert
