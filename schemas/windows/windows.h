#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/common/window_span.h"

namespace runcert {

/// The four definitions of a window's speed (m/s), from the smoothed trajectory.
struct SpeedDefinitions {
    double displacement_mps = 0.0;   ///< displacement over time
    double path_length_mps = 0.0;    ///< path length over time
    double mean_n_plus_1_mps = 0.0;  ///< mean of the N+1 speeds, both ends ([DHD22] (26))
    double mean_n_mps = 0.0;         ///< mean of the N speeds after the first

    /// The one of that name ("displacement", "path_length", "mean_n_plus_1", "mean_n").
    double by_name(std::string_view name) const;
};

/// Mean over the window of the speeds by each method (m/s); empty where a method has no value at
/// some epoch of it.
struct MethodMeans {
    std::optional<double> smoothed_mps, batch_mps, v1_mps, v2_mps, kalman_mps;
};

/// One source of uncertainty.
struct BudgetRow {
    std::string symbol;
    std::string source;  ///< what it is, in words
    double estimate = 0.0;
    std::string unit;  ///< of estimate and standard uncertainty
    double standard_uncertainty = 0.0;
    std::string type;                          ///< "A" or "B"
    std::string distribution;                  ///< "normal", "rectangular"
    std::optional<double> degrees_of_freedom;  ///< empty: infinite
    double sensitivity = 1.0;                  ///< m/s for one unit of the quantity
    double contribution_mps = 0.0;  ///< standard uncertainty of the speed from this source
    std::string correlation;        ///< with which other rows, or why none
    std::string note;               ///< where the figure comes from
};

/// The speed by the most likely noise models, their own uncertainty taken in.
struct FittedSpeed {
    double speed_mps = 0.0;
    double standard_uncertainty_mps = 0.0;
    std::int64_t models = 0;
};

/// What other estimates say of the same window (m/s): how much hangs on the model of the motion.
struct OtherEstimates {
    /// From the measured positions at the window's ends alone, by displacement over time: no model
    /// of the motion at all; and the standard uncertainty, from the positions' white noise, of its
    /// difference from the estimate. Absent for other definitions.
    std::optional<double> chord_mps = std::nullopt;
    std::optional<double> chord_difference_uncertainty_mps = std::nullopt;
    double stiffer_mps = 0.0;     ///< with jerk densities of a third (1 / sqrt(10)) of those used
    double softer_mps = 0.0;      ///< with three times those used (sqrt(10))
    double whole_mps = 0.0;       ///< with the one density fitted to the whole recording
    double half_width_mps = 0.0;  ///< what the choice of the model is taken to change at most
};

/// The bound on a position error whose correlation time is known only to lie in an interval.
struct ErrorBound {
    double tau_min_s = 0.0;
    double tau_max_s = 0.0;
    double sigma_m = 0.0;   ///< size taken: the largest of the three
    double fitted_m = 0.0;  ///< size of the fitted error at the shortest correlation time
    /// Size of the error along the direction of travel in units of the one fitted to both axes
    /// together, as it is taken in `fitted_m`: at least 1, at most sqrt(2).
    double along = 1.0;
    double stated_m = 0.0;                  ///< stated accuracy times its scale
    double floor_m = 0.0;                   ///< floor of the kind of solution
    std::string floor_fix;                  ///< that kind
    std::string decided_by;                 ///< "fitted", "stated", "floor"
    double standard_uncertainty_mps = 0.0;  ///< of the speed, from the positions alone
};

/// The speed by the batch with a robust loss.
struct RobustSpeed {
    double speed_mps = 0.0;
    double difference_mps = 0.0;  ///< against the screened solution with the same noise
    double limit_mps = 0.0;       ///< expanded uncertainty it must keep to
    bool agrees = false;
    std::int64_t downweighted = 0;  ///< epochs of the window whose weight is below one half
};

/// What choosing the fastest of many windows does.
struct SelectionBias {
    std::int64_t candidates = 0;   ///< windows that could have been the best
    double chosen_mean_mps = 0.0;  ///< true speed of the chosen window: mean, standard deviation
    double chosen_sd_mps = 0.0;
    double best_mean_mps = 0.0;  ///< true speed of the window that is truly best
    double best_sd_mps = 0.0;
    double fitted_bias_mps = 0.0;  ///< by errors as fitted, and with the slow error at its bound
    double bounded_bias_mps = 0.0;
    double bias_mps = 0.0;             ///< the middle of the two: stated speed less chosen_mean
    double bias_half_range_mps = 0.0;  ///< and half of what is between them
    double bias_uncertainty_mps = 0.0;
    std::string treatment;  ///< "covered", "subtracted"
    std::int64_t samples = 0;
    std::int64_t seed = 0;
};

/// Propagation of distributions [GUM-S1] through the same model as the budget.
struct MonteCarloCheck {
    std::int64_t seed = 0;
    std::int64_t trials = 0;
    double mean_mps = 0.0;
    double standard_uncertainty_mps = 0.0;
    double lower_mps = 0.0;  ///< ends of the 95 % interval, symmetric in probability
    double upper_mps = 0.0;
    double tolerance_mps = 0.0;  ///< numerical tolerance the figures have settled to
    bool converged = false;
};

/// An error of the largest size that screening finds with less than its stated power, and what it
/// does to the speed.
struct UndetectedError {
    std::string hypothesis;  ///< word of `Hypothesis`
    std::int64_t epoch = 0;  ///< first that has the error
    std::int64_t last_epoch = 0;
    double size = 0.0;
    std::string unit;        ///< of the size: "m", "m / s", "s"
    double speed_mps = 0.0;  ///< by how much it changes the speed
};

struct CertifiableWindow {
    WindowSpan span;
    std::int64_t arc = 0;
    double speed_mps = 0.0;                 ///< certified, by the profile's definition
    double standard_uncertainty_mps = 0.0;  ///< combined, of the budget
    std::optional<double> effective_degrees_of_freedom = std::nullopt;  ///< empty: infinite
    /// What of it another receiver or method does not share; since revision 1.4.
    std::optional<double> own_standard_uncertainty_mps = std::nullopt;
    /// What may remain of the bias of choosing the fastest window, either way. A bias is no
    /// standard deviation: it is added to the expanded uncertainty, not to the budget.
    double bias_limit_mps = 0.0;
    std::optional<FittedSpeed> fitted = std::nullopt;        ///< these since revision 1.1
    std::optional<OtherEstimates> estimates = std::nullopt;  ///< since revision 1.4
    std::optional<ErrorBound> bound = std::nullopt;
    std::optional<RobustSpeed> robust = std::nullopt;
    std::optional<SelectionBias> selection = std::nullopt;
    std::vector<BudgetRow> budget = {};
    std::optional<MonteCarloCheck> monte_carlo = std::nullopt;
    std::int64_t repaired_steps = 0;  ///< steps inside that were bridged; these since revision 1.2
    std::optional<double> detection_power = std::nullopt;
    std::vector<UndetectedError> reliability = {};  ///< the worst of each hypothesis, largest first
    /// That the speed is, over the duration; since revision 1.3.
    std::optional<double> length_m = std::nullopt;
    double displacement_m = 0.0;
    double position_r95_m = 0.0;  ///< 95 % radius of the position at the worse end
    SpeedDefinitions definitions;
    MethodMeans methods;
};

/// A window that makes the figure together with the best one.
struct FurtherWindow {
    WindowSpan span;
    std::int64_t arc = 0;
    double speed_mps = 0.0;
    double standard_uncertainty_mps = 0.0;
    double bias_limit_mps = 0.0;
    std::optional<RobustSpeed> robust = std::nullopt;
};

struct IndicatedWindow {
    WindowSpan span;
    double speed_mps = 0.0;  ///< by the rule's definition, of what the recording says
    /// Of the fastest windows that do not overlap, where the rule takes the mean of several.
    std::optional<double> mean_mps = std::nullopt;
    std::vector<std::string> refusals;
};

/// What a rule looked for, by the words of the profile's schema.
struct WindowRule {
    std::string kind = "time";
    double duration_s = 0.0;  ///< of kind time
    double distance_m = 0.0;  ///< of the others
    std::string definition;
    std::string dimension = "horizontal";
    std::string source = "position";
    std::string ends = "epochs";
    bool exact = false;
    std::int64_t count = 1;
    bool opposite_runs = false;

