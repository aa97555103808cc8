#pragma once

#include <nlohmann/json.hpp>

#include "reports/certificate/report_data.h"

namespace runcert {

/// The noise learnt for one set of axes, and whether filter and smoother behaved by it.
nlohmann::ordered_json axes_json(const AxesEstimation& axes);

/// The same as shown: a column for the horizontal axes and one for the vertical one where heights
/// were measured. Null where the run's files do not say it, as those of revision 1.0 do not.
nlohmann::ordered_json noise_table(const EstimationSummary& estimation);

}  // namespace runcert
