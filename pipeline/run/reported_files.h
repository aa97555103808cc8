#pragma once

#include <string>
#include <string_view>

#include "schemas/common/header.h"

namespace runcert {

/// The files that a report was made from, as inputs of a header, from the text of report.json;
/// `where` names the file in messages. Failure if the text is not a measurement report. Signatures
/// and hashes are not checked.
Header reported_files(std::string_view text, const std::string& where);

}  // namespace runcert
