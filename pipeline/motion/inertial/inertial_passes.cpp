#include "inertial/inertial_passes.h"

#include <algorithm>
#include <cmath>

namespace runcert {
namespace {

/// About each axis the attitude may turn by the greater of these in the last pass.
constexpr double settled_rad = 1e-3;
constexpr double settled_sigmas = 0.1;
constexpr int most_passes = 12;

/// The greatest turn of the attitude by the last pass, in units of what it may turn.
double turned_by(const InertialPass& pass) {
    double most = 0.0;
    for (std::size_t k = 0; k < pass.estimated.size(); ++k)
        for (int axis = 0; axis < 3; ++axis) {
            const double sigma = std::sqrt(pass.covariance[k](axis, axis));
            const double turned = std::abs(pass.estimated[k](error_state::attitude + axis));
            most = std::max(most, turned / std::max(settled_rad, settled_sigmas * sigma));
        }
    return most;
}

}  // namespace

Passes run_passes(const InertialData& data, const InertialPrior& prior,
                  std::vector<InertialNominal> about) {
    Passes passes;
    const std::size_t count = data.fixes.size();
    while (passes.count < most_passes) {
        passes.last = {};  // its memory is free before that of the next is taken
        passes.last = filter_forwards(data, prior, about, count);
        smooth_backwards(passes.last, data);
        ++passes.count;
        passes.turned = turned_by(passes.last);
        if (passes.turned < 1.0 || passes.count == most_passes) break;
        about = passes.last.trajectory();
    }
    return passes;
}

}  // namespace runcert
