#pragma once

#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"
#include "stages/window/speed_by_definition.h"

namespace runcert {

/// External reliability of a window's speed [Baarda68]: for each hypothesis that screening
/// tests, the error that its test finds with no more than the stated power and that changes the
/// speed most, over all epochs of the stretch and all directions. Largest effect first.
///
/// An error e of the measurements moves the speed by g'e, g being the speed's sensitivity to each
/// measurement under the estimate's own model; of all errors that the test finds with the power,
/// the largest |g'e| is sqrt(lambda g' Q g), Q being the covariance of the error's estimate under
/// the model of screening and lambda the non-centrality. An error that the stretch cannot show at
/// all, but that moves the speed, is put at 1e6.
///
/// `arc` must be that of the stretch in the table; `weights` are those of the speed, one for each
/// epoch of the stretch.
template <int Axes>
std::vector<UndetectedError> undetected_errors(const ScreenedTable& screened, const Arc<Axes>& arc,
                                               const WindowStretch<Axes>& stretch,
                                               std::span<const PositionVector<Axes>> weights);

}  // namespace runcert
