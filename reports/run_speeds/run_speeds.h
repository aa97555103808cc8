#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "schemas/profile/profile.h"
#include "schemas/trajectory/declared.h"

namespace runcert {

/// A row's speed (m/s) of a dimension.
std::optional<double> speed_in(const TrajectoryEpoch& row, Dimension dimension);

/// The speed (m/s) over a rule's length that ends at each row, from the smoothed trajectory.
///
/// Over a time it is the mean of the epochs' speeds, both ends included, labelled with the last
/// ([DHD22] (26), (27)): of the stretch to the nearest epoch that is so far back or further. Over a
/// distance it is path over time. It is of the rule's dimension.
///
/// A row has none where its arc does not reach back so far, or a step of more than one and a half
/// nominal intervals lies in between. There is no row at all for a rule of another kind of window
/// (course, alpha).
std::vector<std::optional<double>> speeds_over_length(const TrajectoryTable& table,
                                                      const Profile& profile);

/// The speeds (m/s) of one method at the epochs of a window, as [DHD22] prints them.
struct MethodSpeeds {
    std::string_view method;  ///< in words
    std::int64_t epochs = 0;  ///< both ends included
    double mean_m_s = 0.0;
    double standard_deviation_m_s = 0.0;  ///< of a single speed, by n - 1

    /// Half the interval that holds 95 % of single speeds: 1.96 standard deviations.
    double half_width_m_s() const { return 1.96 * standard_deviation_m_s; }
};

/// Smoother, batch, v1, v2 and the forward filter, as far as they have a horizontal speed at every
/// epoch from one to another (their numbers). Nothing where these are not in the table, in that
/// order and at least two.
std::vector<MethodSpeeds> method_speeds(const TrajectoryTable& table, std::int64_t first_epoch,
                                        std::int64_t last_epoch);

}  // namespace runcert
