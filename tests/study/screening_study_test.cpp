#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "draws.h"
#include "false_records.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Probability of `count` or more of `of` where each has the probability.
double at_least(std::int64_t count, std::int64_t of, double probability) {
    double sum = 0.0;
    for (std::int64_t i = count; i <= of; ++i) {
        const auto k = static_cast<double>(i);
        const auto n = static_cast<double>(of);
        sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) +
                        k * std::log(probability) + (n - k) * std::log1p(-probability));
    }
    return sum;
}

// A share that is so unlikely under a probability contradicts it.
constexpr double too_unlikely = 1e-4;

/// Whether the share contradicts that the probability is at most, or at least, so large.
bool contradicts_at_most(const Share& share, double probability) {
    return at_least(share.count, share.of, probability) < too_unlikely;
}
bool contradicts_at_least(const Share& share, double probability) {
    return at_least(share.of - share.count, share.of, 1.0 - probability) < too_unlikely;
}

/// Prints and checks the power of one cell. Daily, the share of all errors that their own tests
/// find is known within 0.01; a quarter of the errors of twice the size that are not found is seen
/// for certain, one in a hundred with probability 0.8.
void expect_power(const StudyRun& cell) {
    const auto lines = study_power(cell, {.recordings = draws({.daily = 50, .study = 150}),
                                          .screened = draws({.daily = 4, .study = 12})});
    fmt::print("{}", power_table(cell, lines));
    Share own;
    Share found;
    Share dated;
    for (const PowerLine& line : lines) {
        SCOPED_TRACE(fmt::format("{} of {}", to_text(line.kind), line.epochs));
        EXPECT_FALSE(contradicts_at_least(line.own_test, 0.77)) << line.own_test.fraction();
        EXPECT_FALSE(contradicts_at_most(line.own_test, 0.83)) << line.own_test.fraction();
        own += line.own_test;
        found += line.found_twice;
        if (line.kind == Hypothesis::step || line.kind == Hypothesis::time_shift)
            dated += line.dated_twice;
    }
    EXPECT_NEAR(own.fraction(), 0.8, 0.03);
    EXPECT_FALSE(contradicts_at_least(found, 0.999)) << found.count << " of " << found.of;
    EXPECT_FALSE(contradicts_at_least(dated, 0.99)) << dated.count << " of " << dated.of;
}

TEST(ScreeningPower, At10HzInWhiteNoise) {
    expect_power(screening_cells()[0]);
}
TEST(ScreeningPower, At10HzInSlowNoise) {
    expect_power(screening_cells()[1]);
}
TEST(ScreeningPower, At20HzInWhiteNoise) {
    expect_power(screening_cells()[2]);
}
TEST(ScreeningPower, At20HzInSlowNoise) {
    expect_power(screening_cells()[3]);
}

TEST(Screening, CleanRunsStayClean) {
    Share all;
    for (const StudyRun& cell : screening_cells()) {
        const Share clean = study_clean(cell, {.clean_runs = draws({.daily = 3, .study = 15})});
        fmt::print("{}: {} of {} clean\n", cell_name(cell), clean.count, clean.of);
        all += clean;
    }
    EXPECT_FALSE(contradicts_at_least(all, 0.99)) << all.count << " of " << all.of;
}

/// Ten standard deviations and more are found of every kind of error, and called what they are.
TEST(Screening, LargeErrorsAreCalledWhatTheyAre) {
    const StudyRun cell = screening_cells()[1];
    std::vector<Identification> lines;
    for (const ErrorScenario& scenario : error_scenarios(cell.rate_hz))
        lines.push_back(study_identification(
            cell, scenario, {.scenario_recordings = draws({.daily = 3, .study = 10})}));
    fmt::print("{}", identification_table(cell, lines));
    Share found;
    Share named;
    for (const Identification& line : lines) {
        const Hypothesis kind = line.scenario.kind;
        const double large = kind == Hypothesis::ramp         ? 1.0
                             : kind == Hypothesis::time_shift ? 0.0
                                                              : 10.0;
        if (line.scenario.size < large) continue;
        found += line.found;
        named += line.named;
    }
    EXPECT_FALSE(contradicts_at_least(found, 0.999)) << found.count << " of " << found.of;
    EXPECT_FALSE(contradicts_at_least(named, 0.99)) << named.count << " of " << named.of;
}

/// A ramp is a velocity that is not there: too slow a one cannot be told from the craft's own
/// motion, and the certificate says what it would do. Nothing else makes a false record. Daily,
/// what spoils one run in twenty is found with probability 0.95, in the study one in a hundred.
TEST(FalseRecords, NoneBeyondWhatIsStated) {
    const std::vector<CertifiedRun> runs =
        study_false_records({.runs = draws({.daily = 60, .study = 300})});
    fmt::print("{}", false_records_table(runs));
    Share missed;
    for (const CertifiedRun& run : runs) {
        SCOPED_TRACE(run.seed);
        missed.add(run.missed());
        EXPECT_NE(run.outcome, CertifiedRun::Outcome::failed) << run.failure;
        EXPECT_FALSE(run.unstated());
        const bool ramp = !run.errors.empty() && run.errors.front().kind == Hypothesis::ramp;
        EXPECT_TRUE(ramp || !run.far_off());
    }
    EXPECT_FALSE(contradicts_at_most(missed, 0.05)) << missed.count << " of " << missed.of;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
