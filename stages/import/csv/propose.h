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
    /// Reads the table, as far as `problem` is empty. What is needed and not known has a value that
    /// it can be read with: a height of 0, times as UTC, the first of several dates.
    Receiver receiver;
    std::vector<ProposedKey> keys;    ///< what names and cells suggest
    std::vector<NeededKey> needed;    ///< what they do not show
    std::vector<std::string> unsure;  ///< sentences
    std::string first_row;            ///< "lat 52.1, lon 5.1"
    std::string unused;               ///< a sentence on the columns that are not used; may be empty
    bool speed_unit_unknown = false;
    std::string problem;  ///< why it cannot be read so; empty where it can
    std::optional<Observations> read = std::nullopt;

    /// What to write into the attempt's receiver, with ... for columns that are not known.
    std::string yaml() const;
};

/// By the names of the header line and by what the columns hold. A speed unit that nobody names is
/// the one by which the fastest speed recorded is that of the positions. Nothing for a text that is
/// no table. `given`: columns that somebody names, which count before what is found.
std::optional<Proposal> propose(const RecordingBytes& recording, const CsvColumns& given = {});

}  // namespace runcert::csv
