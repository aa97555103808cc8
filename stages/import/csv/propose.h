#pragma once

#include <optional>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "stages/import/recording.h"

namespace runcert::csv {

/// What an attempt could say of a table that no format recognises.
struct Proposal {
    Receiver receiver;                 ///< reads the table, as far as `missing` is empty
    std::string columns;               ///< "time: t, latitude: lat", as YAML has them
    std::string first_row;             ///< "lat 52.1, lon 5.1"
    std::vector<std::string> missing;  ///< keys of columns that no name shows
    std::vector<std::string> unsure;   ///< sentences
    bool speed_unit_unknown = false;

    /// What to write into the attempt's receiver.
    std::string yaml() const;
};

/// By the names of the header line and the first row. Nothing for a text that is no table.
std::optional<Proposal> propose(const RecordingBytes& recording);

}  // namespace runcert::csv
