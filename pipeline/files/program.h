#pragma once

namespace runcert {

/// The project's version, e.g. "1.0.0". Generated at each build.
const char* program_version();

/// The revision of the sources this program was built from: 12 hexadecimal digits, followed by
/// "-modified" where the checkout differed from it; "unknown" outside a checkout.
const char* source_revision();

}  // namespace runcert
