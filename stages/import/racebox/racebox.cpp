#include "stages/import/csv/preset.h"

/// Tables that RaceBox exports. Its presets name the columns differently, and most do not say the
/// unit of speed. Times are UTC with Z, or local without.
namespace runcert::racebox {
namespace {

using enum csv::Column;

constexpr std::string_view beginnings[] = {"Format,RaceBox",
                                           "Record,Time,Latitude,Longitude,Altitude",
                                           "Time,Latitude,Longitude,Altitude,Speed,GForceX"};
constexpr csv::PresetColumn columns[] = {
    {time, "time"},       {latitude, "latitude"}, {longitude, "longitude"},
    {height, "altitude"}, {speed, "speed"},       {speed, "kph"},
    {speed, "mph"},       {speed, "mps"},         {course, "heading"}};

constexpr csv::Preset preset{.format = "racebox",
                             .what = "RaceBox CSV",
                             .place = 113,
                             .time_origin = "RaceBox's time of each fix",
                             .program = "RaceBox",
                             .beginnings = beginnings,
                             .columns = columns,
                             .time_format = csv::TimeFormat::iso};

}  // namespace

extern const Format format = csv::format_of<preset>();

}  // namespace runcert::racebox
