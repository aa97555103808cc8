#pragma once

#include <vector>

#include "estimation/smoother.h"
#include "schemas/screened/screened.h"

namespace runcert {

/// An arc, ready for estimation.
template <int Axes>
struct Arc {
    std::int64_t number = 0;
    std::vector<std::size_t> rows;       ///< indices into the table's rows
    std::vector<ArcEpoch<Axes>> epochs;  ///< one for each of these rows
};

/// Which epochs of an arc come with their measurement.
enum class Measurements {
    usable,            ///< those that screening kept
    before_rejection,  ///< and those that were rejected alone, as outliers
};

/// The arcs of a screened table, in order, of the horizontal positions (Axes 2), the heights alone
/// (1) or both together (3). Rejected epochs inside an arc are kept, without their
/// measurement. The covariances are those stated, unscaled.
template <int Axes>
std::vector<Arc<Axes>> arcs_of(const ScreenedTable& table,
                               Measurements measurements = Measurements::usable);

}  // namespace runcert
