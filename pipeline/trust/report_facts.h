#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "files/utc_second.h"

namespace runcert {

/// Signatures that a report needs: that many in the role, by different keys.
struct RequiredSignatures {
    std::string role{};
    std::size_t count = 1;
};

/// What is read of a run folder's report.json to check or sign it.
struct ReportFacts {
    std::string text{};                            ///< its bytes: what is signed
    std::shared_ptr<const nlohmann::json> json{};  ///< the same, read
    std::string report_id{};
    std::string attempt_id{};
    std::string program_version{};
    std::string source_revision{};
    std::string arithmetic{};  ///< of the computer that made it, see files/arithmetic.h
    std::map<std::string, std::string> subjects{};  ///< file name to SHA-256
    std::vector<std::string> subject_names{};       ///< in the report's own order
    std::vector<RequiredSignatures> required{};     ///< empty: one signature, in any role
    std::optional<UtcSecond> recorded_until{};      ///< the last epoch, by the report
};

/// Reads RUN_DIR/report.json. Failure where it is missing, longer than any report, not JSON, holds
/// a key twice or begins with a byte order mark (programs differ in how they read these), names a
/// file that is none of a run folder on every system, is no measurement report, or
/// follows a version of the report's schema that is newer than this program's: what it asks for
/// could not be known.
ReportFacts read_report_facts(const std::filesystem::path& run_dir);

}  // namespace runcert
