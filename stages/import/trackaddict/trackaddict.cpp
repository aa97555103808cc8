#include "stages/import/csv/preset.h"

/// Tables of TrackAddict and RaceRender. Rows stand where the telephone's sensors have values; a
/// column says which of them hold a new position.
namespace runcert::trackaddict {
namespace {

using enum csv::Column;

constexpr std::string_view beginnings[] = {"# RaceRender Data"};
constexpr csv::PresetColumn columns[] = {
    {time, "utc time"},     {time, "time"},           {new_fix, "gps_update"},
    {latitude, "latitude"}, {longitude, "longitude"}, {height, "altitude"},
    {speed, "speed"},       {course, "heading"},      {quality_2d, "accuracy"}};

constexpr csv::Preset preset{.format = "trackaddict",
                             .what = "TrackAddict CSV",
                             .place = 114,
                             .time_origin = "the telephone's clock, when it took the position in",
                             .program = "TrackAddict",
                             .beginnings = beginnings,
                             .columns = columns};

}  // namespace

extern const Format format = csv::format_of<preset>();

}  // namespace runcert::trackaddict
