#include <array>

#include "stages/import/csv/preset.h"
#include "stages/import/format.h"

/// Tables that RaceBox exports. Its presets name the columns differently, and most do not say the
/// unit of speed. Times are UTC with Z, or local without.
namespace runcert::racebox {
namespace {

using csv::Column;

constexpr std::array<std::string_view, 3> beginnings{
    "Format,RaceBox", "Record,Time,Latitude,Longitude,Altitude",
    "Time,Latitude,Longitude,Altitude,Speed,GForceX"};
constexpr std::array columns{
    csv::PresetColumn{Column::time, "time"},
    csv::PresetColumn{Column::latitude, "latitude"},
    csv::PresetColumn{Column::longitude, "longitude"},
    csv::PresetColumn{Column::height, "altitude"},
    csv::PresetColumn{Column::speed, "speed"},
    csv::PresetColumn{Column::speed, "kph"},
    csv::PresetColumn{Column::speed, "mph"},
    csv::PresetColumn{Column::speed, "mps"},
    csv::PresetColumn{Column::course, "heading"},
};

constexpr csv::Preset preset{.format = "racebox",
                             .program = "RaceBox",
                             .beginnings = beginnings,
                             .columns = columns,
                             .time_format = csv::TimeFormat::iso};

}  // namespace

extern const Format format{
    .name = "racebox",
    .what = "RaceBox CSV",
    .place = 113,
    .time_origin = "RaceBox's time of each fix",
    .recognises = [](std::string_view bytes) { return csv::recognises(preset, bytes); },
    .read = [](const Receiver& receiver,
               const RecordingBytes& recording) { return csv::read(preset, receiver, recording); },
};

}  // namespace runcert::racebox
