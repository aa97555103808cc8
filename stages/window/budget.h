#pragma once

#include <initializer_list>

#include "core/uncertainty.h"
#include "schemas/attempt/attempt.h"
#include "schemas/trajectory/declared.h"
#include "stages/window/craft_speeds.h"
#include "stages/window/position_speed.h"
#include "stages/window/window.h"
#include "stages/window/window_fault.h"

namespace runcert {

/// The surveyed length of a course on the ground, as the attempt states it. Its standard
/// uncertainty is half the stated expanded one (k = 2).
struct SurveyedLength {
    double length_m = 0.0;
    double standard_uncertainty_m = 0.0;
};

/// What the budget takes from recorded velocities where the speed is theirs, in place of rows by
/// positions.
struct RecordedSource {
    std::vector<BudgetRow> rows;  ///< of the errors that the velocities have of their own
    double resolution_m_s = 0.0;  ///< of the recorded speeds
    double delay_s = 0.0;         ///< behind the positions
    double sigma_delay_s = 0.0;   ///< its standard uncertainty
    /// Change of the speed (m/s^2) if the window begins later: that of the speeds at both ends.
    /// Set only where places determine where it begins.
    std::optional<double> changes_m_s2 = std::nullopt;
    std::string undetected;  ///< where the size of their undetected error comes from
};

/// The inputs to the budget of a window's speed. Positions are east, north and up in the
/// trajectory's local frame, or engineering coordinates where it is not georeferenced.
struct BudgetInput {
    const TrajectoryTable& trajectory;
    const WindowConfig& config;
    const PositionSpeed& measured;
    const ErrorBound& bound;
    const SelectionBias& selection;

    /// The window's first and last row, both included.
    std::size_t first_row = 0;  ///< of the window, as an index into the trajectory
    std::size_t last_row = 0;
    /// Duration of the window, above 0.
    double duration_s = 0.0;
    double mean_interval_s = 0.0;  ///< of the recording's regular steps; 0 where it is not known
    bool vertical = false;         ///< the speed comes from heights alone
    /// Set where the speed is a surveyed length over time.
    std::optional<SurveyedLength> length = std::nullopt;
    std::vector<UndetectedError> reliability = {};  ///< largest first
    /// Probability with which the tests detect an error as large as `reliability` states, 0 to 1.
    double detection_power = 0.0;
    WindowFault fault = {};  ///< an undetected error
    bool by_path = false;    ///< the speed grows with every swing of the antenna
    /// Set where the speed is that of the craft's reference point.
    std::optional<CraftCorrection> craft = std::nullopt;
    std::optional<RecordedSource> recorded = std::nullopt;
    /// Factor on the rows of the positions when combined with witnesses (`combine_with_witnesses`).
    double position_share = 1.0;
};

/// A row of a normally distributed quantity with infinite degrees of freedom and the estimate 0.
/// `type` is "A" or "B" as in [GUM] 4.2 and 4.3.
BudgetRow quantity_row(std::string symbol, std::string source, std::string type,
                       double standard_uncertainty, std::string unit, double sensitivity,
                       RowScope touches, std::string note);

/// Such a row whose quantity is the speed itself (m/s): its sensitivity is 1.
BudgetRow speed_row(std::string symbol, std::string source, std::string type,
                    double contribution_m_s, RowScope touches, std::string note);

/// A row of a quantity known to lie within a half width: rectangular distribution, type B, estimate
/// 0.
BudgetRow bounded_row(std::string symbol, std::string source, double half_width, std::string unit,
                      double sensitivity, RowScope touches, std::string note);

/// Multiplies what a row contributes by a factor, not negative.
void scale(BudgetRow& row, double factor);

/// The uncertainty budget of the measured speed, with one row for each source. Sources without a
/// contribution are included, with the reason. The sources are independent of one another. What is
/// correlated (the positions of the epochs) is combined beforehand, from their joint covariance.
///
/// The symbols, in this order: w white noise, b time-correlated error, j motion, o choice of the
/// motion model, t time stamps, k clock rate, r resolution, m frame or plumb line, h stated height
/// (only where heights were not measured), c surveyed length (only where there is one), a antenna
/// (where an IMU tells the craft's speed: the distances on it, y its attitude, z its clock),
/// q calibration (only where its certificate states an uncertainty of speed), d undetected error, f
/// choice of the fastest window. Of recorded velocities: w white noise, b errors shorter than ten
/// seconds, u lasting errors, p their scale, t, l delay, k, r, q, d, f. Witnesses add rows g, e and
/// s (`combine_with_witnesses`) and x, what the mixture of faults asks for beyond all others. Each
/// row has the unit of its own quantity; all contributions are in m/s. Quantities known by a half
/// width are rectangular ([GUM] 4.3.7).
///
/// The half width of the horizontal frame's scale is half the square of the distance from the
/// origin in Earth radii. Without a georeference it is `config.plane_scale_bound`. That of a stated
/// height is `config.height_bound_m`; lengths grow with height by one over the Earth's radius.
std::vector<BudgetRow> budget_of(const BudgetInput& input);

/// The rows combined as independent quantities by the law of propagation of uncertainty ([GUM]
/// (10)), in m/s, with effective degrees of freedom ([GUM] (G.2b)). Calibration does not count in
/// these: its infinite ones would make the coverage factor smaller, and a certificate that the
/// claimant types may not make the expanded uncertainty smaller. Failure as for `combine` in
/// core/uncertainty.h.
CombinedUncertainty combine(const std::vector<BudgetRow>& rows);

/// The part of the uncertainty that another receiver or method does not share: noise and motion,
/// this receiver's own time-correlated error, time stamps, resolution and antenna. It leaves out
/// the frame and the clock rate, which both may have in common, and errors that the comparison is
/// meant to reveal. Standard uncertainty in m/s: the root of the sum of squares of these rows.
double own_uncertainty(const std::vector<BudgetRow>& rows);

/// Standard uncertainty (m/s) from the rows that touch one of these.
double uncertainty_of(const std::vector<BudgetRow>& rows, std::initializer_list<RowScope> touching);

/// Propagation of distributions through the measurement model [GUM-S1]. The speed is the length of
/// the displacement, disturbed along and across its direction, over a time disturbed by its stamps,
/// times a scale disturbed by frame and plane. With heights alone nothing is disturbed across, and
/// the plumb line's row is added like the others.
///
/// `rows` come from `budget_of`, and `speed_m_s` is the speed that they belong to. Rectangular rows
/// are drawn as such, the others from Student's t with the row's degrees of freedom (normal where
/// infinite). The limits are those of the probabilistically symmetric 95 % interval (m/s). The same
/// seed gives the same figures. Failure as for `propagate` in core/monte_carlo.h. Non-convergence
/// is reported in the result.
MonteCarloCheck monte_carlo(const BudgetInput& input, const std::vector<BudgetRow>& rows,
                            double speed_m_s);

}  // namespace runcert
