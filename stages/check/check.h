#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"
#include "stages/check/course.h"
#include "stages/check/wind.h"

namespace runcert {

/// Key of the epochs of a profile's windows with second files; of others it is the profile's id.
inline std::string key_with_files(const std::string& profile) {
    return profile + " with files";
}

/// Data gathered from the screened epochs, one by one.
struct ScreenedSelection {
    ScreeningSummary screening = {};
    /// The epochs of each profile's best window, by the profile's id or `key_with_files`.
    std::map<std::string, std::vector<ScreenedEpoch>> window_epochs = {};
    /// The same of each of the windows that make the figure with it.
    std::map<std::string, std::vector<std::vector<ScreenedEpoch>>> further_epochs = {};

    void add(const ScreenedEpoch& row, const Windows& windows);

    const std::vector<ScreenedEpoch>& epochs_of(const std::string& key) const {
        static const std::vector<ScreenedEpoch> none;
        const auto found = window_epochs.find(key);
        return found == window_epochs.end() ? none : found->second;
    }
};

/// The earlier stages' findings on one receiver, with what 1-observations states of its recording
/// (without the rows).
struct ReceiverFindings : Observations, ScreenedSelection {
    std::string receiver = {};
    ScreeningBasis tests = {};
    EstimationSummary estimation = {};
    Windows windows = {};
    std::optional<FrameOrigin> origin = std::nullopt;  ///< of the trajectory
    std::vector<TrajectoryEpoch> trajectory = {};
    std::optional<CourseGround> ground = std::nullopt;  ///< if a surface was handed in
};

/// The inputs of a check: the attempt, its rules and the findings on its receivers.
struct CheckInput {
    const Attempt& attempt;
    const std::vector<Profile>& profiles;
    const ReceiverFindings& judged;
    const ReceiverFindings* secondary = nullptr;  ///< null if there is only one receiver
    const MeasuredSeries* wind = nullptr;         ///< null if the attempt gives none
    const MeasuredSeries* current = nullptr;
};

/// Every requirement of each profile (met, not met or to be attested), and the outcome.
///
/// A profile's clauses are complemented by those of the program itself (`own_clauses`).
///
/// Until officials have answered for second files these can only contradict. The verdict with them
/// is given beside that one where it differs. One with a worse outcome stands at once.
///
/// The outcome is not_certifiable in any of these cases:
/// - a requirement that the data decide, other than the margin, is not met;
/// - there is no certifiable window;
/// - more than 1 % of the recording's records, or one inside the window, could not be read;
/// - the rule subtracts the current and it is unknown;
/// - a robust estimate or the lack of one, a witness, or a declared second method contradicts the
///   speed.
///
/// Otherwise `decide` compares the speed with the record, and without a record the outcome is
/// not_proven. A speed below the record's is also not_certifiable where a refused window shows one
/// that reaches it: rejected data never lead to not_beaten. Figures are rounded for readers after
/// that. The caller sets the header.
Verdict check(const CheckInput& input);

}  // namespace runcert
