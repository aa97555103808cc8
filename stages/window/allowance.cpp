#include "stages/window/allowance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "schemas/observations/stated_covariance.h"
#include "stages/window/budget.h"
#include "stages/window/contradictions.h"
#include "stages/window/shares.h"
#include "stages/window/witnesses.h"
#include "witness/evidence.h"

namespace runcert {
namespace {

constexpr double nothing_assured = std::numeric_limits<double>::infinity();

/// The largest value of any consecutive range, in constant time.
class RangeMaximum {
  public:
    explicit RangeMaximum(std::vector<double> values) : tables_{std::move(values)} {
        for (std::size_t length = 1; 2 * length <= tables_.front().size(); length *= 2) {
            const std::vector<double>& shorter = tables_.back();
            std::vector<double> longer(shorter.size() - length);
            for (std::size_t i = 0; i < longer.size(); ++i)
                longer[i] = std::max(shorter[i], shorter[i + length]);
            tables_.push_back(std::move(longer));
        }
    }

    /// The largest of the values first to last, both included.
    double operator()(std::size_t first, std::size_t last) const {
        std::size_t power = 0;
        while ((std::size_t{2} << power) <= last - first + 1)
            ++power;
        const std::vector<double>& table = tables_[power];
        return std::max(table[first], table[last + 1 - (std::size_t{1} << power)]);
    }

  private:
    std::vector<std::vector<double>> tables_;
};

/// Running sums over rows. `sum(first, last)` includes both ends.
class RunningSum {
  public:
    void add(double value) { sums_.push_back(sums_.back() + value); }
    double operator()(std::size_t first, std::size_t last) const {
        return sums_[last + 1] - sums_[first];
    }

