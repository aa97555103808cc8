#include <array>

#include "stages/import/csv/preset.h"
#include "stages/import/format.h"

/// Tables of TrackAddict and RaceRender. Rows stand where the telephone's sensors have values; a
/// column says which of them hold a new position.
namespace runcert::trackaddict {
namespace {

using csv::Column;

constexpr std::array<std::string_view, 1> beginnings{"# RaceRender Data"};
constexpr std::array columns{
    csv::PresetColumn{Column::time, "utc time"},
    csv::PresetColumn{Column::time, "time"},
    csv::PresetColumn{Column::new_fix, "gps_update"},
    csv::PresetColumn{Column::latitude, "latitude"},
    csv::PresetColumn{Column::longitude, "longitude"},
    csv::PresetColumn{Column::height, "altitude"},
    csv::PresetColumn{Column::speed, "speed"},
    csv::PresetColumn{Column::course, "heading"},
    csv::PresetColumn{Column::quality_2d, "accuracy"},
};

constexpr csv::Preset preset{.format = "trackaddict",
                             .program = "TrackAddict",
                             .beginnings = beginnings,
                             .columns = columns};

}  // namespace

extern const Format format{
    .name = "trackaddict",
    .what = "TrackAddict CSV",
    .place = 114,
    .time_origin = "the telephone's clock, when it took the position in",
    .recognises = [](std::string_view bytes) { return csv::recognises(preset, bytes); },
    .read = [](const Receiver& receiver,
               const RecordingBytes& recording) { return csv::read(preset, receiver, recording); },
};

}  // namespace runcert::trackaddict
