#include "stages/screen/examination.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "core/parallel.h"
#include "core/rounding.h"
#include "core/statistics.h"
#include "motion/kalman.h"
#include "schemas/enu/measured_position.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert {
namespace {

// Minimal detectable biases above these limits are not reported.
constexpr double largest_detectable_m = 1000.0;
constexpr double largest_detectable_s = 100.0;

/// The minimal detectable bias, in the direction in which it is hardest to detect.
template <int Size>
std::optional<double> detectable(const ScoreTest<Size>& test, double variance_factor,
                                 const TestPlan& plan, double largest) {
    const auto covariance = test.covariance();
    double variance = covariance(0, 0);
    if constexpr (Size == 2)
        variance = 0.5 * (covariance(0, 0) + covariance(1, 1)) +
                   std::hypot(0.5 * (covariance(0, 0) - covariance(1, 1)), covariance(0, 1));
    const double size = std::sqrt(variance_factor * plan.noncentrality(Size) * variance);
    if (!(size <= largest)) return std::nullopt;
    return size;
}

/// Keeps the better supported of two hypotheses.
struct BestSupported {
    double log_tail = 1.0;

    template <int Size>
    void consider(const ScoreTest<Size>& test, double variance_factor, Hypothesis hypothesis,
                  TestedAxes axes, const TestPlan& plan, ScreenedEpoch& row) {
        const double statistic = test.statistic() / variance_factor;
        const double tail = log_chi_squared_upper_tail(std::max(statistic, 0.0), Size);
        if (!(tail < log_tail)) return;
        log_tail = tail;
        row.hypothesis = hypothesis;
        row.tested_axes = axes;
        row.statistic = statistic;
        row.threshold = plan.critical(Size);
    }
};

template <int Axes>
class ArcExamination {
  public:
    /// The part of the arc that the section includes. Its epochs are counted from there.
    ArcExamination(const Arc<Axes>& arc, const ArcSection& section, const EstimationModel& model,
                   const TestPlan& plan)
        : epochs_(std::span(arc.epochs)
                      .subspan(section.used_first, section.used_end - section.used_first)),
          plan_(plan),
          diagnosis_(epochs_, model),
          factors_(local_variance_factors(diagnosis_)) {}

    void fill(std::size_t k, const std::map<FixType, double>& kinds, ScreenedEpoch& row,
              BestSupported& best) const {
        constexpr TestedAxes axes = tested_axes<Axes>;
        const double factor = factors_[k];
        if (Axes == 2) row.local_variance_factor = factor;
        const bool decided =
            !row.usable || (row.break_before && *row.break_before != ArcBreak::start &&
                            *row.break_before != ArcBreak::gap);
        const auto consider = [&](const auto& test, Hypothesis hypothesis,
                                  std::optional<double> size) {
            if (size && !decided) best.consider(test, factor, hypothesis, axes, plan_, row);
            return size;
        };
        const ScoreTest<Axes> outlier = outlier_test(k, kinds, row);
        auto& outlier_size = Axes == 1 ? row.detectable.outlier_up_m : row.detectable.outlier_m;
        outlier_size = consider(outlier, Hypothesis::outlier,
                                detectable(outlier, factor, plan_, largest_detectable_m));
        if ((row.reason == Reason::outlier || row.reason == Reason::burst) &&
            row.tested_axes == axes && outlier_size)
            row.estimated = estimated_error(outlier);
        if (k == 0) return;
        const auto step = diagnosis_.step(k);
        auto& step_size = Axes == 1 ? row.detectable.step_up_m : row.detectable.step_m;
        step_size =
            consider(step, Hypothesis::step, detectable(step, factor, plan_, largest_detectable_m));
        if constexpr (Axes == 2) {
            const auto ramp = diagnosis_.ramp(k);
            row.detectable.ramp_m_s = consider(
                ramp, Hypothesis::ramp, detectable(ramp, factor, plan_, largest_detectable_m));
            if (const auto shift = diagnosis_.time_shift(k))
                row.detectable.time_s =
                    consider(*shift, Hypothesis::time_shift,
                             detectable(*shift, factor, plan_, largest_detectable_s));
        }
    }

    const Chain<Axes>& chain() const { return diagnosis_; }

  private:
    ScoreTest<Axes> outlier_test(std::size_t k, const std::map<FixType, double>& kinds,
                                 const ScreenedEpoch& row) const {
        if (epochs_[k].measurement) return diagnosis_.outlier(k);
        PositionMeasurement<Axes> measurement{.position = measured_position<Axes>(row),
                                              .covariance = stated_covariance<Axes>(row)};
        const auto kind = kinds.find(row.fix);
        if (kind != kinds.end()) measurement.covariance *= kind->second;
        return diagnosis_.left_out(k, measurement);
    }

    std::span<const ArcEpoch<Axes>> epochs_;
    const TestPlan& plan_;
    Chain<Axes> diagnosis_;
    std::vector<double> factors_;
};

}  // namespace

