#include <algorithm>
#include <array>
#include <string>

#include "stages/import/csv/preset.h"
#include "stages/import/format.h"

/// Tables that Columbus loggers (V-900 and later) write, in their simple and professional modes.
/// Layout: gpsbabel's v900.cc and RouteConverter's Columbus formats. Cells are filled up with
/// blanks or NUL bytes.
namespace runcert::columbus {
namespace {

using csv::Column;

constexpr std::array<std::string_view, 1> beginnings{
    "INDEX,TAG,DATE,TIME,LATITUDE N/S,LONGITUDE E/W,HEIGHT,SPEED"};
constexpr std::array columns{
    csv::PresetColumn{Column::date, "date"},
    csv::PresetColumn{Column::time, "time"},
    csv::PresetColumn{Column::latitude, "latitude n/s"},
    csv::PresetColumn{Column::longitude, "longitude e/w"},
    csv::PresetColumn{Column::height, "height"},
    csv::PresetColumn{Column::speed, "speed"},
    csv::PresetColumn{Column::course, "heading"},
    csv::PresetColumn{Column::fix, "valid"},
};

constexpr csv::Preset preset{
    .format = "columbus",
    .program = "Columbus loggers",
    .beginnings = beginnings,
    .columns = columns,
    .time_format = csv::TimeFormat::time_of_day,
    .note =
        "Times were taken as UTC unless the attempt says time_scale: local, to which some of "
        "these loggers can be set. Heights are above mean sea level.",
    .speed_unit = "km/h",
    .date_order = csv::DateOrder::year_first};

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    std::string text(recording.bytes);
    std::replace(text.begin(), text.end(), '\0', ' ');
    return csv::read(preset, receiver, {.name = recording.name, .bytes = text});
}

}  // namespace

extern const Format format{
    .name = "columbus",
    .what = "Columbus CSV",
    .place = 116,
    .of_satellites = true,
    .time_origin = "UTC of the receiver, or local time as the logger was set",
    .recognises = [](std::string_view bytes) { return csv::recognises(preset, bytes); },
    .read = read,
};

}  // namespace runcert::columbus
