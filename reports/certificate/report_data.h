#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "reports/certificate/phase_view.h"
#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/screened_phase/screened_phase.h"
#include "schemas/trajectory/trajectory.h"
#include "schemas/verdict/verdict.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// A file that the report vouches for.
struct ReportSubject {
    std::string role;  ///< "attempt", "recording", "profile", "observations", ...
    std::string file;  ///< name in the run folder
    std::string sha256;
    std::uint64_t bytes = 0;
    std::string original;  ///< the name it was handed in under; empty where it is the same
};

/// What the stages found for one receiver.
struct ReceiverResults {
    Observations observations;  ///< its rows are not looked at and may be left out
    Header enu_header;
    ScreenedTable screened;
    std::optional<ScreenedPhaseTable> phases = {};  ///< without its rows
    /// What the phases say around the first certified window, for its figures.
    std::optional<PhaseView> phase_view = {};
    TrajectoryTable trajectory;
    Windows windows;
};

/// A whole run folder, as the report needs it.
struct ReportInputs {
    Attempt attempt;
    std::vector<Profile> profiles;           ///< in the order of the verdict's
    std::vector<ReceiverResults> receivers;  ///< in the order of the attempt's; the first is judged
    Verdict verdict;
    std::vector<ReportSubject> subjects;  ///< in the order in which they are to be listed
};

}  // namespace runcert
