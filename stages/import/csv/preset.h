#pragma once

#include <span>
#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/csv/layout.h"
#include "stages/import/format.h"

// Tables whose columns are known, because a widely used program writes them: all there is to say of
// each is data.

namespace runcert::csv {

/// A column by its name, in any case and without its unit.
struct PresetColumn {
    Column meaning = Column::time;
    std::string_view name;
};

struct Preset {
    std::string_view format;  ///< as the attempt's `format` has it
    std::string_view what;    ///< as Format has it; so the next three
    int place = 0;
    bool of_satellites = false;
    std::string_view time_origin;
    std::string_view program;  ///< in words, for messages
    /// How one of the first lines begins.
    std::span<const std::string_view> beginnings;
    /// Of several names for one meaning, the first that the header has counts. Of several columns
    /// of one name, that whose source is the satellite receiver, else the first.
    std::span<const PresetColumn> columns;
    /// iso or time_of_day; or unix, where times too small for that are plain seconds.
    TimeFormat time_format = TimeFormat::unix;
    bool interpolates = false;                 ///< between fixes, where other sensors have rows
    std::string_view note = {};                ///< on its rows
    std::string_view speed_unit = {};          ///< where it is known and the header has none
    std::optional<DateOrder> date_order = {};  ///< of dates whose order no header says
};

bool recognises(const Preset& preset, std::string_view bytes);

/// The recording as observations. Times without date count from the attempt's `start_gps`; local
/// times need its `time_scale`. Speeds whose unit nobody states are left out, and a note says what
/// to write. Failure as of every table.
Observations read(const Preset& preset, const Receiver& receiver, const RecordingBytes& recording);

/// The preset as a format, read as above unless it has a way of its own.
template <const Preset& preset>
constexpr Format format_of(decltype(Format::read) its_own = nullptr) {
    return {.name = preset.format,
            .what = preset.what,
            .place = preset.place,
            .of_satellites = preset.of_satellites,
            .time_origin = preset.time_origin,
            .recognises = [](std::string_view bytes) { return recognises(preset, bytes); },
            .read = its_own ? its_own
                            : [](const Receiver& receiver,
                                 const RecordingBytes&
                                     recording) { return read(preset, receiver, recording); }};
}

}  // namespace runcert::csv
