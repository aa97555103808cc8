#include "stages/window/window_quality.h"

#include <algorithm>
#include <cmath>

#include "schemas/observations/stated_covariance.h"
#include "stages/window/position_speed.h"
#include "stages/window/sample_series.h"

namespace runcert {
namespace {

/// The stated variance of an epoch's position (m^2), in the dimension that the profile counts, and
/// not below the square of the floor that it sets for the fix type.
double stated_variance(const ScreenedEpoch& row, const Profile& profile) {
    const double floor_m = error_floor_m(profile.uncertainty, row.fix).value_or(0.0);
    const double least = floor_m * floor_m;
    const double level = std::max(least, 0.5 * stated_covariance<2>(row).trace());
    const double upright = std::max(least, stated_covariance<1>(row).trace());
    if (profile.dimension == Dimension::horizontal) return level;
    return profile.dimension == Dimension::vertical ? upright : std::max(level, upright);
}

/// The largest undetected error of a single epoch, or of a step just before it, m.
double missed_at(const ScreenedEpoch& row, Dimension dimension) {
    const MinimalDetectableBias& level = row.detectable;
    const double horizontal = std::max(level.outlier_m.value_or(0.0), level.step_m.value_or(0.0));
    const double vertical =
        std::max(level.outlier_up_m.value_or(0.0), level.step_up_m.value_or(0.0));
    if (dimension == Dimension::horizontal) return horizontal;
    return dimension == Dimension::vertical ? vertical : std::max(horizontal, vertical);
}

}  // namespace

bool WindowQuality::no_better_than(const WindowQuality& other) const {
    constexpr double hardly = 0.9;
    return stated >= hardly * other.stated && missed >= hardly * other.missed &&
           (witnesses & ~other.witnesses) == 0;
}

WindowQualities::WindowQualities(const ScreenedTable& screened, const std::vector<ArcRows>& arcs,
                                 const Profile& profile)
    : arcs_(arcs), sums_{{}} {
    for (const ScreenedEpoch& row : screened.rows) {
        Sums sums = sums_.back();
        if (profile.speed_source == SpeedSource::velocity) {
            const auto speed = recorded_speed(row, profile.dimension);
            const bool states = speed && speed->standard_uncertainty_m_s;
            sums.stated += states ? std::pow(*speed->standard_uncertainty_m_s, 2) : 0.0;
            sums.silent += !states;
            sums.usable += states;
        } else if (row.usable) {
            sums.stated += stated_variance(row, profile);
            sums.missed += std::pow(missed_at(row, profile.dimension), 2);
            ++sums.usable;
        }
        sums_.push_back(sums);
    }
}

WindowQuality WindowQualities::operator()(const FoundWindow& found) const {
    const std::vector<std::size_t>& rows = arcs_[found.series].rows;
    const Sums& before = sums_[rows[found.first]];
    const Sums& after = sums_[rows[found.last] + 1];
    const auto usable =
        static_cast<double>(std::max<std::int64_t>(1, after.usable - before.usable));
    const auto mean_of = [&](double Sums::*square) {
        return std::sqrt(std::max(0.0, after.*square - before.*square) / usable);
    };
    return {.stated = mean_of(&Sums::stated),
            .missed = mean_of(&Sums::missed),
            .silent = after.silent > before.silent};
}

}  // namespace runcert
