#pragma once

#include <span>

#include "simulated_arc.h"
#include "stages/screen/screen.h"

namespace runcert {

/// An error that is put into a recording: outlier, burst, step, ramp or time_shift.
struct SupposedError {
    Hypothesis kind = Hypothesis::outlier;
    std::size_t first = 0;                           ///< index of the first outlier
    std::size_t epochs = 1;                          ///< of a burst
    Eigen::Vector2d size = Eigen::Vector2d::Zero();  ///< m; m/s for a ramp
    double late_s = 0.0;                             ///< of a time_shift: by what stamps are late

    /// The last epoch that is wrong by itself: of a step, ramp or shift the first.
    std::size_t last() const { return first + epochs - 1; }
};

/// The recording as it was measured, with these errors.
ScreenedTable with_errors(const SimulatedRecording& recording,
                          std::span<const SupposedError> errors);

/// The same before screening.
EnuTable to_be_screened(const ScreenedTable& table);

/// What screening made of an error.
struct Judgement {
    bool found = false;  ///< something is marked there: left out, or a break within one epoch
    bool dated = false;  ///< a break within one epoch of its beginning
    bool named = false;  ///< as what it is; of a burst, every epoch is left out
};

/// A shift of the stamps and a step along the motion are the same, and both are called either. A
/// ramp begins too gently to be dated: it is found by what is marked within a second.
Judgement judge(const ScreenedTable& screened, const SupposedError& error, double rate_hz);

/// How many epochs are not usable that no error made wrong.
std::int64_t wrongly_left_out(const ScreenedTable& screened, std::span<const SupposedError> errors);

/// True position of the craft so many seconds before an epoch.
Eigen::Vector2d true_position(const SimulatedRecording& recording, std::size_t k, double late_s);

/// An attempt in the class land-yacht, with that class's figures for every stage.
const Attempt& study_attempt();
ScreenConfig study_screen_config();

}  // namespace runcert
