#pragma once

#include <nlohmann/json.hpp>

#include "reports/certificate/report_data.h"

namespace runcert {

/// The noise estimated, and whether filter and smoother behaved by it, as shown: a column for the
/// horizontal axes and one for the vertical one where heights were measured. Null where the run's
/// files do not say it.
nlohmann::ordered_json noise_table(const EstimationSummary& estimation);

}  // namespace runcert
