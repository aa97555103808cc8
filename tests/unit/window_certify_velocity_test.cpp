#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "stages/window/certify_velocity.h"
#include "stages/window/sample_series.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Two runs northwards at 10 Hz, five minutes together, each with a peak; smoothed without errors.
struct Session {
    ScreenedTable screened;
    TrajectoryTable trajectory;
    std::vector<ArcRows> rows{ArcRows{.number = 1, .rows = {}}};
    std::vector<std::vector<ElapsedTime>> times{1};
    WindowConfig config;
    Profile profile;
    std::vector<FoundWindow> all;

    explicit Session(double white_m_s = 0.1, double stated_m_s = 0.3) {
        RandomGenerator random(2);
        double north_m = 0.0;
        for (std::int64_t k = 0; k < 3000; ++k) {
            const double t = 0.1 * static_cast<double>(k);
            const double speed_m_s = true_speed(t);
            TrajectoryEpoch& row = trajectory.rows.emplace_back();
            row.epoch = k + 1;
            row.time.nanoseconds = 100'000'000 * k;
            times.front().push_back(row.time);
            row.arc = 1;
            row.usable = true;
            row.east_m = 0.0;
            row.north_m = north_m;
            row.velocity_east_m_s = 0.0;
            row.velocity_north_m_s = speed_m_s;
            row.sigma_east_m = row.sigma_north_m = 0.3;
            row.sigma_velocity_east_m_s = row.sigma_velocity_north_m_s = 0.1;
            north_m += 0.05 * (speed_m_s + true_speed(t + 0.1));
            ScreenedEpoch& epoch = screened.rows.emplace_back();
            epoch.epoch = row.epoch;
            epoch.time = row.time;
            epoch.usable = true;
            epoch.recorded_speed_m_s = speed_m_s + white_m_s * random.normal();
            epoch.sigma_recorded_speed_m_s = stated_m_s;
            rows.front().rows.push_back(static_cast<std::size_t>(k));
        }
        trajectory.facts.nominal_interval_s = 0.1;
        trajectory.facts.time_source = "satellites";
        VelocityComparison& velocity = screened.basis.velocity.emplace();
        velocity.scale_m_s = 0.1;
        velocity.delay_s = 0.0;
        velocity.sigma_delay_s = 0.05;
        config.selection_samples = 200;
        profile.speed_source = SpeedSource::velocity;
        profile.definition = SpeedDefinition::mean_n;
        profile.duration_s = 2.0;
        all = {window(1000), window(2000), window(500)};
    }

    static double true_speed(double t) { return 15.0 + std::sin(t * 2.0 * M_PI / 100.0); }

    FoundWindow window(std::size_t first, std::size_t samples = 20) const {
        FoundWindow found;
        found.first = first;
        found.last = first + samples;
        found.start = trajectory.rows[found.first].time;
        found.end = trajectory.rows[found.last].time;
        for (std::size_t k = found.first + 1; k <= found.last; ++k)
            found.speed_m_s += *screened.rows[k].recorded_speed_m_s / static_cast<double>(samples);
        return found;
    }

    VelocityEstimate estimate() const {
        return {screened, trajectory,
                rows,     times,
                config,   compared_speeds(screened, trajectory, rows, profile.dimension)};
    }
    WindowChoice choice(std::size_t which,
                        CertificateExtent extent = CertificateExtent::whole) const {
        return {
            .profile = profile, .found = all[which], .all = all, .quantity = {}, .extent = extent};
    }
    CertifiableWindow certified(std::size_t which = 0) const {
        return certify_by_velocities(estimate(), choice(which));
    }
};

const BudgetRow& row_of(const CertifiableWindow& window, const std::string& symbol) {
    for (const BudgetRow& row : window.budget)
        if (row.symbol == symbol) return row;
    throw std::runtime_error("no row " + symbol);
}

