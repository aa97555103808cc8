#include <array>

#include "stages/import/csv/preset.h"
#include "stages/import/format.h"

/// Tables that RaceChrono exports: versions 1 ("Timestamp (s)"), 2 ("Time (s)") and 3 (names, units
/// and sources in three lines). Rows stand where any sensor has a value; in between, positions and
/// speeds are interpolated.
namespace runcert::racechrono {
namespace {

using csv::Column;

constexpr std::array<std::string_view, 1> beginnings{"This file is created using RaceChrono"};
constexpr std::array columns{
    csv::PresetColumn{Column::time, "timestamp"},
    csv::PresetColumn{Column::time, "time"},
    csv::PresetColumn{Column::latitude, "latitude"},
    csv::PresetColumn{Column::longitude, "longitude"},
    csv::PresetColumn{Column::height, "altitude"},
    csv::PresetColumn{Column::speed, "speed"},
    csv::PresetColumn{Column::course, "bearing"},
    csv::PresetColumn{Column::quality_2d, "accuracy"},
    csv::PresetColumn{Column::satellites, "satellites"},
    csv::PresetColumn{Column::satellites, "locked satellites"},
};

constexpr csv::Preset preset{.format = "racechrono",
                             .program = "RaceChrono",
                             .beginnings = beginnings,
                             .columns = columns,
                             .interpolates = true};

}  // namespace

extern const Format format{
    .name = "racechrono",
    .what = "RaceChrono CSV",
    .place = 112,
    .time_origin = "RaceChrono's time of each row, by the receiver or the telephone",
    .recognises = [](std::string_view bytes) { return csv::recognises(preset, bytes); },
    .read = [](const Receiver& receiver,
               const RecordingBytes& recording) { return csv::read(preset, receiver, recording); },
};

}  // namespace runcert::racechrono
