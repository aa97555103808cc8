#pragma once

#include <optional>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "schemas/recognition/declared.h"
#include "stages/import/recording.h"

namespace runcert::csv {

/// What an attempt could say of a table that no format recognises.
struct Proposal {
    /// Reads the table, as far as its problem is empty. What is needed and not known has a value
    /// that it can be read with: a height of 0, times as UTC, the first of several dates.
    Receiver receiver;
    /// The keys that names and cells suggest, what they do not show, and why the table cannot be
    /// read so; empty where it can.
    Recognition is;
    std::string first_row;  ///< "lat 52.1, lon 5.1"
    bool speed_unit_unknown = false;
    std::optional<Observations> read = std::nullopt;
};

/// By the names of the header line and by what the columns hold. A speed unit that nobody names is
/// the one by which the fastest speed recorded is that of the positions. Nothing for a text that is
/// no table. `given`: columns that somebody names, which count before what is found.
std::optional<Proposal> propose(const RecordingBytes& recording, const CsvColumns& given = {});

}  // namespace runcert::csv