TEST(ComparedSpeeds, StandBesideTheSmoothedTrack) {
    Session session(0.0);
    session.screened.rows[1500].recorded_speed_m_s.reset();
    session.trajectory.rows[2000].usable = false;
    const auto compared = session.estimate().compared;
    ASSERT_EQ(compared.size(), 2998U);
    EXPECT_EQ(compared.front().stretch, compared[1499].stretch);
    EXPECT_NE(compared[1499].stretch, compared[1500].stretch);
    EXPECT_NE(compared[1998].stretch, compared[1999].stretch);
    EXPECT_EQ(compared[1999].stretch, compared.back().stretch);
    for (const ComparedSpeed& one : compared)
        EXPECT_NEAR(one.recorded_m_s, one.smoothed_m_s, 1e-9);
    EXPECT_NEAR(compared[1499].recorded_m, compared[1499].smoothed_m, 1e-3);
    // A delay moves the track's moments, and leaves out those before it begins.
    session.screened.basis.velocity->delay_s = 0.45;
    const auto late = session.estimate().compared;
    EXPECT_EQ(late.size(), 2993U);
    EXPECT_NEAR(late[1000].smoothed_m_s, Session::true_speed(late[1000].time_s - 0.45), 1e-4);
}

TEST(VelocityBudget, HasARowForEachSource) {
    const CertifiableWindow window = Session().certified();
    std::string symbols;
    double square = 0.0;
    for (const BudgetRow& row : window.budget) {
        symbols += row.symbol;
        square += row.contribution_m_s * row.contribution_m_s;
    }
    EXPECT_EQ(symbols, "wbuptlkrdf");
    EXPECT_NEAR(window.standard_uncertainty_m_s, std::sqrt(square), 1e-12);
    EXPECT_NEAR(row_of(window, "w").contribution_m_s, 0.1 / std::sqrt(20.0), 0.005);
    EXPECT_DOUBLE_EQ(row_of(window, "u").contribution_m_s, 0.05);
    EXPECT_EQ(row_of(window, "u").type, "B");
    EXPECT_FALSE(row_of(window, "u").degrees_of_freedom);
    EXPECT_GT(*row_of(window, "w").degrees_of_freedom, 100.0);
    // White noise averages; half of what is stated times sqrt(2 ln n) is not taken off.
    EXPECT_LT(window.standard_uncertainty_m_s, 0.07);
    EXPECT_LT(row_of(window, "f").estimate, 0.06);
    const double scaled_m_s = Session().all[0].speed_m_s * (1.0 - row_of(window, "p").estimate);
    EXPECT_NEAR(window.speed_m_s, scaled_m_s - row_of(window, "f").estimate, 1e-12);
    EXPECT_GT(window.bias_limit_m_s, 0.0);
}

TEST(VelocityBudget, CoversTheChoiceWhereTheRuleSaysSo) {
    Session session;
    const CertifiableWindow subtracted = session.certified();
    session.profile.uncertainty.selection_bias = SelectionTreatment::covered;
    const CertifiableWindow covered = session.certified();
    EXPECT_DOUBLE_EQ(covered.speed_m_s,
                     session.all[0].speed_m_s * (1.0 - row_of(covered, "p").estimate));
    EXPECT_NEAR(covered.bias_limit_m_s,
                row_of(subtracted, "f").estimate + subtracted.bias_limit_m_s, 1e-9);
}

/// Speeds 1.5 % too high beat a record that the positions did not show.
TEST(VelocityBudget, TakesOffTheScaleThatThePositionsShow) {
    Session session;
    for (TrajectoryEpoch& row : session.trajectory.rows)  // as positions wander
        *row.north_m += 0.2 * std::sin(0.3 * row.time.seconds());
    const double honest_m_s = session.certified().speed_m_s;
    for (ScreenedEpoch& row : session.screened.rows)
        *row.recorded_speed_m_s *= 1.015;
    session.all[0] = session.window(1000);
    const CertifiableWindow window = session.certified();
    EXPECT_NEAR(window.speed_m_s, honest_m_s, 0.05);
    EXPECT_NEAR(row_of(window, "p").estimate, 0.015, 0.003);
    EXPECT_GT(row_of(window, "p").contribution_m_s, 0.0);
}

/// A refused sample ends the windows that hold it, and what its tests leave has a price.
TEST(VelocityBudget, PricesWhatTheTestsOfTheSpeedsLeave) {
    Session session;
    EXPECT_EQ(row_of(session.certified(), "d").contribution_m_s, 0.0);
    session.screened.basis.power = 0.8;
    session.screened.basis.speeds = {
        {.axes = TestedAxes::horizontal,
         .detectable = {{.samples = 1, .size_m_s = 1.0}, {.samples = 10, .size_m_s = 0.4}}}};
    EXPECT_NEAR(row_of(session.certified(), "d").contribution_m_s,
                std::sqrt(1.0 / 200.0) * 0.2 / std::sqrt(3.0), 1e-12);
    EXPECT_FALSE(velocities_left_out(session.screened.rows, std::nullopt, false)[1010]);
    session.screened.rows[1010].speed_test = {.refused = Hypothesis::outlier,
                                              .axes = TestedAxes::horizontal};
    EXPECT_TRUE(velocities_left_out(session.screened.rows, std::nullopt, false)[1010]);
    const auto series =
        certifiable_series(session.screened, session.trajectory, session.rows, session.profile);
    EXPECT_EQ(series.front().obstacles[1010] - series.front().obstacles[1009], 1);
    // Nor may a window begin with it: a path counts half of its first speed.
    EXPECT_FALSE(series.front().bounds[1010]);
    EXPECT_TRUE(series.front().bounds[1011]);
}

