#pragma once

#include "core/uncertainty.h"
#include "schemas/attempt/attempt.h"
#include "schemas/trajectory/trajectory.h"
#include "stages/window/position_noise.h"
#include "stages/window/window.h"

namespace runcert {

struct SurveyedLength {
    double length_m = 0.0;
    double standard_uncertainty_m = 0.0;
};

/// What the budget of a window's speed is made from.
struct BudgetInput {
    const TrajectoryTable& trajectory;
    const WindowConfig& config;
    const PositionNoise& noise;
    const ErrorBound& bound;
    const SelectionBias& selection;

    std::size_t first_row = 0;  ///< of the window, in the trajectory
    std::size_t last_row = 0;
    double duration_s = 0.0;
    bool vertical = false;  ///< of heights alone
    /// Where the speed is a surveyed length over time: the length and its standard uncertainty.
    std::optional<SurveyedLength> length = std::nullopt;
    std::vector<UndetectedError> reliability = {};  ///< largest first
    double detection_power = 0.0;
};

/// What a row says of its correlation where there is none.
inline constexpr const char* independent_of_other_rows = "independent of the other rows";

/// A row whose quantity is the speed itself (m/s), of a normal distribution.
BudgetRow speed_row(std::string symbol, std::string source, std::string type,
                    double contribution_m_s, std::string correlation, std::string note);

/// Every source of uncertainty of the measured speed, one row each; those that contribute nothing
/// are there too, with the reason. The sources are independent of one another; what is correlated
/// (the positions of the epochs) is combined before, from their joint covariance.
std::vector<BudgetRow> budget_of(const BudgetInput& input);

/// The rows combined by the law of propagation of uncertainty [GUM].
CombinedUncertainty combine(const std::vector<BudgetRow>& rows);

/// What of the uncertainty another receiver or method does not share: noise and motion, the
/// time-correlated error of this receiver alone, time stamps, resolution and antenna. Left out are
/// the frame and the clock's rate, which the two may have in common, a bound that allows for more
/// than one receiver's own time-correlated error, and what the comparison is there to find.
double own_uncertainty(const PositionNoise& noise, const std::vector<BudgetRow>& rows);

/// Distributions propagated through the measurement model [GUM-S1]: the speed is the length of the
/// displacement, disturbed along and across its direction, over a time disturbed by its stamps,
/// times a scale disturbed by frame and plane.
MonteCarloCheck monte_carlo(const BudgetInput& input, const std::vector<BudgetRow>& rows,
                            double speed_m_s);

}  // namespace runcert
