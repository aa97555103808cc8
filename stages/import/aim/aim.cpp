#include <array>

#include "stages/import/csv/preset.h"
#include "stages/import/format.h"

/// Tables that AiM's RaceStudio exports: all channels at one rate, in seconds from the beginning.
/// What its accuracy columns mean is documented nowhere; they are left out.
namespace runcert::aim {
namespace {

using csv::Column;

constexpr std::array<std::string_view, 4> beginnings{"\"Format\",\"AiM CSV File\"",
                                                     "\"Format\",\"AIM CSV File\"",
                                                     "Format,AiM CSV File", "Format,AIM CSV File"};
constexpr std::array columns{
    csv::PresetColumn{Column::time, "time"},
    csv::PresetColumn{Column::latitude, "gps latitude"},
    csv::PresetColumn{Column::latitude, "gps_latitude"},
    csv::PresetColumn{Column::longitude, "gps longitude"},
    csv::PresetColumn{Column::longitude, "gps_longitude"},
    csv::PresetColumn{Column::height, "gps altitude"},
    csv::PresetColumn{Column::height, "gps_altitude"},
    csv::PresetColumn{Column::speed, "gps speed"},
    csv::PresetColumn{Column::speed, "gps_speed"},
    csv::PresetColumn{Column::course, "gps heading"},
    csv::PresetColumn{Column::course, "gps_heading"},
    csv::PresetColumn{Column::satellites, "gps nsat"},
    csv::PresetColumn{Column::satellites, "gps_nsat"},
};

constexpr csv::Preset preset{
    .format = "aim",
    .program = "AiM",
    .beginnings = beginnings,
    .columns = columns,
    .interpolates = true,
    .note =
        "RaceStudio writes all channels at one rate: export at the receiver's own rate, or its "
        "rows lie between fixes."};

}  // namespace

extern const Format format{
    .name = "aim",
    .what = "AiM RaceStudio CSV",
    .place = 115,
    .time_origin = "seconds from the beginning of the recording, by the logger",
    .recognises = [](std::string_view bytes) { return csv::recognises(preset, bytes); },
    .read = [](const Receiver& receiver,
               const RecordingBytes& recording) { return csv::read(preset, receiver, recording); },
};

}  // namespace runcert::aim
