#pragma once

#include <string>
#include <string_view>

#include "schemas/common/header.h"
#include "store/document_schema.h"

/// The stages' products as files: what tells one that any program can read from one that this
/// cannot.
namespace runcert {

/// Whether a file of a run folder is a stage's product, by its name: "3-screened.ecsv".
bool is_product_name(std::string_view file);

/// The header of a product. `where` names it in messages. Failure where it cannot be read.
Header read_product_header(std::string_view text, std::string_view file, const std::string& where);

/// Failure where a product is of another version of its schema than this program reads.
void require_known_version(std::string_view text, std::string_view file, const std::string& where);

/// Reads the whole of a product as the stages do, and forgets it. Failure where it is not of the
/// schema that belongs to its name, of a version that is not known, or deviates from it anywhere.
void check_product(std::string_view text, std::string_view file, const std::string& where);

/// The fields of that product which stand outside a table's rows, as this program declares them.
const DocumentSchema& product_fields(std::string_view file);

/// The field table of a report's predicate.
const DocumentSchema& report_field_table();

}  // namespace runcert