    bool operator==(const WindowRule&) const = default;
};

/// The speed that a rule counts.
struct RuleFigure {
    double speed_mps = 0.0;
    double standard_uncertainty_mps = 0.0;
    std::optional<double> effective_degrees_of_freedom = std::nullopt;  ///< empty: infinite
    double bias_limit_mps = 0.0;  ///< of a systematic error either way, beside that uncertainty
};

struct ProfileWindows {
    std::string profile;
    WindowRule rule;
    std::int64_t candidates = 0;
    std::string missing = {};  ///< why there is none, where breaks are not the reason
    std::optional<CertifiableWindow> best;
    std::vector<FurtherWindow> further = {};
    std::optional<IndicatedWindow> indicated;

    /// The best window's speed; of several, the mean, its uncertainty taken as if the errors of all
    /// were the same. Empty where there are too few.
    std::optional<RuleFigure> figure() const;
};

/// Whether the law of propagation and the draws through the same model agree ([GUM-S1] 8).
struct LinearisationJudgement {
    double lower_mps = 0.0;  ///< the budget's 95 % interval
    double upper_mps = 0.0;
    bool uncertainty_agrees = false;  ///< both standard uncertainties, within the tolerance
    bool interval_agrees = false;     ///< both intervals, at either end
    bool interval_holds = false;      ///< or the budget's holds that of the draws: the safe side
};

/// Of a window that has the check.
LinearisationJudgement judge_linearisation(const CertifiableWindow& window);

/// What is stated with a speed: `coverage_factor` standard uncertainties and, added to them, the
/// limit of a bias that is not known better.
template <class Speed>
double expanded_uncertainty_mps(const Speed& speed, double coverage_factor) {
    return coverage_factor * speed.standard_uncertainty_mps + speed.bias_limit_mps;
}

/// The same with the coverage factor that the rule's stands for at the speed's degrees of freedom.
double expanded_uncertainty_by_rule_mps(const CertifiableWindow& window, double rule_factor);
double expanded_uncertainty_by_rule_mps(const RuleFigure& figure, double rule_factor);

/// 5-windows.yaml, `schemas/windows/v1.yaml`.
struct Windows {
    Header header;
    std::string receiver;
    std::optional<GpsTime> first_epoch;
    bool georeferenced = true;
    std::vector<ProfileWindows> profiles;

    /// Those of the profile of that id; null where there are none.
    const ProfileWindows* of(std::string_view profile) const;
};

std::string write_windows(const Windows& windows);
Windows read_windows(std::string_view text, const std::string& where);

}  // namespace runcert
