#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "stages/import/cell.h"

namespace runcert::csv {

/// What may stand between the fields of a table, and its word in an attempt.
struct Delimiter {
    char character;
    std::string_view word;
};

/// In the order in which they are looked for.
std::span<const Delimiter> delimiters();

/// The delimiter of a line of a table: the first one of which any stands outside quotation marks; a
/// comma where none does.
char find_delimiter(std::string_view line);

/// Splits a line. Blanks around a field are not part of it. A field may stand in quotation marks,
/// and then hold the delimiter; "" inside stays as it is. Failure on a quotation mark that is not
/// closed, or that something follows.
std::vector<Cell> split(const SourceLine& line, const RecordingBytes& recording, char delimiter);

}  // namespace runcert::csv
