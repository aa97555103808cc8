#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace runcert {

/// A file that a stage writes into the run folder.
struct ProductFile {
    std::string_view name;       ///< such as "screened": its schema, and its role as an input
    std::string_view stem;       ///< beginning of the file's name, such as "3-screened"
    std::string_view extension;  ///< such as "ecsv"
    bool each_receiver = true;   ///< one for each receiver, otherwise one for the run
    bool of_phases = false;      ///< only for a receiver whose raw phases the attempt hands in
    bool of_imu = false;         ///< only for a receiver beside which an IMU was recorded
    bool of_surface = false;     ///< only for a receiver whose surface the attempt hands in
};

namespace products {
inline constexpr ProductFile observations{"observations", "1-observations", "ecsv"};
inline constexpr ProductFile phase{"phase", "1-phase", "ecsv", true, true};
inline constexpr ProductFile imu{"imu", "1-imu", "ecsv", true, false, true};
inline constexpr ProductFile surface{"surface", "1-surface", "ecsv", true, false, false, true};
inline constexpr ProductFile enu{"enu", "2-enu", "ecsv"};
inline constexpr ProductFile screened{"screened", "3-screened", "ecsv"};
inline constexpr ProductFile screened_phase{"screened_phase", "3-phase", "ecsv", true, true};
inline constexpr ProductFile trajectory{"trajectory", "4-trajectory", "ecsv"};
inline constexpr ProductFile attitude{"attitude", "4-attitude", "ecsv", true, false, true};
inline constexpr ProductFile windows{"windows", "5-windows", "yaml"};
inline constexpr ProductFile verdict{"verdict", "6-verdict", "yaml", false};

/// In the order in which the stages write them.
inline constexpr std::array all{observations,   phase,      imu,      surface, enu,    screened,
                                screened_phase, trajectory, attitude, windows, verdict};

/// Names of files of the first receiver, and of the one of the run.
inline constexpr std::string_view observations_file = "1-observations.ecsv";
inline constexpr std::string_view windows_file = "5-windows.yaml";
inline constexpr std::string_view verdict_file = "6-verdict.yaml";
}  // namespace products

/// The pages of a report, in the order in which they are written: the whole on a screen, its first
/// page, the whole on paper.
inline constexpr std::array<const char*, 3> page_names{"report.html", "certificate.pdf",
                                                       "report.pdf"};

inline bool is_page_name(std::string_view name) {
    return std::find(page_names.begin(), page_names.end(), name) != page_names.end();
}

}  // namespace runcert
