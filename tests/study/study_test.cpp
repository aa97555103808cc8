#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "coverage.h"
#include "draws.h"
#include "interval_study.h"
#include "selection_study.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// The cells of one rate and what they show together; prints their table.
struct CoverageTable {
    std::vector<CoverageCell> cells;
    Coverage known, fitted, bound;
};

/// `own_errors`: each cell has errors of its own, so that together they tell as much as so many.
CoverageTable coverage_at(double rate_hz, CoverageOptions options, bool own_errors) {
    CoverageTable table;
    for (const CoverageCell& cell : coverage_cells(rate_hz)) {
        const CoverageCell& made = table.cells.emplace_back(study_coverage(cell, options));
        options.seed += own_errors ? 1 : 0;
        table.known += made.known;
        table.fitted += made.fitted;
        if (cell.run.noise.error_tau_s <= 10.0) table.bound += made.bound;
    }
    fmt::print("{}", coverage_table(table.cells));
    return table;
}

/// Every cell by itself.
void expect_coverage_of_each(double rate_hz) {
    const CoverageOptions options{.runs = 100, .runs_known = 1000};
    for (const CoverageCell& cell : coverage_at(rate_hz, options, false).cells) {
        const StudyNoise& noise = cell.run.noise;
        const bool slow = noise.error_sigma_m > 0.0;
        SCOPED_TRACE(fmt::format("{} Hz, {} mm white, {} mm slow, tau {} s", rate_hz,
                                 noise.white_m * 1e3, noise.error_sigma_m * 1e3,
                                 noise.error_tau_s));
        EXPECT_GE(cell.known.fraction(), 0.93);
        EXPECT_LE(cell.known.fraction(), 0.97);
        EXPECT_GE(cell.fitted.fraction(), 0.90);
        // The most adverse correlation time is held as often as the interval says: of 100 runs
        // fewer than 90 with a probability of 1 %.
        if (!slow || noise.error_tau_s <= 10.0) {
            EXPECT_GE(cell.bound.fraction(), 0.90);
        }
        if (slow) {
            EXPECT_LE(cell.bound.half_width_m_s, 0.025);
        }
    }
}

/// All cells together. With the true parameters the mean square of 3,500 errors in standard
/// uncertainties is 1 within 0.024 (one standard deviation): a variance that is 10 % too small is
/// found at three of these with probability 0.93; of half as many, at 20 Hz, with 0.62. Fitted
/// intervals that are too narrow by a third hold 0.81: of 84 fewer than 0.85 hold with 0.8.
void expect_coverage_together(double rate_hz) {
    const CoverageTable table =
        coverage_at(rate_hz, {.runs = 12, .runs_known = rate_hz > 15.0 ? 250 : 500}, true);
    EXPECT_NEAR(table.known.mean_square(), 1.0,
                3.0 * std::sqrt(2.0 / static_cast<double>(table.known.runs)));
    EXPECT_GE(table.fitted.fraction(), 0.85);
    EXPECT_GE(table.bound.fraction(), 0.95);
}

void expect_coverage(double rate_hz) {
    if (is_study())
        expect_coverage_of_each(rate_hz);
    else
        expect_coverage_together(rate_hz);
}

TEST(Coverage, At10Hz) {
    expect_coverage(10.0);
}
TEST(Coverage, At20Hz) {
    expect_coverage(20.0);
}

/// Whole certificates, cell by cell and length by length. Daily, of three runs each, what spoils
/// every run is found for certain, what spoils half of them in every second cell.
TEST(Intervals, HoldTheTrueSpeedUnderTimeCorrelatedErrorsOfEveryKind) {
    const int runs = draws({.daily = 3, .study = 100});
    for (const IntervalCell& cell : interval_cells()) {
        // Positions that err by five times what they state are taken for motion, and the fastest
        // window is where a wave of its own length helps most.
        const double largest_mean = cell.name.starts_with("50 mm 5 s") ? 0.35
                                    : cell.wave_m > 0.0                ? 0.25
                                                                       : 0.2;
        const auto summaries = study_intervals(cell, runs, 1);
        fmt::print("{}", interval_lines(cell, summaries));
        for (const IntervalSummary& sum : summaries) {
            SCOPED_TRACE(cell.name);
            if (cell.square_wave || cell.floats) {  // jumps of the positions may be refused
                if (sum.certified < 3) continue;
            } else {
                EXPECT_EQ(sum.certified, runs);
            }
            EXPECT_GE(sum.held_part(), is_study() ? 0.94 : 0.6);
            if (is_study()) {
                EXPECT_LE(std::abs(sum.mean_error), largest_mean * sum.mean_expanded);
            }
            if (sum.mean_ideal > 0.0) {
                EXPECT_GT(sum.mean_expanded, 0.95 * sum.mean_ideal);
            }
        }
    }
}

/// Biased high as it stands. The bias by the fitted errors, which are white as the true ones,
/// explains nine tenths of that or more; what is certified, the middle between it and the bias with
/// time-correlated errors at their bound, is within what is allowed for it. The errors spread by a
/// quarter of the bias: of 40 runs a quarter of it that is wrong is found with probability 0.999.
void expect_unbiased(double noise_m) {
    const int runs = draws({.daily = 40, .study = 500});
    const SelectionStudy study = study_selection(selection_run(noise_m), runs, 1);
    fmt::print("{}", selection_line(study));
    EXPECT_GT(study.uncorrected.mean_m_s, 5.0 * study.uncorrected.standard_error_m_s);
    EXPECT_LE(std::abs(study.fitted.mean_m_s),
              0.1 * study.uncorrected.mean_m_s + 2.0 * study.fitted.standard_error_m_s);
    EXPECT_LE(std::abs(study.reported.mean_m_s),
              study.half_range_m_s + 2.0 * study.reported.standard_error_m_s);
    EXPECT_GE(static_cast<double>(study.held), 0.93 * static_cast<double>(study.runs));
}

TEST(Selection, BiasOf10MillimetreNoise) {
    expect_unbiased(0.010);
}
TEST(Selection, BiasOf30MillimetreNoise) {
    expect_unbiased(0.030);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
