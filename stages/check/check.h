#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"
#include "schemas/verdict/verdict.h"
#include "schemas/windows/windows.h"
#include "stages/check/wind.h"

namespace runcert {

/// What the earlier stages say of one receiver.
struct ReceiverFindings {
    std::string receiver;
    RecordingFacts facts;
    std::string accuracy_source;
    std::string format = {};                   ///< of the recording
    std::string time_origin = {};              ///< what its time stamps are, in words
    std::vector<std::string> written_by = {};  ///< what it says of the programs that made it
    bool simulated = false;                    ///< it says so itself
    std::optional<Processing> processing = std::nullopt;       ///< how its positions were solved
    SolutionSource solution_source = SolutionSource::unknown;  ///< who says the fix type
    RecordCount records = {};
    ScreeningSummary screening;
    ScreeningBasis tests;
    EstimationSummary estimation;
    Windows windows;
    std::optional<FrameOrigin> origin = std::nullopt;  ///< of the trajectory
    std::vector<TrajectoryEpoch> trajectory = {};
    /// The screened epochs of each profile's best window, by the profile's id.
    std::map<std::string, std::vector<ScreenedEpoch>> window_epochs = {};

    const std::vector<ScreenedEpoch>& epochs_of(const std::string& profile) const {
        static const std::vector<ScreenedEpoch> none;
        const auto found = window_epochs.find(profile);
        return found == window_epochs.end() ? none : found->second;
    }
};

/// What is gathered from the screened epochs, one by one.
struct ScreenedSelection {
    ScreeningSummary summary;
    /// Of the best window of each profile.
    std::map<std::string, std::vector<ScreenedEpoch>> window_epochs;

    void add(const ScreenedEpoch& row, const Windows& windows);
};

struct CheckInput {
    const Attempt& attempt;
    const std::vector<Profile>& profiles;
    const ReceiverFindings& judged;
    const ReceiverFindings* secondary = nullptr;  ///< null where there is one receiver only
    const MeasuredSeries* wind = nullptr;         ///< null where the attempt gives none
    const MeasuredSeries* current = nullptr;
};

/// Every requirement of each profile, met, not met or to be attested, and the outcome.
///
/// Beside a profile's clauses those of the program itself (`own_clauses`).
///
/// not_certifiable if a requirement that the data decide, other than the margin, is not met, if
/// there is no certifiable window, if more than 1 % of the recording's records, or one inside the
/// window, could not be read, if the rule subtracts the current and it is not known, or if a robust
/// estimate, or the lack of one, a witness or a declared second method contradicts its
/// speed; else by `decide` against the record, not_proven without one. A speed below the record's
/// is not_certifiable too where a window that was refused shows one that reaches it: not_beaten is
/// never said from what was thrown away. Figures are rounded, for
/// people, after that. The header is the caller's.
Verdict check(const CheckInput& input);

}  // namespace runcert
