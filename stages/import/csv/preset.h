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
    Format format;             ///< what it says of itself
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
    bool filled_with_nul = false;              ///< cells, where other programs write blanks
};

bool recognises(const Preset& preset, std::string_view bytes);

/// The recording as observations. Times without date count from the attempt's `start_gps`; local
/// times need its `time_scale`. Speeds whose unit nobody states are left out, and a note says what
/// to write. Failure as of every table.
Observations read(const Preset& preset, const Receiver& receiver, const RecordingBytes& recording);

/// The formats of all presets, read as above.
std::span<const Format> preset_formats();

}  // namespace runcert::csv
