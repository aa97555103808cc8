#include "stages/import/csv/preset.h"

/// Tables that AiM's RaceStudio exports: all channels at one rate, in seconds from the beginning.
/// What its accuracy columns mean is documented nowhere; they are left out.
namespace runcert::aim {
namespace {

using enum csv::Column;

constexpr std::string_view beginnings[] = {"\"Format\",\"AiM CSV File\"",
                                           "\"Format\",\"AIM CSV File\"", "Format,AiM CSV File",
                                           "Format,AIM CSV File"};
constexpr csv::PresetColumn columns[] = {
    // Newer versions write underscores.
    {time, "time"},
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

constexpr csv::Preset preset{
    .format = "aim",
    .what = "AiM RaceStudio CSV",
    .place = 115,
    .time_origin = "seconds from the beginning of the recording, by the logger",
    .program = "AiM",
    .beginnings = beginnings,
    .columns = columns,
    .interpolates = true,
    .note =
        "RaceStudio writes all channels at one rate: export at the receiver's own rate, or its "
        "rows lie between fixes."};

}  // namespace

extern const Format format = csv::format_of<preset>();

}  // namespace runcert::aim
