#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/monte_carlo.h"
#include "stages/window/budget.h"

namespace runcert {
namespace {

const BudgetRow& row_of(const std::vector<BudgetRow>& rows, std::string_view symbol) {
    return *std::find_if(rows.begin(), rows.end(),
                         [&](const BudgetRow& row) { return row.symbol == symbol; });
}

/// The distribution of a row's quantity.
class DrawnRow {
  public:
    explicit DrawnRow(const BudgetRow& row)
        : none_(row.contribution_m_s == 0.0),
          rectangular_(row.distribution == "rectangular"),
          degrees_of_freedom_(row.degrees_of_freedom),
          standard_uncertainty_(row.standard_uncertainty),
          sensitivity_(row.sensitivity) {}

    /// Draws one deviation of the quantity.
    double deviation(RandomGenerator& random) const {
        if (none_) return 0.0;
        const double unit = rectangular_ ? draw_rectangular(random, std::numbers::sqrt3)
                                         : draw_student_t(random, degrees_of_freedom_);
        return unit * standard_uncertainty_;
    }
    double speed_m_s(RandomGenerator& random) const { return deviation(random) * sensitivity_; }

  private:
    bool none_;
    bool rectangular_;
    std::optional<double> degrees_of_freedom_;
    double standard_uncertainty_;
    double sensitivity_;
};

}  // namespace

MonteCarloCheck monte_carlo(const BudgetInput& input, const std::vector<BudgetRow>& rows,
                            double speed_m_s) {
    // Across the direction of travel only the positions disturb, by as much as along it.
    const double across =
        input.vertical ? 0.0 : input.position_share * input.measured.speed.standard_uncertainty_m_s;
    const double duration_s = input.duration_s;
    const DrawnRow time(row_of(rows, "t"));
    const DrawnRow scale(row_of(rows, "m"));
    std::vector<DrawnRow> of_speed;
    for (const BudgetRow& row : rows)
        if (row.symbol != "t" && (row.symbol != "m" || input.vertical)) of_speed.emplace_back(row);
    const MonteCarloOptions options{.seed = static_cast<std::uint64_t>(input.config.seed),
                                    .trials_max = input.config.monte_carlo_trials_max};
    const MonteCarloResult result = propagate(options, [&](RandomGenerator& random) {
        double along_m_s = speed_m_s;
        for (const DrawnRow& row : of_speed)
            along_m_s += row.speed_m_s(random);
        const double across_m_s = across * random.normal();
        const double time_s = duration_s + time.deviation(random);
        const double factor = input.vertical ? 1.0 : 1.0 + scale.deviation(random);
        return std::hypot(along_m_s, across_m_s) * duration_s / time_s * factor;
    });
    return {.seed = input.config.seed,
            .trials = result.trials,
            .mean_m_s = result.mean,
            .standard_uncertainty_m_s = result.standard_uncertainty,
            .lower_m_s = result.symmetric.lower,
            .upper_m_s = result.symmetric.upper,
            .tolerance_m_s = result.tolerance,
            .converged = result.converged};
}

}  // namespace runcert
