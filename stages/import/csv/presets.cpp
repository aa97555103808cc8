#include <array>

#include "stages/import/csv/preset.h"

// The programs whose tables are known by their columns, a row of `presets` each.

namespace runcert::csv {
namespace {

using enum Column;

// RaceChrono: versions 1 ("Timestamp (s)"), 2 ("Time (s)") and 3 (names, units and sources in three
// lines). Rows stand where any sensor has a value; in between, positions and speeds are
// interpolated.
constexpr std::string_view racechrono_beginnings[] = {"This file is created using RaceChrono"};
constexpr PresetColumn racechrono_columns[] = {
    {time, "timestamp"},        {time, "time"},
    {latitude, "latitude"},     {longitude, "longitude"},
    {height, "altitude"},       {speed, "speed"},
    {course, "bearing"},        {quality_2d, "accuracy"},
    {satellites, "satellites"}, {satellites, "locked satellites"}};

// RaceBox: its presets name the columns differently, and most do not say the unit of speed. Times
// are UTC with Z, or local without.
constexpr std::string_view racebox_beginnings[] = {
    "Format,RaceBox", "Record,Time,Latitude,Longitude,Altitude",
    "Time,Latitude,Longitude,Altitude,Speed,GForceX"};
constexpr PresetColumn racebox_columns[] = {
    {time, "time"},       {latitude, "latitude"}, {longitude, "longitude"},
    {height, "altitude"}, {speed, "speed"},       {speed, "kph"},
    {speed, "mph"},       {speed, "mps"},         {course, "heading"}};

// TrackAddict and RaceRender: rows stand where the telephone's sensors have values; a column says
// which of them hold a new position.
constexpr std::string_view trackaddict_beginnings[] = {"# RaceRender Data"};
constexpr PresetColumn trackaddict_columns[] = {
    {time, "utc time"},     {time, "time"},           {new_fix, "gps_update"},
    {latitude, "latitude"}, {longitude, "longitude"}, {height, "altitude"},
    {speed, "speed"},       {course, "heading"},      {quality_2d, "accuracy"}};

// AiM's RaceStudio: all channels at one rate, in seconds from the beginning. What its accuracy
// columns mean is documented nowhere; they are left out. Newer versions write underscores.
constexpr std::string_view aim_beginnings[] = {"\"Format\",\"AiM CSV File\"",
                                               "\"Format\",\"AIM CSV File\"", "Format,AiM CSV File",
                                               "Format,AIM CSV File"};
constexpr PresetColumn aim_columns[] = {{time, "time"},
                                        {latitude, "gps latitude"},
                                        {latitude, "gps_latitude"},
                                        {longitude, "gps longitude"},
                                        {longitude, "gps_longitude"},
                                        {height, "gps altitude"},
                                        {height, "gps_altitude"},
                                        {speed, "gps speed"},
                                        {speed, "gps_speed"},
                                        {course, "gps heading"},
                                        {course, "gps_heading"},
                                        {satellites, "gps nsat"},
                                        {satellites, "gps_nsat"}};

// Columbus loggers (V-900 and later), in their simple and professional modes. Layout: gpsbabel's
// v900.cc and RouteConverter's Columbus formats.
constexpr std::string_view columbus_beginnings[] = {
    "INDEX,TAG,DATE,TIME,LATITUDE N/S,LONGITUDE E/W,HEIGHT,SPEED"};
constexpr PresetColumn columbus_columns[] = {
    {date, "date"},     {time, "time"},   {latitude, "latitude n/s"}, {longitude, "longitude e/w"},
    {height, "height"}, {speed, "speed"}, {course, "heading"},        {fix, "valid"}};

constexpr Preset presets[] = {
    {.format = {.name = "racechrono",
                .what = "RaceChrono CSV",
                .place = 112,
                .time_origin = "RaceChrono's time of each row, by the receiver or the telephone"},
     .program = "RaceChrono",
     .beginnings = racechrono_beginnings,
     .columns = racechrono_columns,
     .interpolates = true},
    {.format = {.name = "racebox",
                .what = "RaceBox CSV",
                .place = 113,
                .time_origin = "RaceBox's time of each fix"},
     .program = "RaceBox",
     .beginnings = racebox_beginnings,
     .columns = racebox_columns,
     .time_format = TimeFormat::iso},
    {.format = {.name = "trackaddict",
                .what = "TrackAddict CSV",
                .place = 114,
                .time_origin = "the telephone's clock, when it took the position in"},
     .program = "TrackAddict",
     .beginnings = trackaddict_beginnings,
     .columns = trackaddict_columns},
    {.format = {.name = "aim",
                .what = "AiM RaceStudio CSV",
                .place = 115,
                .time_origin = "seconds from the beginning of the recording, by the logger"},
     .program = "AiM",
     .beginnings = aim_beginnings,
     .columns = aim_columns,
     .interpolates = true,
     .note = "RaceStudio writes all channels at one rate: export at the receiver's own rate, or "
             "its rows lie between fixes."},
    {.format = {.name = "columbus",
                .what = "Columbus CSV",
                .place = 116,
                .stamps_satellite_time = true,
                .time_origin = "UTC of the receiver, or local time as the logger was set"},
     .program = "Columbus loggers",
     .beginnings = columbus_beginnings,
     .columns = columbus_columns,
     .time_format = TimeFormat::time_of_day,
     .note = "Times were taken as UTC unless the attempt says time_scale: local, to which some of "
             "these loggers can be set. Heights are above mean sea level.",
     .speed_unit = "km/h",
     .date_order = DateOrder::year_first,
     .filled_with_nul = true}};

template <std::size_t row>
constexpr Format format_of() {
    Format format = presets[row].format;
    format.recognises = [](std::string_view bytes) { return recognises(presets[row], bytes); };
    format.read = [](const Receiver& receiver, const RecordingBytes& recording) {
        return read(presets[row], receiver, recording);
    };
    return format;
}

constexpr std::array formats{format_of<0>(), format_of<1>(), format_of<2>(), format_of<3>(),
                             format_of<4>()};
static_assert(formats.size() == std::size(presets));

}  // namespace

std::span<const Format> preset_formats() {
    return formats;
}

}  // namespace runcert::csv
