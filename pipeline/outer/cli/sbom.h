#pragma once

#include <string>

namespace runcert {

/// What the programs are and are made with, as SPDX 2.3 (ISO/IEC 5962) in JSON: each program and
/// each external one that is installed here with its SHA-256, each library with its version and
/// licence. The same programs on the same system give the same bytes.
std::string sbom_text();

}  // namespace runcert
