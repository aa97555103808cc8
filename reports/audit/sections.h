#pragma once

#include <string>
#include <vector>

#include "reports/audit/record.h"
#include "reports/results/results.h"

// The parts of a walk; `walk_through` puts them together.

namespace runcert {

/// What is told of a product, beneath where it came from.
struct ProductPart {
    std::string contents;  ///< what is in it: "601 epochs"
    std::vector<Block> blocks;
};
using PartOf = ProductPart(const RunRecord& record, const ReceiverResults& one, Level level);

/// Of each product that is there.
PartOf observations_part, phase_part, imu_part, surface_part, enu_part, screened_part,
    screened_phase_part, trajectory_part, attitude_part, windows_part, verdict_part;

}  // namespace runcert
