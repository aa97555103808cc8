#pragma once

#include "core/uncertainty.h"
#include "schemas/attempt/attempt.h"
#include "schemas/trajectory/trajectory.h"
#include "stages/window/combination.h"
#include "stages/window/position_noise.h"
#include "stages/window/window.h"

namespace runcert {

/// The surveyed length of a course on the ground, as the attempt states it. Its standard
/// uncertainty is half the expanded one that the attempt states (k = 2).
struct SurveyedLength {
    double length_m = 0.0;
    double standard_uncertainty_m = 0.0;
};

/// What the budget of a window's speed is made from. Positions are east, north and up in the
/// trajectory's local frame, or engineering coordinates where it is not georeferenced.
struct BudgetInput {
    const TrajectoryTable& trajectory;
    const WindowConfig& config;
    const PositionNoise& noise;
    const ErrorBound& bound;
    const SelectionBias& selection;

    /// The window's first and last row, both part of it.
    std::size_t first_row = 0;  ///< of the window, in the trajectory
    std::size_t last_row = 0;
    /// Of the window, above 0.
    double duration_s = 0.0;
    bool vertical = false;  ///< of heights alone
    /// Where the speed is a surveyed length over time: the length and its standard uncertainty.
    std::optional<SurveyedLength> length = std::nullopt;
    std::vector<UndetectedError> reliability = {};  ///< largest first
    /// Probability with which the tests find an error as large as `reliability` states, 0 to 1.
    double detection_power = 0.0;
    WindowFault fault = {};  ///< an error that nothing found
    /// By how much the rows of the positions count beside a witness (`condition_on`).
    double position_share = 1.0;
};

/// What a row says of its correlation where there is none.
inline constexpr const char* independent_of_other_rows = "independent of the other rows";

/// A row whose quantity is the speed itself (m/s), of a normal distribution with infinitely many
/// degrees of freedom: estimate 0, sensitivity 1. `contribution_m_s` is its standard uncertainty,
/// `type` is "A" or "B" as in [GUM] 4.2 and 4.3.
BudgetRow speed_row(std::string symbol, std::string source, std::string type,
                    double contribution_m_s, std::string correlation, std::string note);

/// A row of a quantity known to lie within a half width: rectangular, type B, estimate 0.
BudgetRow bounded_row(std::string symbol, std::string source, double half_width, std::string unit,
                      double sensitivity, std::string note);

/// Row t, time stamps of a displacement's ends.
BudgetRow time_row(const BudgetInput& input);

/// Row k, the rate of the clock that made the stamps. A clock that is the satellites' has none that
/// counts over a window.
BudgetRow clock_row(const BudgetInput& input);

/// Every source of uncertainty of the measured speed, one row each; those that contribute nothing
/// are there too, with the reason. The sources are independent of one another; what is correlated
/// (the positions of the epochs) is combined before, from their joint covariance.
///
/// The symbols, in this order: w white noise, b time-correlated error, j motion, o choice of the
/// motion's model, t time stamps, k clock rate, r resolution, m frame or plumb line, h typed height
/// (only where heights were not measured), c surveyed length (only where there is one), a antenna,
/// d undetected error, f choice of the fastest. Each row has the unit of its own quantity; all
/// contributions are in m/s. Quantities known by a half width are rectangular ([GUM] 4.3.7).
///
/// The half width of the horizontal frame's scale is half the square of the distance from the
/// origin in Earth radii; without a georeference it is `config.plane_scale_bound`. That of a typed
/// height is `config.height_bound_m`; lengths grow with it by one over the Earth's radius.
std::vector<BudgetRow> budget_of(const BudgetInput& input);

/// The rows combined as independent ones by the law of propagation of uncertainty ([GUM] (10)), in
/// m/s, with effective degrees of freedom ([GUM] (G.2b)). Failure as of `combine` in
/// core/uncertainty.h.
CombinedUncertainty combine(const std::vector<BudgetRow>& rows);

/// What of the uncertainty another receiver or method does not share: noise and motion, the
/// time-correlated error of this receiver alone, time stamps, resolution and antenna. Left out are
/// the frame and the clock's rate, which the two may have in common, a bound that allows for more
/// than one receiver's own time-correlated error, and what the comparison is there to find.
/// Standard uncertainty in m/s: the root of the sum of squares of the rows w, j, o, t, r and a, and
/// of `noise.own_correlated_m_s`.
double own_uncertainty(const PositionNoise& noise, const std::vector<BudgetRow>& rows);

/// Distributions propagated through the measurement model [GUM-S1]: the speed is the length of the
/// displacement, disturbed along and across its direction, over a time disturbed by its stamps,
/// times a scale disturbed by frame and plane. Of heights alone nothing is disturbed across, and
/// the plumb line's row is added like the others.
///
/// `rows` are those of `budget_of`, `speed_m_s` is the speed that they belong to. Rectangular rows
/// are drawn so, the others from Student's t with the row's degrees of freedom (normal where
/// infinite). The limits are those of the probabilistically symmetric 95 % interval (m/s). The same
/// seed gives the same figures. Failure as of `propagate` in core/monte_carlo.h; not converged is
/// told in the result.
MonteCarloCheck monte_carlo(const BudgetInput& input, const std::vector<BudgetRow>& rows,
                            double speed_m_s);

/// Row f: what is known no better of the bias (m/s) of choosing the fastest window. `between` says
/// its limits; the bias itself is no row, and what may remain of it is added to the expanded
/// uncertainty. `subtracted_m_s`: what was taken off the speed; nothing where the rule has the bias
/// covered.
BudgetRow choice_row(const std::string& between, double uncertainty_m_s, std::int64_t candidates,
                     const std::optional<double>& subtracted_m_s);

}  // namespace runcert