template <int Axes>
std::vector<FixTypeErrors> compare_fix_types(const ScreenedTable& first_look,
                                             const ScreeningNoise& noise) {
    constexpr std::size_t fewest = 100;
    std::map<FixType, std::vector<double>> statistics;
    for (const Arc<Axes>& arc : arcs_of<Axes>(first_look)) {
        KalmanFilter<Axes> filter(noise.fitted);
        filter_along<Axes>(
            filter, arc.epochs,
            [&](std::size_t k, const auto&, const Innovation<Axes>* seen, const auto&) {
                if (seen && seen->tests_model)
                    statistics[first_look.rows[arc.rows[k]].fix].push_back(seen->statistic());
            });
    }
    const double expected = chi_squared_quantile(0.5, Axes);
    // Standard deviation of the median of n such statistics: 1 / (2 f sqrt(n)), where f is the
    // density there.
    const double density = Axes == 2 ? 0.25 : 0.4720;
    // The scale includes time-correlated errors, as if white noise were the whole model.
    const double scale = noise.summary.white_scale * noise.summary.white_scale;
    std::vector<FixTypeErrors> kinds;
    for (const auto& [fix, values] : statistics) {
        const bool enough = values.size() >= fewest;
        constexpr int decimals = 4;
        const double factor = rounded(scale * (enough ? median(values) / expected : 1.0), decimals);
        const double sigma =
            factor / (2.0 * density * expected * std::sqrt(static_cast<double>(values.size())));
        kinds.push_back({.fix = fix,
                         .axes = tested_axes<Axes>,
                         .epochs = std::ssize(values),
                         .variance_factor = factor,
                         .judgement = !enough ? AccuracyJudgement::too_few_epochs
                                      : factor > 1.0 + 3.0 * sigma ? AccuracyJudgement::optimistic
                                      : factor < 1.0 - 3.0 * sigma ? AccuracyJudgement::pessimistic
                                                                   : AccuracyJudgement::as_stated});
    }
    return kinds;
}

template std::vector<FixTypeErrors> compare_fix_types<1>(const ScreenedTable&,
                                                         const ScreeningNoise&);
template std::vector<FixTypeErrors> compare_fix_types<2>(const ScreenedTable&,
                                                         const ScreeningNoise&);

namespace {

/// Fills one row, and returns its motion, from both groups of axes.
EpochMotion examine(std::size_t k, const ScreeningNoises& noises, const ArcExamination<2>& plane,
                    const std::optional<ArcExamination<1>>& height, ScreenedEpoch& row) {
    BestSupported best;
    plane.fill(k, noises.horizontal_factors, row, best);
    const StateVector<2> level = plane.chain().mean(k);
    EpochMotion at;
    at.velocity = level.segment<2>(2);
    at.acceleration = level.segment<2>(4);
    at.velocity_covariance = plane.chain().covariance_of(1, k);
    at.acceleration_covariance = plane.chain().covariance_of(2, k);
    if (!height) return at;
    height->fill(k, noises.vertical_factors, row, best);
    at.vertical_rate_m_s = height->chain().mean(k)(1);
    at.sigma_vertical_rate_m_s =
        std::sqrt(std::max(0.0, height->chain().covariance_of(1, k).value()));
    return at;
}

/// Fills the rows whose tests a section of an arc decides, and their motion. `heights` is null
/// without heights.
void examine_section(const Arc<2>& arc, const Arc<1>* heights, const ArcSection& section,
                     const ScreeningNoises& noises, const TestPlan& plan, ScreenedTable& table,
                     Motion& motion) {
    std::optional<ArcExamination<2>> plane;
    std::optional<ArcExamination<1>> height;
    do_together([&] { plane.emplace(arc, section, noises.horizontal.model, plan); },
                [&] {
                    if (heights != nullptr)
                        height.emplace(*heights, section, noises.vertical->model, plan);
                });
    // Epochs are independent of one another, and the plan already holds the limits for one and two
    // axes.
    constexpr std::size_t block = 4096;
    const auto blocks =
        static_cast<std::int64_t>((section.end - section.first + block - 1) / block);
    for_each_run(blocks, threads_allowed(), [&](std::int64_t b) {
        const std::size_t from = section.first + static_cast<std::size_t>(b) * block;
        const std::size_t to = std::min(from + block, section.end);
        for (std::size_t k = from; k < to; ++k) {
            const std::size_t row = arc.rows[k];
            motion[row] = examine(k - section.used_first, noises, *plane, height, table.rows[row]);
        }
    });
}

}  // namespace

Motion examine_arcs(ScreenedTable& table, const ScreeningNoises& noises, const TestPlan& plan,
                    std::size_t section_epochs) {
    Motion motion(table.rows.size());
    const auto horizontal =
        tested_arcs<2>(table, noises.horizontal.model, noises.horizontal_factors);
    std::vector<Arc<1>> vertical;
    if (noises.vertical)
        vertical = tested_arcs<1>(table, noises.vertical->model, noises.vertical_factors);
    for (ScreenedEpoch& row : table.rows) {
        row.detectable = {};
        row.local_variance_factor.reset();
    }
    for (std::size_t a = 0; a < horizontal.size(); ++a) {
        const Arc<2>& arc = horizontal[a];
        double memory = 0.0;
        if (arc.epochs.size() > section_epochs) {
            memory = memory_s<2>(arc.epochs, noises.horizontal.model);
            if (noises.vertical)
                memory = std::max(memory, memory_s<1>(vertical[a].epochs, noises.vertical->model));
        }
        for (const ArcSection& section : sections_of<2>(arc.epochs, memory, section_epochs))
            examine_section(arc, noises.vertical ? &vertical[a] : nullptr, section, noises, plan,
                            table, motion);
    }
    return motion;
}

}  // namespace runcert
