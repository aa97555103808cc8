#pragma once

#include <vector>

#include "stages/import/cell.h"

namespace runcert::csv {

/// The delimiter of a line of a table: a semicolon where one stands outside quotation marks, else
/// a tab, else a comma. (Semicolons first: where they delimit, commas are decimal ones.)
char find_delimiter(std::string_view line);

/// Splits a line. Blanks around a field are not part of it. A field may stand in quotation marks,
/// and then hold the delimiter; "" inside stays as it is. Failure on a quotation mark that is not
/// closed, or that something follows.
std::vector<Cell> split(const SourceLine& line, const RecordingBytes& recording, char delimiter);

}  // namespace runcert::csv
