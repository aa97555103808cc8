#pragma once

#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"
#include "stages/window/instants.h"

namespace runcert {

/// External reliability of a window's speed [Baarda68]. For each hypothesis that screening tests,
/// it gives the error that changes the speed most among those that the test detects with no more
/// than the stated power. All epochs of the stretch and all directions are considered. The largest
/// effect comes first.
///
/// An error e of the measurements moves the speed by g'e, where g is the speed's sensitivity to
/// each measurement under the estimate's own model. Of all errors that the test detects with the
/// power, the largest |g'e| is sqrt(lambda g' Q g). Here Q is the covariance of the error's
/// estimate under the model of screening, and lambda the non-centrality. An error that moves the
/// speed but is entirely undetectable in the stretch is set to 1e6.
///
/// `arc` must be the stretch's arc in the table. `weights` are those of the speed, one for each
/// epoch of the stretch.
template <int Axes>
std::vector<UndetectedError> undetected_errors(const ScreenedTable& screened, const Arc<Axes>& arc,
                                               const WindowStretch<Axes>& stretch,
                                               std::span<const PositionVector<Axes>> weights);

}  // namespace runcert
