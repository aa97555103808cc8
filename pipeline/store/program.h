#pragma once

#include <string>
#include <vector>

namespace runcert {

/// The project's version, e.g. "1.0.0". Generated at each build.
const char* program_version();

/// The revision of the sources this program was built from: 12 hexadecimal digits, followed by
/// "-modified" where the checkout differed from it; "unknown" outside a checkout.
const char* source_revision();

/// When those sources were last changed: the time of that commit, "2026-03-14T03:20:00Z"; that of
/// 1970 outside a checkout.
const char* source_time();

/// Where the program is to be had, as whoever built it says (RUNCERT_HOME_URL of CMake); else
/// empty.
const char* program_home();

/// A program of the project.
struct ProgramFile {
    std::string name;    ///< "runcert-import"
    std::string sha256;  ///< of its file, 64 lower-case hexadecimal digits
};

/// Those in this program's folder, by name.
std::vector<ProgramFile> program_files();

/// What the mathematical library gives on this processor, as the first 12 hexadecimal digits of a
/// SHA-256: of the compiler's name, and the bits of sin, cos, tan, atan2, exp, log, log1p, pow,
/// erfc and lgamma for fixed arguments. glibc takes other code for them where a processor has fused
/// multiply-add, whose last bits differ; where two computers agree in this, they give the same
/// results.
std::string arithmetic_fingerprint();

}  // namespace runcert
