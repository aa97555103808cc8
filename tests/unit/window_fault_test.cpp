#include "stages/window/window_fault.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace runcert::RUNCERT_FILE {
namespace {

ElapsedTime at(double time_s) {
    ElapsedTime time;
    time.nanoseconds = std::llround(time_s * 1e9);
    return time;
}

struct Chosen {
    ScreenedTable screened;
    FoundWindow found;
    std::vector<FoundWindow> all;
    std::vector<UndetectedError> reliability{{.hypothesis = Hypothesis::ramp, .speed_m_s = 0.8}};

    explicit Chosen(FixType fix = FixType::fixed) {
        for (int k = 0; k <= 2000; ++k) {
            ScreenedEpoch& row = screened.rows.emplace_back();
            row.time = at(0.1 * k);
            row.fix = fix;
            row.usable = true;
        }
        found = window(100.0, 60.0);
        all = {found};
    }
    static FoundWindow window(double start_s, double speed_m_s, double duration_s = 3.0) {
        FoundWindow one;
        one.start = at(start_s);
        one.end = at(start_s + duration_s);
        one.speed_m_s = speed_m_s;
        return one;
    }
    WindowFault fault(bool by_path = false, double probability = 0.002) const {
        const auto first = static_cast<std::size_t>(std::lround(found.start.seconds() * 10.0));
        const auto last = static_cast<std::size_t>(std::lround(found.end.seconds() * 10.0));
        return window_fault(screened, found, all, {first, last}, reliability, by_path, probability);
    }
};

// Positions that drift for most of a recording make the velocities look wrong, which are right.
TEST(WindowFaults, WhatPositionsAndVelocitiesDifferByMayBeThePositions) {
    Chosen run;
    const auto shown = [&run](double shown_m_s, std::optional<double> stated_m_s,
                              TestedAxes axes = TestedAxes::horizontal) {
        run.screened.basis.velocity_errors = {
            {.axes = axes, .stated_m_s = stated_m_s, .shown_m_s = shown_m_s}};
        return unexplained_by_velocities_m_s(run.screened, axes);
    };
    EXPECT_EQ(unexplained_by_velocities_m_s(run.screened, TestedAxes::horizontal), 0.0);
    EXPECT_EQ(shown(0.05, std::nullopt), 0.0);
    EXPECT_EQ(shown(0.5, std::nullopt), 0.5);
    EXPECT_EQ(shown(0.5, 0.02), 0.5);
    EXPECT_EQ(shown(0.5, 0.6), 0.0);
    EXPECT_EQ(shown(0.08, std::nullopt, TestedAxes::vertical), 0.0);
    // The white noise of the velocities shows in short spans, and does not last.
    EXPECT_EQ(shown(0.3, std::nullopt), 0.3);
    run.screened.basis.velocity_errors[0].spreads = {
        {.span_s = 3.0, .sd_m = 0.9}, {.span_s = 10.0, .sd_m = 0.5}, {.span_s = 30.0, .sd_m = 0.1}};
    EXPECT_EQ(unexplained_by_velocities_m_s(run.screened, TestedAxes::horizontal), 0.0);
    run.screened.basis.velocity_errors[0].spreads[1].sd_m = 2.0;
    EXPECT_DOUBLE_EQ(unexplained_by_velocities_m_s(run.screened, TestedAxes::horizontal), 0.2);
    run.screened.facts.nominal_interval_s = 0.1;
    RandomGenerator random(2);
    for (ScreenedEpoch& row : run.screened.rows) {
        row.recorded_velocity_east_m_s = 2.0 * random.normal();
        row.sigma_east_m = 0.01;
    }
    EXPECT_EQ(unexplained_by_velocities_m_s(run.screened, TestedAxes::horizontal), 0.0);
    const WindowFault fault = window_fault(run.screened, run.found, run.all, {1000, 1030},
                                           run.reliability, false, 0.002, {.size_m_s = 0.5});
    EXPECT_FALSE(fault.shown.empty());
    EXPECT_EQ(fault.prior.probability, 0.5);
    EXPECT_EQ(fault.prior.largest_m_s, 1.0);
    // A drift that shows 0.5 m/s along each axis is one of 0.71 m/s.
    EXPECT_GT(2.0 * fault.standard_uncertainty_m_s(), 0.5 * std::sqrt(2.0));
}

/// Spans of driving at 15, 45 to 60 m/s, with noise of 0.03 m/s; the positions move farther by
/// `drift_m_s` above 30 m/s, and velocities have a scale.
std::vector<SpanComparison> driven(double scale, double drift_m_s, bool slowly = true) {
    RandomGenerator random(3);
    std::vector<SpanComparison> spans;
    for (int k = 0; k < 60; ++k) {
        const double speed_m_s = slowly && k < 15 ? 15.0 : 45.0 + 0.25 * k;
        spans.push_back({.speed_m_s = speed_m_s,
                         .along_m_s = (speed_m_s > 30.0 ? drift_m_s : 0.0) -
                                      (scale - 1.0) * speed_m_s + 0.03 * random.normal(),
                         .across_m_s = 0.03 * random.normal()});
    }
    return spans;
}

// A scale of half a percent made the positions as likely at fault as not: 1.4 km/h for 0.18.
TEST(LastingDifferences, OfAScaleAndOfADriftAreToldApartBySlowDriving) {
    const auto at_fault = [](double scale, double drift_m_s, bool slowly = true) {
        const double size_m_s =
            std::abs(55.0 * (scale - 1.0)) / std::sqrt(2.0) + drift_m_s / std::sqrt(2.0);
        const auto found =
            weigh_scale_and_drift(size_m_s, driven(scale, drift_m_s, slowly), 0.01, 0.07);
        if (drift_m_s == 0.0) {
            EXPECT_TRUE(found.is_scale);
            EXPECT_NEAR(found.scale, scale - 1.0, 3e-4);
        }
        return found.positions_at_fault(0.002, 1.0);
    };
    for (const bool slowly : {true, false}) {
        EXPECT_LT(at_fault(1.005, 0.0, slowly), 0.003);
        EXPECT_LT(at_fault(0.995, 0.0, slowly), 0.003);
        EXPECT_LT(at_fault(1.01, 0.0, slowly), 0.03);
        EXPECT_GT(at_fault(1.03, 0.0, slowly), at_fault(1.01, 0.0, slowly));
    }
    EXPECT_NEAR(at_fault(1.0, 0.4), 0.5, 1e-3);
    EXPECT_NEAR(at_fault(1.0, 0.2), 0.5, 1e-2);
    EXPECT_NEAR(at_fault(1.005, 0.4), 0.5, 1e-2);
    // In spans that are all fast, their priors decide.
    EXPECT_GE(at_fault(1.0, 0.4, false), at_fault(1.0, 0.2, false));
    // What no scale explains is nobody's.
    std::vector<SpanComparison> across = driven(1.0, 0.0);
    for (SpanComparison& one : across)
        one.across_m_s += 0.3;
    const LastingDifference other = weigh_scale_and_drift(0.2, across, 0.01, 0.07);
    EXPECT_FALSE(other.is_scale);
    EXPECT_EQ(other.positions_at_fault(0.002, 1.0), 0.5);
    EXPECT_EQ(LastingDifference{}.positions_at_fault(0.002, 1.0), 0.002);
    // Nor is what nothing was compared over.
    EXPECT_EQ(weigh_scale_and_drift(0.2, {}, 0.01, 0.07).positions_at_fault(0.002, 1.0), 0.5);
}

TEST(WindowFaults, GoByTheKindOfSolutionAndTheWindow) {
    Chosen run;
    EXPECT_DOUBLE_EQ(run.fault().prior.probability, 0.002);
    EXPECT_DOUBLE_EQ(run.fault().prior.largest_m_s, 0.8);
    EXPECT_DOUBLE_EQ(run.fault().standard_uncertainty_m_s(),
                     std::sqrt(0.002) * 0.8 / std::sqrt(3.0));
    EXPECT_DOUBLE_EQ(run.fault().standard_uncertainty_m_s(5.0),
                     std::sqrt(0.01) * 0.8 / std::sqrt(3.0));
    EXPECT_FALSE(run.fault().prior.upwards_alone);
    EXPECT_TRUE(run.fault(true).prior.upwards_alone);
    EXPECT_DOUBLE_EQ(Chosen(FixType::single).fault().prior.probability, 0.05);
    EXPECT_DOUBLE_EQ(Chosen(FixType::single).fault(false, 0.0001).prior.probability, 0.0025);
    // A longer one errs more often, and by less: 3 m over its time, of a path 6 m.
    run.found = Chosen::window(100.0, 60.0, 10.0);
    run.reliability[0].speed_m_s = 4.0;
    EXPECT_DOUBLE_EQ(run.fault().prior.probability, 0.002 * 10.0 / 3.0);
    EXPECT_DOUBLE_EQ(run.fault().prior.largest_m_s, 0.3);
    EXPECT_DOUBLE_EQ(run.fault(true).prior.largest_m_s, 0.6);
    // By code what screening finds counts, up to 30 m.
    Chosen single(FixType::single);
    single.reliability[0].speed_m_s = 4.0;
    EXPECT_DOUBLE_EQ(single.fault().prior.largest_m_s, 4.0);
    single.reliability[0].speed_m_s = 40.0;
    EXPECT_DOUBLE_EQ(single.fault().prior.largest_m_s, 10.0);
    Chosen wandering(FixType::float_ambiguities);
    wandering.reliability[0].speed_m_s = 40.0;
    EXPECT_DOUBLE_EQ(wandering.fault().prior.largest_m_s, 1.0);
}

TEST(WindowFaults, AreLikelierWhereScreeningRejectedAnEpoch) {
    for (const std::size_t epoch : {450U, 1020U, 1600U, 1700U}) {
        Chosen run;
        run.screened.rows[epoch].usable = false;
        run.screened.rows[epoch].hypothesis = Hypothesis::outlier;
        const bool near = std::abs(0.1 * static_cast<double>(epoch) - 101.5) <= 61.5;
        EXPECT_DOUBLE_EQ(run.fault().prior.probability, near ? 0.01 : 0.002) << epoch;
        // One that was left out for another reason says nothing of errors.
        run.screened.rows[epoch].hypothesis.reset();
        EXPECT_DOUBLE_EQ(run.fault().prior.probability, 0.002);
    }
}

TEST(WindowFaults, AreLikelierOfAWindowChosenAmongRivals) {
    Chosen run;
    EXPECT_NEAR(run.fault().chosen_probability, 0.002, 1e-12);
    // Overlapping ones are no rivals, nor are those slower by more than an error makes.
    run.all.push_back(Chosen::window(101.0, 59.99));
    run.all.push_back(Chosen::window(98.0, 59.99));
    run.all.push_back(Chosen::window(50.0, 59.1));
    EXPECT_NEAR(run.fault().chosen_probability, 0.002, 1e-12);
    run.all.push_back(Chosen::window(60.0, 59.8));
    run.all.push_back(Chosen::window(61.0, 59.7));  // overlaps that
    run.all.push_back(Chosen::window(63.0, 59.4));
    EXPECT_NEAR(run.fault().chosen_probability,
                0.002 * (1.0 + 0.5 * (1.0 - 0.2 / 0.8) + 0.5 * (1.0 - 0.6 / 0.8)), 2e-6);
    EXPECT_DOUBLE_EQ(run.fault().prior.probability, 0.002);
    for (int k = 0; k < 1000; ++k)
        run.all.push_back(Chosen::window(1000.0 + 3.0 * k, 60.0));
    EXPECT_NEAR(run.fault().chosen_probability, 1.0 - std::pow(0.998, 501.5), 1e-12);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
