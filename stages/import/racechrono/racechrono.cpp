#include "stages/import/csv/preset.h"

/// Tables that RaceChrono exports: versions 1 ("Timestamp (s)"), 2 ("Time (s)") and 3 (names, units
/// and sources in three lines). Rows stand where any sensor has a value; in between, positions and
/// speeds are interpolated.
namespace runcert::racechrono {
namespace {

using enum csv::Column;

constexpr std::string_view beginnings[] = {"This file is created using RaceChrono"};
constexpr csv::PresetColumn columns[] = {
    {time, "timestamp"},        {time, "time"},
    {latitude, "latitude"},     {longitude, "longitude"},
    {height, "altitude"},       {speed, "speed"},
    {course, "bearing"},        {quality_2d, "accuracy"},
    {satellites, "satellites"}, {satellites, "locked satellites"}};

constexpr csv::Preset preset{
    .format = "racechrono",
    .what = "RaceChrono CSV",
    .place = 112,
    .time_origin = "RaceChrono's time of each row, by the receiver or the telephone",
    .program = "RaceChrono",
    .beginnings = beginnings,
    .columns = columns,
    .interpolates = true};

}  // namespace

extern const Format format = csv::format_of<preset>();

}  // namespace runcert::racechrono
