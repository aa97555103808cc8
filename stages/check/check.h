#pragma once

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

namespace runcert {

/// What the earlier stages say of one receiver; the facts of its tables, not their rows.
struct ReceiverEvidence {
    std::string receiver;
    RecordingFacts facts;
    std::string accuracy_source;
    ScreeningSummary screening;
    EstimationSummary estimation;
    Windows windows;
};

struct CheckInput {
    const Attempt& attempt;
    const std::vector<Profile>& profiles;
    const ReceiverEvidence& judged;
    const ReceiverEvidence* secondary = nullptr;  ///< null where there is one receiver only
};

/// Every requirement of each profile, met, not met or for a person to attest, and the outcome.
///
/// not_certifiable if a requirement that the data decide, other than the margin, is not met, or if
/// there is no certifiable window; else by `decide` against the record, not_proven without one. The
/// header is the caller's.
Verdict check(const CheckInput& input);

}  // namespace runcert
