#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/compare/methods.h"
#include "schemas/attempt/attempt.h"
#include "schemas/document/document.h"
#include "schemas/trajectory/declared.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// Where the craft truly was, and how fast.
struct TruthEpoch {
    ElapsedTime time;
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< east, north, m
    double speed_m_s = 0.0;
};

/// Reads what `runcert simulate` writes as truth.csv: comment lines, one of column names, then
/// numbers. Of the columns time_s, east_m, north_m and speed_m_s must be there; others are passed
/// over. Failure with line and column for anything else than numbers, rows of another length, and
/// times that do not increase. `where` names the file.
std::vector<TruthEpoch> read_truth(std::string_view text, const std::string& where);

/// For each row of a trajectory the truth at its time, to half a millisecond. Both count seconds
/// from the first epoch.
std::vector<MethodEpoch> truth_at_rows(const std::vector<TruthEpoch>& truth,
                                       const TrajectoryTable& trajectory);

CompareConfig compare_config(const Attempt& attempt);

/// One method and one profile. Speeds and errors (estimate less truth) in m/s; empty where the
/// method has no value, or no truth is known.
struct MethodResult {
    std::string name;
    SpeedDefinition window_speed = SpeedDefinition::displacement;
    std::optional<ElapsedTime> best_start = {};  ///< of its own best window
    std::optional<double> best_m_s = {};
    std::optional<double> certified_m_s = {};  ///< in the certified window
    std::optional<double> rms_error_m_s = {};  ///< of its speeds, over all epochs with truth
    std::optional<double> certified_error_m_s = {};
    std::optional<double> best_error_m_s = {};
};

struct ProfileComparison {
    ProfileWindows windows;
    std::int64_t candidates = 0;          ///< certifiable windows
    std::optional<double> true_m_s = {};  ///< in the certified window, by the profile's definition
    std::vector<MethodResult> methods = {};
};

struct Comparison {
    std::string receiver;
    bool with_truth = false;
    std::int64_t epochs = 0;             ///< in arcs
    std::int64_t epochs_with_truth = 0;  ///< of them
    std::vector<ProfileComparison> profiles = {};
    std::vector<std::string> notes = {};  ///< a sentence each
};

/// All estimators' best windows side by side.
///
/// Every method chooses among the same windows: those that can be certified (all epochs usable, of
/// one arc, as long as the rule says), less those in which the method has no value. A window's
/// speed is the displacement over time for methods that give positions, the mean of the speeds for
/// methods that give speeds. The truth of a window is by the profile's definition, whatever the
/// method: the error is what a certificate by that method would have been wrong by.
///
/// `truth` has a place for each row of the trajectory, or is empty where none is known. Failure
/// where it does not cover a certified window, or no epoch at all.
Comparison compare_methods(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                           const Windows& windows, const CompareConfig& config,
                           const std::vector<MethodEpoch>& truth);

/// The comparison for people, each rule's speeds in the unit of the record to beat, rounded as the
/// measured one is.
Document comparison_document(const Comparison& comparison, const Attempt& attempt);

}  // namespace runcert