TEST(VelocityBudget, HoldsWhatAWindowPartsFromItsPositionsByBeyondTheUsual) {
    Session session;
    const double usual = row_of(session.certified(), "b").contribution_m_s;
    for (std::size_t k = 1000; k <= 1020; ++k)
        *session.screened.rows[k].recorded_speed_m_s += 0.4;
    session.all[0] = session.window(1000);
    EXPECT_GT(row_of(session.certified(), "b").contribution_m_s, usual + 0.3);
}

TEST(VelocityBudget, CountsTheClockThatNobodyKnows) {
    Session session;
    EXPECT_EQ(row_of(session.certified(), "k").contribution_m_s, 0.0);
    session.trajectory.facts.time_source = "unknown";
    const CertifiableWindow window = session.certified();
    EXPECT_NEAR(row_of(window, "k").contribution_m_s,
                session.all[0].speed_m_s * session.config.clock_rate_bound / std::sqrt(3.0), 1e-9);
}

TEST(VelocityBudget, CountsDelayAndStampsWhereWindowsEndAtPlaces) {
    Session session(0.0);
    session.all[0] = session.window(800, 100);  // while it slows down
    session.trajectory.facts.time_resolution_s = 0.05;
    session.trajectory.facts.nominal_interval_s = 0.07;  // no stamp is a multiple
    EXPECT_EQ(row_of(session.certified(), "l").contribution_m_s, 0.0);
    EXPECT_EQ(row_of(session.certified(), "t").contribution_m_s, 0.0);
    session.profile.window_kind = WindowKind::alpha;
    const CertifiableWindow window = session.certified();
    const double changes_m_s2 =
        std::abs(Session::true_speed(90.0) - Session::true_speed(80.0)) / 10.0;
    EXPECT_NEAR(row_of(window, "l").contribution_m_s, 0.05 * changes_m_s2, 1e-9);
    EXPECT_NEAR(row_of(window, "t").contribution_m_s, 0.025 * std::sqrt(2.0 / 3.0) * changes_m_s2,
                1e-9);
}

TEST(VelocityBudget, CountsTheStepOfCoarseSpeeds) {
    Session session(0.1);
    for (ScreenedEpoch& row : session.screened.rows)
        row.recorded_speed_m_s = 0.5 * std::round(*row.recorded_speed_m_s / 0.5);
    EXPECT_NEAR(row_of(session.certified(), "r").contribution_m_s, 0.25 / std::sqrt(3.0), 1e-9);
}

TEST(CertificateExtent, LeavesOutTheChoiceAlone) {
    Session session;
    const CertifiableWindow window = session.certified();
    const CertifiableWindow compared =
        certify_by_velocities(session.estimate(), session.choice(0, CertificateExtent::to_compare));
    EXPECT_EQ(compared.budget.size(), window.budget.size());
    EXPECT_EQ(compared.bias_limit_m_s, 0.0);
    EXPECT_EQ(row_of(compared, "f").contribution_m_s, 0.0);
    for (const BudgetRow& row : compared.budget)
        EXPECT_EQ(row.contribution_m_s,
                  row.symbol == "f" ? 0.0 : row_of(window, row.symbol).contribution_m_s);
}

TEST(VelocityWindow, OfSpeedsThatThePositionsDoNotShowIsContradicted) {
    Session session;
    EXPECT_LT(session.certified().witnesses.front().normalised_error, 1.0);
    for (std::size_t k = session.all[0].first; k <= session.all[0].last; ++k)
        *session.screened.rows[k].recorded_speed_m_s += 1.0;
    session.all[0] = session.window(1000);
    EXPECT_GT(session.certified().witnesses.front().normalised_error, 1.0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
