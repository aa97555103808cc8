#pragma once

#include <cstddef>
#include <string>

#include "schemas/document/document.h"

namespace runcert {

/// Columns of the terminal that standard output is, 40 to 120; 80 where it is none.
std::size_t terminal_columns();

/// The document as text of at most `columns` columns. What belongs to a block is indented; a table
/// whose columns do not fit beside each other becomes a list.
std::string document_text(const Document& document, std::size_t columns);
/// One section, likewise.
std::string section_text(const Section& section, std::size_t columns);

}  // namespace runcert
