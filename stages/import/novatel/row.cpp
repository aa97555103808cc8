#include "stages/import/novatel/row.h"

#include <fmt/format.h>

#include <array>

#include "core/text.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/fix.h"

namespace runcert::novatel {
namespace {

constexpr std::array<std::string_view, 8> positions{
    "BESTGNSSPOSA", "BESTPOSA", "RTKPOSA", "PPPPOSA", "PSRPOSA", "INSPVAXA", "INSPVAA", "INSPVASA"};

struct PositionType {
    std::string_view word;
    FixType fix;
};

/// Of the table "Position or Velocity Type" (NovAtel, OEM7 Commands and Logs Reference Manual).
constexpr std::array position_types{
    PositionType{"NONE", FixType::none},
    PositionType{"FIXEDPOS", FixType::none},
    PositionType{"FIXEDHEIGHT", FixType::single},
    PositionType{"DOPPLER_VELOCITY", FixType::none},
    PositionType{"SINGLE", FixType::single},
    PositionType{"PSRDIFF", FixType::dgps},
    PositionType{"WAAS", FixType::sbas},
    PositionType{"SBAS", FixType::sbas},
    PositionType{"CDGPS", FixType::dgps},
    PositionType{"OMNISTAR", FixType::dgps},
    PositionType{"PROPAGATED", FixType::dead_reckoning},
    PositionType{"L1_FLOAT", FixType::float_ambiguities},
    PositionType{"IONOFREE_FLOAT", FixType::float_ambiguities},
    PositionType{"NARROW_FLOAT", FixType::float_ambiguities},
    PositionType{"L1_INT", FixType::fixed},
    PositionType{"WIDE_INT", FixType::fixed},
    PositionType{"NARROW_INT", FixType::fixed},
    PositionType{"RTK_DIRECT_INS", FixType::fixed},
    PositionType{"INS_SBAS", FixType::sbas},
    PositionType{"INS_PSRSP", FixType::single},
    PositionType{"INS_PSRDIFF", FixType::dgps},
    PositionType{"INS_RTKFLOAT", FixType::float_ambiguities},
    PositionType{"INS_RTKFIXED", FixType::fixed},
    PositionType{"INS_PPP_CONVERGING", FixType::ppp},
    PositionType{"INS_PPP", FixType::ppp},
    PositionType{"INS_PPP_BASIC_CONVERGING", FixType::ppp},
    PositionType{"INS_PPP_BASIC", FixType::ppp},
    PositionType{"OMNISTAR_HP", FixType::ppp},
    PositionType{"OMNISTAR_XP", FixType::ppp},
    PositionType{"PPP_CONVERGING", FixType::ppp},
    PositionType{"PPP", FixType::ppp},
    PositionType{"PPP_BASIC_CONVERGING", FixType::ppp},
    PositionType{"PPP_BASIC", FixType::ppp},
};

FixType read_type(const Cell& cell) {
    for (const PositionType& type : position_types)
        if (type.word == cell.text) return type.fix;
    cell.fail(
        fmt::format("the kind of position \"{}\" is not known", escape_for_message(cell.text)),
        "Hand in logs of satellite positions, as the receiver wrote them");
}

/// Fields of BESTPOS and its like, counted from 0.
namespace bestpos {
constexpr std::size_t status = 0, type = 1, latitude = 2, longitude = 3, height = 4, undulation = 5,
                      datum = 6, sigma_latitude = 7, sigma_longitude = 8, sigma_height = 9,
                      age = 11, satellites_used = 14, count = 21;
}

/// Fields of BESTVEL and its like.
namespace bestvel {
constexpr std::size_t status = 0, type = 1, latency = 2, speed = 4, course = 5, vertical = 6,
                      count = 8;
}

/// Fields of INSPVAX.
namespace inspvax {
constexpr std::size_t status = 0, type = 1, latitude = 2, longitude = 3, height = 4, undulation = 5,
                      north = 6, sigma_latitude = 12, sigma_longitude = 13, sigma_height = 14,
                      sigma_north = 15, count = 23;
}

/// Fields of INSPVA, whose heights are ellipsoidal.
namespace inspva {
constexpr std::size_t week = 0, latitude = 2, longitude = 3, height = 4, north = 5, status = 11,
                      count = 12;
}

void require_fields(const Log& log, std::size_t count) {
    if (log.fields.size() == count) return;
    log.fields.front().fail(fmt::format("the log has {} fields, not {}", log.fields.size(), count),
                            "Take the recording as the receiver wrote it");
}

/// Latitude, longitude and height, with the separation of the geoid where it is there.
void set_place(TimedRow& row, const Log& log, std::size_t latitude, double undulation_m) {
    const Cell& lat = log.fields[latitude];
    const Cell& lon = log.fields[latitude + 1];
    const Cell& height = log.fields[latitude + 2];
    set_position(row.observation,
                 checked_geodetic({.latitude = Angle::from_degrees(read_real(lat, "latitude")),
                                   .longitude = Angle::from_degrees(read_real(lon, "longitude")),
                                   .height_m = read_real(height, "height") + undulation_m},
                                  lat, lon, height));
    row.written.unit = CoordinateUnit::degree;
    row.written.coordinates = {lat.text, lon.text};
}

std::optional<double> deviation(const Cell& cell) {
    const double value = read_deviation(cell, "standard deviation");
    return value > 0.0 ? std::optional(value) : std::nullopt;
}

/// Deviations stand in the order latitude, longitude, height.
void set_deviations(Observation& row, const Log& log, std::size_t first) {
    row.sigma_north_m = deviation(log.fields[first]);
    row.sigma_east_m = deviation(log.fields[first + 1]);
    row.sigma_up_m = deviation(log.fields[first + 2]);
}

/// Velocities stand in the order north, east, up.
void set_velocity(Observation& row, const Log& log, std::size_t first) {
    row.recorded_velocity_north_m_s = read_real(log.fields[first], "velocity");
    row.recorded_velocity_east_m_s = read_real(log.fields[first + 1], "velocity");
    row.recorded_velocity_up_m_s = read_real(log.fields[first + 2], "velocity");
}

void read_bestpos(const Log& log, TimedRow& row) {
    require_fields(log, bestpos::count);
    Observation& seen = row.observation;
    seen.fix = read_type(log.fields[bestpos::type]);
    if (log.fields[bestpos::status].text != "SOL_COMPUTED") seen.fix = FixType::none;
    if (seen.fix == FixType::none) return;
    const Cell& datum = log.fields[bestpos::datum];
    if (datum.text != "WGS84")
        datum.fail(fmt::format("the datum is \"{}\"", escape_for_message(datum.text)),
                   "Record with datum WGS84, or export the positions in it");
    set_place(row, log, bestpos::latitude,
              read_real(log.fields[bestpos::undulation], "undulation"));
    set_deviations(seen, log, bestpos::sigma_latitude);
    seen.satellites = read_satellites(log.fields[bestpos::satellites_used]);
    seen.age_s = read_real(log.fields[bestpos::age], "age of corrections");
}

void read_inspvax(const Log& log, TimedRow& row) {
    require_fields(log, inspvax::count);
    Observation& seen = row.observation;
    seen.fix = read_type(log.fields[inspvax::type]);
    if (log.fields[inspvax::status].text != "INS_SOLUTION_GOOD") seen.fix = FixType::none;
    if (seen.fix == FixType::none) return;
    set_place(row, log, inspvax::latitude,
              read_real(log.fields[inspvax::undulation], "undulation"));
    set_deviations(seen, log, inspvax::sigma_latitude);
    set_velocity(seen, log, inspvax::north);
    seen.sigma_recorded_velocity_north_m_s = deviation(log.fields[inspvax::sigma_north]);
    seen.sigma_recorded_velocity_east_m_s = deviation(log.fields[inspvax::sigma_north + 1]);
    seen.sigma_recorded_velocity_up_m_s = deviation(log.fields[inspvax::sigma_north + 2]);
}

void read_inspva(const Log& log, TimedRow& row) {
    require_fields(log, inspva::count);
    row.observation.fix = FixType::none;
    if (log.fields[inspva::status].text != "INS_SOLUTION_GOOD") return;
    row.observation.fix = FixType::unknown;
    set_place(row, log, inspva::latitude, 0.0);
    set_velocity(row.observation, log, inspva::north);
}

}  // namespace

std::span<const std::string_view> position_logs() {
    return positions;
}

bool is_inertial(std::string_view log) {
    return log.starts_with("INS");
}

std::string_view velocity_log(std::string_view position_log) {
    if (is_inertial(position_log)) return {};
    if (position_log == "BESTGNSSPOSA") return "BESTGNSSVELA";
    if (position_log == "RTKPOSA") return "RTKVELA";
    if (position_log == "PSRPOSA") return "PSRVELA";
    return "BESTVELA";
}

GpsTime instant_of(const Log& log) {
    return read_week_time(log.week, log.seconds, Clock::gps);
}

TimedRow read_position(const Log& log) {
    TimedRow row;
    row.instant = instant_of(log);
    row.written.time = log.seconds.text;
    if (log.name == "INSPVAXA")
        read_inspvax(log, row);
    else if (is_inertial(log.name))
        read_inspva(log, row);
    else
        read_bestpos(log, row);
    return row;
}

double read_velocity(const Log& log, Observation& row) {
    require_fields(log, bestvel::count);
    if (log.fields[bestvel::status].text != "SOL_COMPUTED" ||
        log.fields[bestvel::type].text == "NONE")
        return 0.0;
    set_speed(row, read_real(log.fields[bestvel::speed], "speed"),
              Angle::from_degrees(read_real(log.fields[bestvel::course], "course")));
    row.recorded_velocity_up_m_s = read_real(log.fields[bestvel::vertical], "vertical speed");
    return read_real(log.fields[bestvel::latency], "latency");
}

}  // namespace runcert::novatel
