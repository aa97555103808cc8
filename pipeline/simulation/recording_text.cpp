#include "simulation/recording_text.h"

#include <fmt/format.h>

#include <algorithm>

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
    text += "time_s,east_m,north_m,up_m,speed_m_s,acceleration_m_s2\n";
    for (const SimulatedEpoch& epoch : epochs) {
        text += seconds_text(epoch);
        for (const double value : {epoch.true_enu_m.x(), epoch.true_enu_m.y(), epoch.true_enu_m.z(),
                                   epoch.truth.speed_m_s, epoch.truth.acceleration_m_s2})
            text += ',' + format_fixed(value, truth_decimals);
        text += '\n';
    }
    return text;
}

}  // namespace runcert