  private:
    std::vector<double> sums_{0.0};
};

/// The stated variance of an epoch's position, in the dimension that the profile counts.
double stated_variance(const ScreenedEpoch& row, Dimension dimension) {
    const double level = 0.5 * stated_covariance<2>(row).trace();
    const double upright = stated_covariance<1>(row).trace();
    if (dimension == Dimension::horizontal) return level;
    return dimension == Dimension::vertical ? upright : std::max(level, upright);
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

/// The parts of the reference's uncertainty, by how they scale; m/s.
struct ReferenceFigures {
    double own = 0.0;  ///< of the positions, without time-correlated and undetected errors
    double slow = 0.0;
    double undetected = 0.0;
    FaultPrior fault = {};
    double chosen = 0.0;  ///< its probability for a window chosen among rivals
    double others = 0.0;  ///< parts that are the same for every window
    double bias_limit = 0.0;
    double stated_m = 0.0;
    double missed_m = 0.0;
    double duration_s = 0.0;
};

double contribution(const std::vector<BudgetRow>& rows, std::string_view symbol) {
    const auto row = std::ranges::find(rows, symbol, &BudgetRow::symbol);
    return row == rows.end() ? 0.0 : row->contribution_m_s;
}

/// A recording's epochs, prepared for queries on any window.
class Expectation {
  public:
    Expectation(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                const std::vector<ArcRows>& arcs, const Profile& profile,
                const Reference& reference, const HeardWitnesses<2>& level,
                const HeardWitnesses<1>& upright, AskedWitnesses asked,
                std::span<const Contradiction> contradictions)
        : trajectory_(trajectory),
          arcs_(arcs),
          profile_(profile),
          asked_(asked),
          level_(asked_of(level)),
          upright_(asked_of(upright)),
          contradictions_(contradictions.begin(), contradictions.end()),
          missed_(missed_of(screened, profile.dimension)) {
        for (const ScreenedEpoch& row : screened.rows) {
            stated_.add(row.usable ? stated_variance(row, profile.dimension) : 0.0);
            usable_.add(row.usable ? 1.0 : 0.0);
        }
        if (const auto& bound = reference.window.bound)
            floor_m_ = std::max({bound->floor_m, bound->fitted_m, bound->standing_m.value_or(0.0)});
        set_reference(reference);
        for (const WitnessedSpeed& one : reference.window.witnesses)
            if (contradicts(one) && is_asked(one)) contradicting_.push_back(one);
    }

    double operator()(const FoundWindow& found) const {
        const auto [first, last] = rows_of(found);
        const double duration_s = found.end.seconds() - found.start.seconds();
        const double shorter = reference_.duration_s / duration_s;
        const double by_errors = shorter * error_m(first, last) / reference_.stated_m;
        const double by_missed =
            reference_.missed_m > 0.0 ? shorter * missed_(first, last) / reference_.missed_m : 0.0;
        PositionTerms positions{.own_m_s = reference_.own * by_errors,
                                .slow_m_s = reference_.slow * by_errors,
                                .fault_m_s = reference_.undetected * by_missed};
        WindowFault fault{.prior = reference_.fault, .chosen_probability = reference_.chosen};
        fault.prior.largest_m_s *= by_missed;
        std::vector<WitnessedSpeed> witnessed = witnessed_at(found, positions, fault.prior);
        if (const auto* by = suspected_by(contradictions_, found, witnessed)) {
            suspect(*by, fault);
            positions.fault_m_s = fault.standard_uncertainty_m_s();
            witnessed = witnessed_at(found, positions, fault.prior);
        }
        if (std::ranges::any_of(witnessed, &contradicts) || is_unheard(witnessed))
            return nothing_assured;
        std::vector<BudgetRow> rows{speed_row("w", "", "A", positions.own_m_s, "", ""),
                                    speed_row("b", "", "B", positions.slow_m_s, "", ""),
                                    speed_row("d", "", "B", positions.fault_m_s, "", ""),
                                    speed_row("m", "", "B", reference_.others, "", "")};
        SpeedEvidence evidence;
        const HeardTogether heard =
            hear_together(positions, positions.slow_m_s, witnessed, evidence);
        if (evidence.disagreement > 1.0) return nothing_assured;
        const auto expanded_m_s = [&] {
            return profile_.coverage_factor * combine(rows).standard_uncertainty +
                   heard.position_share * reference_.bias_limit * by_errors;
        };
        const double alone_m_s = expanded_m_s();
        condition_on(witnessed, positions.slow_m_s, heard.difference_m_s, rows);
        // A mixture takes long, and exceeds the budget only where a fault is likely.
        constexpr double likely = 0.01;
        if (std::ranges::none_of(witnessed, [](const WitnessedSpeed& one) {
                return one.fault_posterior.value_or(0.0) > likely;
            }))
            return expanded_m_s();
        evidence.position_standard_uncertainty_m_s =
            std::hypot(positions.own_m_s, positions.slow_m_s);
        evidence.shared_standard_uncertainty_m_s =
            std::hypot(evidence.shared_standard_uncertainty_m_s, reference_.others);
        evidence.fault_probability = fault.prior.probability;
        evidence.chosen_fault_probability = fault.chosen_probability;
        evidence.fault_m_s = fault.prior.largest_m_s;
        evidence.fault_upwards_alone = fault.prior.upwards_alone;
        return std::max(expanded_m_s(), least_expanded_m_s(evidence, found.speed_m_s, alone_m_s));
    }

  private:
    template <int Axes>
    HeardWitnesses<Axes> asked_of(HeardWitnesses<Axes> witnesses) const {
        std::erase_if(witnesses, [&](const auto& one) { return !is_asked(one); });
        return witnesses;
    }

    bool is_asked(const auto& one) const { return asked_ == AskedWitnesses::all || one.confirms; }

    /// Whether a witness that contradicts the reference does not cover the window. Moving there
    /// must not avoid the contradiction.
    bool is_unheard(const std::vector<WitnessedSpeed>& witnessed) const {
        return std::ranges::any_of(contradicting_, [&](const WitnessedSpeed& wanted) {
            return std::ranges::none_of(witnessed, [&](const WitnessedSpeed& one) {
                return one.kind == wanted.kind && one.receiver == wanted.receiver;
            });
        });
    }

    static RangeMaximum missed_of(const ScreenedTable& screened, Dimension dimension) {
        std::vector<double> missed;
        missed.reserve(screened.rows.size());
        for (const ScreenedEpoch& row : screened.rows)
            missed.push_back(missed_at(row, dimension));
        return RangeMaximum(std::move(missed));
    }

    EpochPair rows_of(const FoundWindow& found) const {
        const std::vector<std::size_t>& rows = arcs_[found.series].rows;
        return {rows[found.first], rows[found.last]};
    }

    /// Root mean square of the stated standard deviations of a window's usable epochs.
    double stated_m(std::size_t first, std::size_t last) const {
        return std::sqrt(stated_(first, last) / std::max(1.0, usable_(first, last)));
    }

    /// Size of the positions' errors in a window, as in `error_bound`.
    double error_m(std::size_t first, std::size_t last) const {
        return std::max(scale_ * stated_m(first, last), floor_m_);
    }

    void set_reference(const Reference& reference) {
        const CertifiableWindow& window = reference.window;
        const auto [first, last] = rows_of(reference.found);
        const double stated = stated_m(first, last);
        if (window.bound && stated > 0.0) scale_ = window.bound->stated_m / stated;
        if (const auto& evidence = window.evidence) {
            reference_.slow = evidence->slow_standard_uncertainty_m_s;
            reference_.own =
                std::sqrt(std::max(0.0, std::pow(evidence->position_standard_uncertainty_m_s, 2) -
                                            reference_.slow * reference_.slow));
            reference_.undetected = std::sqrt(evidence->fault_probability) *
                                    rectangular_uncertainty(evidence->fault_m_s);
            reference_.fault = {.probability = evidence->fault_probability,
                                .largest_m_s = evidence->fault_m_s,
                                .upwards_alone = evidence->fault_upwards_alone};
            reference_.chosen = evidence->chosen_fault_probability;
        }
        for (const char* symbol : {"k", "m", "h", "c", "a", "y", "z", "q"})
            reference_.others = std::hypot(reference_.others, contribution(window.budget, symbol));
        double rest = 1.0;
        for (const WitnessedSpeed& one : window.witnesses)
            rest -= one.share;
        reference_.bias_limit = window.bias_limit_m_s / std::max(rest, 1e-9);
        reference_.stated_m = std::max(error_m(first, last), 1e-9);
        reference_.missed_m = missed_(first, last);
        reference_.duration_s = window.span.duration.seconds();
    }

    std::vector<WitnessedSpeed> witnessed_at(const FoundWindow& found,
                                             const PositionTerms& positions,
                                             const FaultPrior& fault) const {
        const bool vertical = profile_.dimension == Dimension::vertical;
        if (vertical ? upright_.empty() : level_.empty()) return {};
        const auto [first, last] = rows_of(found);
        const TrajectoryEpoch& from = trajectory_.rows[first];
        const TrajectoryEpoch& to = trajectory_.rows[last];
        // Between the enclosing epochs, because the window itself may begin and end at any instant.
        const double start_s = from.time.seconds();
        const double end_s = to.time.seconds();
        std::vector<WitnessedSpeed> all;
        const auto hear = [&](const auto& witnesses, auto figures) {
            figures.start_s = start_s;
            figures.end_s = end_s;
            figures.by_path = false;
            figures.speed_m_s = figures.displacement_m.norm() / (end_s - start_s);
            figures.standard_uncertainty_m_s = std::hypot(positions.own_m_s, positions.slow_m_s);
            figures.correlated_m_s = positions.slow_m_s;
            figures.fault = fault;
            all = witnessed_speeds(witnesses, figures, {trajectory_, arcs_[found.series]});
        };
        if (vertical)
            hear(upright_,
                 PositionFigures<1>{.displacement_m = SpeedVector<1>(*to.up_m - *from.up_m)});
        else
            hear(level_,
                 PositionFigures<2>{.displacement_m = SpeedVector<2>(*to.east_m - *from.east_m,
                                                                     *to.north_m - *from.north_m)});
        return all;
    }

    const TrajectoryTable& trajectory_;
    const std::vector<ArcRows>& arcs_;
    const Profile& profile_;
    AskedWitnesses asked_;
    HeardWitnesses<2> level_;
    HeardWitnesses<1> upright_;
    std::vector<Contradiction> contradictions_;
    RangeMaximum missed_;
    RunningSum stated_;
    RunningSum usable_;
    std::vector<WitnessedSpeed> contradicting_;
    double floor_m_ = 0.0;
    double scale_ = 1.0;
    ReferenceFigures reference_;
};

}  // namespace

Allowance expected_allowance(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                             const std::vector<ArcRows>& arcs, const Profile& profile,
                             const Reference& reference, const HeardWitnesses<2>& level,
                             const HeardWitnesses<1>& upright, AskedWitnesses asked,
                             std::span<const Contradiction> contradictions) {
    const auto expectation = std::make_shared<const Expectation>(
        screened, trajectory, arcs, profile, reference, level, upright, asked, contradictions);
    return [expectation](const FoundWindow& found) { return (*expectation)(found); };
}

}  // namespace runcert
