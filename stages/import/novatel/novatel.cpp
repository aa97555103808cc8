#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/format.h"
#include "stages/import/novatel/log.h"

/// NovAtel's ASCII logs, alone or among NMEA sentences (NovAtel, OEM7 Commands and Logs Reference
/// Manual: ASCII, BESTPOS, BESTVEL, INSPVA, INSPVAX). Positions of one log are read, those of the
/// satellites before those with an inertial unit; velocities of the log that goes with it, of the
/// same time.
namespace runcert::novatel {
namespace {

/// The logs whose positions are read, the one that is preferred first: those of the satellites
/// before those that an inertial unit takes part in.
constexpr std::string_view position_logs[] = {"BESTGNSSPOSA", "BESTPOSA", "BESTNAVA",
                                              "RTKPOSA",      "PPPPOSA",  "PSRPOSA",
                                              "INSPVAXA",     "INSPVAA",  "INSPVASA"};

/// The words of the table "Position or Velocity Type" (NovAtel, OEM7 Commands and Logs Reference
/// Manual) by what they count as.
struct PositionTypes {
    FixType fix;
    std::array<std::string_view, 10> words;
};
constexpr PositionTypes position_types[] = {
    {FixType::none, {"NONE", "FIXEDPOS", "DOPPLER_VELOCITY"}},
    {FixType::single, {"FIXEDHEIGHT", "SINGLE", "INS_PSRSP"}},
    {FixType::dgps, {"PSRDIFF", "CDGPS", "OMNISTAR", "INS_PSRDIFF"}},
    {FixType::sbas, {"WAAS", "SBAS", "INS_SBAS"}},
    {FixType::dead_reckoning, {"PROPAGATED"}},
    {FixType::float_ambiguities, {"L1_FLOAT", "IONOFREE_FLOAT", "NARROW_FLOAT", "INS_RTKFLOAT"}},
    {FixType::fixed, {"L1_INT", "WIDE_INT", "NARROW_INT", "RTK_DIRECT_INS", "INS_RTKFIXED"}},
    {FixType::ppp,
     {"INS_PPP_CONVERGING", "INS_PPP", "INS_PPP_BASIC_CONVERGING", "INS_PPP_BASIC", "OMNISTAR_HP",
      "OMNISTAR_XP", "PPP_CONVERGING", "PPP", "PPP_BASIC_CONVERGING", "PPP_BASIC"}}};

FixType read_type(const Cell& cell) {
    for (const PositionTypes& each : position_types)
        if (!cell.text.empty() && std::ranges::find(each.words, cell.text) != each.words.end())
            return each.fix;
    cell.fail(
        fmt::format("the kind of position \"{}\" is not known", escape_for_message(cell.text)),
        "Hand in logs of satellite positions, as the receiver wrote them");
}

/// Fields of BESTPOS and its like, counted from 0.
namespace bestpos {
[[maybe_unused]] constexpr std::size_t status = 0, type = 1, latitude = 2, longitude = 3,
                                       height = 4, undulation = 5, datum = 6, sigma_latitude = 7,
                                       sigma_longitude = 8, sigma_height = 9, age = 11,
                                       satellites_used = 14, count = 21;
}

/// Fields of BESTVEL and its like.
namespace bestvel {
constexpr std::size_t status = 0, type = 1, latency = 2, speed = 4, course = 5, vertical = 6,
                      count = 8;
}

/// Fields of INSPVAX.
namespace inspvax {
[[maybe_unused]] constexpr std::size_t status = 0, type = 1, latitude = 2, longitude = 3,
                                       height = 4, undulation = 5, north = 6, sigma_latitude = 12,
                                       sigma_longitude = 13, sigma_height = 14, sigma_north = 15,
                                       count = 23;
}

/// Fields of INSPVA, whose heights are ellipsoidal.
namespace inspva {
[[maybe_unused]] constexpr std::size_t week = 0, latitude = 2, longitude = 3, height = 4, north = 5,
                                       status = 11, count = 12;
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

/// Deviations of latitude, longitude and height, one after the other.
void set_deviations(Observation& row, const Log& log, std::size_t first) {
    row.sigma_north_m = deviation(log.fields[first]);
    row.sigma_east_m = deviation(log.fields[first + 1]);
    row.sigma_up_m = deviation(log.fields[first + 2]);
}

/// Velocities towards north, east and up.
void set_velocity(Observation& row, const Log& log, std::size_t first) {
    row.recorded_velocity_north_m_s = read_real(log.fields[first], "velocity");
    row.recorded_velocity_east_m_s = read_real(log.fields[first + 1], "velocity");
    row.recorded_velocity_up_m_s = read_real(log.fields[first + 2], "velocity");
}

/// Fields of Unicore's BESTNAV, BESTPOS with BESTVEL and the deviations of speeds behind it.
namespace bestnav {
constexpr std::size_t velocity = bestpos::count, sigma_vertical = velocity + 7,
                      sigma_speed = velocity + 8, count = velocity + 9;
}

double read_velocity(std::span<const Cell> fields, Observation& row);

void read_bestpos(const Log& log, TimedRow& row) {
    const bool with_velocity = log.name == "BESTNAVA";
    require_fields(log, with_velocity ? bestnav::count : bestpos::count);
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
    if (!with_velocity) return;
    (void)read_velocity(std::span(log.fields).subspan(bestnav::velocity), seen);
    if (const auto sigma = deviation(log.fields[bestnav::sigma_speed])) {
        seen.sigma_recorded_velocity_up_m_s = deviation(log.fields[bestnav::sigma_vertical]);
        set_component_accuracy(seen, *sigma);
    }
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

bool is_inertial(std::string_view log) {
    return log.starts_with("INS");
}

/// The log of velocities that goes with one of positions; empty where that has its own.
std::string_view velocity_log(std::string_view position_log) {
    if (is_inertial(position_log) || position_log == "BESTNAVA") return {};
    if (position_log == "BESTGNSSPOSA") return "BESTGNSSVELA";
    if (position_log == "RTKPOSA") return "RTKVELA";
    if (position_log == "PSRPOSA") return "PSRVELA";
    return "BESTVELA";
}

GpsTime instant_of(const Log& log) {
    return read_week_time(log.week, log.seconds, Clock::gps, log.in_milliseconds ? 3 : 0);
}

/// A log of positions as a row. A log without a solution is a row without position. Failure for a
/// position type or a datum that is not known.
TimedRow read_position(const Log& log) {
    TimedRow row;
    row.instant = instant_of(log);
    row.written.time = log.in_milliseconds ? std::string_view("0.000") : log.seconds.text;
    if (log.name == "INSPVAXA")
        read_inspvax(log, row);
    else if (is_inertial(log.name))
        read_inspva(log, row);
    else
        read_bestpos(log, row);
    return row;
}

/// Puts the velocity of a log of velocities into a row of the same time. Returns its latency (s),
/// by which the receiver says that it is older than its time.
double read_velocity(std::span<const Cell> fields, Observation& row) {
    if (fields[bestvel::status].text != "SOL_COMPUTED" || fields[bestvel::type].text == "NONE")
        return 0.0;
    set_speed(row, read_real(fields[bestvel::speed], "speed"),
              Angle::from_degrees(read_real(fields[bestvel::course], "course")));
    row.recorded_velocity_up_m_s = read_real(fields[bestvel::vertical], "vertical speed");
    return read_real(fields[bestvel::latency], "latency");
}

/// What VERSION says of the receiver's own card, the first of its components that is one: model,
/// serial number, hardware, firmware. Empty where there is none.
Instrument instrument_of(const Log& log) {
    constexpr std::size_t components_at = 1, fields_of_component = 8;
    constexpr std::size_t model = 1, serial = 2, firmware = 4;
    const auto text = [&](std::size_t at) {
        std::string_view field = trim(log.fields[at].text);
        if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
            field = field.substr(1, field.size() - 2);
        return instrument_part(field);
    };
    for (std::size_t at = components_at; at + fields_of_component <= log.fields.size();
         at += fields_of_component)
        if (log.fields[at].text == "GPSCARD")
            return {.model = text(at + model),
                    .serial = text(at + serial),
                    .firmware = text(at + firmware)};
    return {};
}

/// How many of each log there are.
std::map<std::string_view, std::int64_t> count_logs(const RecordingBytes& recording) {
    std::map<std::string_view, std::int64_t> count;
    LineReader lines(recording);
    while (const auto line = lines.next())
        if (const std::string_view name = log_name(line->text); !name.empty()) ++count[name];
    return count;
}

/// Whether the receiver knows its time to better than some milliseconds.
bool is_known(std::string_view time_status) {
    return time_status.empty() || time_status.starts_with("FINE");
}

class NovatelReader {
  public:
    NovatelReader(const RecordingBytes& recording, std::string_view positions)
        : recording_(recording),
          positions_(positions),
          velocities_(velocity_log(positions)),
          timed_(recording) {}

    Observations read() {
        LineReader lines(recording_);
        while (const auto line = lines.next()) {
            try {
                if (is_log(line->text, positions_))
                    take_position(*line);
                else if (!velocities_.empty() && is_log(line->text, velocities_))
                    take_velocity(*line);
                else if (is_log(line->text, "VERSIONA"))
                    instrument_ = instrument_of(read_log(*line, recording_));
            } catch (const Failure& failure) {
                timed_.count_bad(*line, failure);
            }
        }
        finish();
        Observations observations = empty_observations("novatel", "geodetic", "gps");
        observations.variant = positions_;
        set_instrument(observations, instrument_);
        set_rows(observations, std::move(timed_));
        note(observations);
        return observations;
    }

  private:
    void take_position(const SourceLine& line) {
        const Log log = read_log(line, recording_);
        if (!is_known(log.time_status)) {
            ++without_time_;
            return timed_.count_good();
        }
        TimedRow row = read_position(log);
        timed_.count_good();
        if (velocity_ && velocity_->instant == row.instant) {
            static_cast<RecordedVelocity&>(row.observation) = velocity_->observation;
            velocity_.reset();
        }
        finish();
        row_ = std::move(row);
        place_ = RecordPlace(line);
    }

    void take_velocity(const SourceLine& line) {
        const Log log = read_log(line, recording_);
        TimedRow velocity;
        velocity.instant = instant_of(log);
        require_fields(log, bestvel::count);
        const double latency_s = read_velocity(log.fields, velocity.observation);
        timed_.count_good();
        latency_s_ = std::max(latency_s_, latency_s);
        if (row_ && row_->instant == velocity.instant) {
            static_cast<RecordedVelocity&>(row_->observation) = velocity.observation;
            return;
        }
        velocity_ = velocity;
    }

    void finish() {
        if (row_) timed_.add(*row_, *place_);
        row_.reset();
    }

    void note(Observations& observations) const {
        observations.notes.push_back(
            fmt::format("Positions are those of the logs {}.", positions_));
        if (is_inertial(positions_))
            observations.notes.push_back(
                "An inertial unit takes part in these positions: they are estimates, and between "
                "solutions predicted.");
        if (without_time_ > 0)
            observations.notes.push_back(
                fmt::format("{} logs of a receiver that did not know its time yet are not used.",
                            without_time_));
        if (latency_s_ > 0.0)
            observations.notes.push_back(fmt::format(
                "By the receiver's word its velocities are up to {} s older than their times.",
                latency_s_));
    }

    const RecordingBytes& recording_;
    std::string_view positions_, velocities_;
    RowCollector timed_;
    std::optional<TimedRow> row_;
    std::optional<RecordPlace> place_;
    std::optional<TimedRow> velocity_;  ///< of an epoch whose position comes after it
    std::int64_t without_time_ = 0;
    double latency_s_ = 0.0;
    Instrument instrument_;
};

bool recognises(std::string_view bytes) {
    LineReader lines(bytes);
    while (const auto line = lines.next())
        for (const std::string_view name : position_logs)
            if (is_log(line->text, name)) return true;
    return false;
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    const auto count = count_logs(recording);
    std::string_view positions;
    for (const std::string_view name : position_logs)
        if (positions.empty() && count.contains(name)) positions = name;
    if (positions.empty())
        throw Failure(place_in(recording, RecordPlace(0)),
                      "the recording has no NovAtel log of positions",
                      "Record BESTPOSA and BESTVELA, both at every epoch (ONTIME 0.1)");
    Observations observations = NovatelReader(recording, positions).read();
    apply_attempt(observations, receiver);
    note_text(observations, recording);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "novatel",
    .what = "NovAtel ASCII logs",
    .place = 35,
    .stamps_satellite_time = true,
    .time_origin = "GPS time of the receiver's measurements, in each log's header",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::novatel
