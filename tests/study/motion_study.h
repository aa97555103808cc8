#pragma once

#include <string>
#include <vector>

#include "schemas/windows/windows.h"
#include "simulated_arc.h"

namespace runcert {

/// An honest recording of a known motion, and errors of a known kind.
struct MotionCell {
    std::string motion;  ///< in words
    std::string errors;
    StudyRun run;
};

/// One recording of a cell, screened, smoothed and certified under nalsa.
struct MotionResult {
    bool certified = false;     ///< there is a window, and the robust estimate agrees
    double error_m_s = 0.0;     ///< speed stated less the true one of the same window
    double expanded_m_s = 0.0;  ///< the stated uncertainty, as wide below as above
    double missed_m_s = 0.0;    ///< true speed of the truly best window less that of the stated
    double stated_m_s = 0.0;
    double indicated_m_s = 0.0;
    std::int64_t left_out = 0;  ///< epochs that screening does not use
    bool falsely_beaten =
        false;  ///< against a required speed that the truly best window just reaches
    bool falsely_not_beaten = false;  ///< against a required speed that it passes by 1 %
    std::string failure;
    std::vector<BudgetRow> budget;
    double bias_m_s = 0.0;  ///< of choosing the fastest, as estimated
};

struct MotionStudyOptions {
    std::int64_t runs = 200;
    std::uint64_t seed = 1;
    unsigned threads = 0;
};

/// All cells: the motions, each with each kind of errors.
std::vector<MotionCell> motion_cells(double rate_hz = 10.0);

std::vector<MotionResult> study_motion(const MotionCell& cell, const MotionStudyOptions& options);

/// What the runs of a cell say together.
struct MotionSummary {
    std::int64_t runs = 0, certified = 0, held = 0, missed = 0, beaten = 0, not_beaten = 0;
    double mean_error_m_s = 0.0, mean_expanded_m_s = 0.0, largest_error_in_expanded = 0.0;
    double mean_left_out = 0.0;
    double sd_error_m_s = 0.0;
};
MotionSummary summarise(const std::vector<MotionResult>& results);

std::string motion_header();
std::string motion_line(const MotionCell& cell, const MotionSummary& summary);

}  // namespace runcert
