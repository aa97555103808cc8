#include <algorithm>
#include <string>

#include "stages/import/csv/preset.h"

/// Tables that Columbus loggers (V-900 and later) write, in their simple and professional modes.
/// Layout: gpsbabel's v900.cc and RouteConverter's Columbus formats. Cells are filled up with
/// blanks or NUL bytes.
namespace runcert::columbus {
namespace {

using enum csv::Column;

constexpr std::string_view beginnings[] = {
    "INDEX,TAG,DATE,TIME,LATITUDE N/S,LONGITUDE E/W,HEIGHT,SPEED"};
constexpr csv::PresetColumn columns[] = {
    {date, "date"},     {time, "time"},   {latitude, "latitude n/s"}, {longitude, "longitude e/w"},
    {height, "height"}, {speed, "speed"}, {course, "heading"},        {fix, "valid"}};

constexpr csv::Preset preset{
    .format = "columbus",
    .what = "Columbus CSV",
    .place = 116,
    .of_satellites = true,
    .time_origin = "UTC of the receiver, or local time as the logger was set",
    .program = "Columbus loggers",
    .beginnings = beginnings,
    .columns = columns,
    .time_format = csv::TimeFormat::time_of_day,
    .note =
        "Times were taken as UTC unless the attempt says time_scale: local, to which some of "
        "these loggers can be set. Heights are above mean sea level.",
    .speed_unit = "km/h",
    .date_order = DateOrder::year_first};

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    std::string text(recording.bytes);
    std::ranges::replace(text, '\0', ' ');
    return csv::read(preset, receiver, {.name = recording.name, .bytes = text});
}

}  // namespace

extern const Format format = csv::format_of<preset>(read);

}  // namespace runcert::columbus
