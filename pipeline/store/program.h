#pragma once

#include <string>

namespace runcert {

/// The project's version, e.g. "1.0.0". Generated at each build.
const char* program_version();

/// The revision of the sources this program was built from: 12 hexadecimal digits, followed by
/// "-modified" where the checkout differed from it; "unknown" outside a checkout.
const char* source_revision();

/// Where the program is to be had, as whoever built it says (RUNCERT_HOME_URL of CMake); else
/// empty.
const char* program_home();

/// What the mathematical library gives on this processor, as the first 12 hexadecimal digits of a
/// SHA-256: of the compiler's name, and the bits of sin, cos, tan, atan2, exp, log, log1p, pow,
/// erfc and lgamma for fixed arguments. glibc takes other code for them where a processor has fused
/// multiply-add, whose last bits differ; where two computers agree in this, they give the same
/// results.
std::string arithmetic_fingerprint();

}  // namespace runcert
