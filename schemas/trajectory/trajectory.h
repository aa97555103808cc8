#pragma once

#include "schemas/trajectory/declared.h"

namespace runcert {

/// Whether the positions are offset by an unknown constant from this epoch on: a bridged step.
inline bool begins_after_step(const TrajectoryEpoch& row) {
    return row.step_before.value_or(false);
}

}  // namespace runcert
