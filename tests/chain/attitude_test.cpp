#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "chain_support.h"
#include "core/geodesy.h"
#include "schemas/attitude/declared.h"
#include "schemas/windows/windows.h"
#include "simulation/inertial_run.h"

// A craft whose antenna swings on a mast, with an IMU at its hull: from the attempt to the speeds
// of both points.

namespace runcert::chain::RUNCERT_FILE {
namespace {

std::string recording_of(const std::vector<PositionFix>& fixes, const Geodetic& origin) {
    const LocalFrame frame(origin);
    std::string positions = "time,lat,lon,height\n";
    for (const PositionFix& fix : fixes) {
        const Geodetic place = frame.geodetic_from_enu({fix.enu_m});
        positions +=
            fmt::format("{:.3f},{:.10f},{:.10f},{:.4f}\n", fix.time_s, place.latitude.degrees(),
                        place.longitude.degrees(), place.height_m);
    }
    return positions;
}

/// How a recording is described.
constexpr const char* described = R"(    format: csv
    frame: geodetic
    columns: {time: time, latitude: lat, longitude: lon, height: height}
    accuracy: {horizontal_m: 0.012, vertical_m: 0.020}
    solution: fixed
    start_gps: "2026-10-20T11:00:58.000"
)";

/// What an attempt states, and what is wrong with its recordings.
struct MastAttempt {
    double antenna_down_m = -5.0;
    double rate_sign = 1.0;     ///< of the gyros
    double drift_m_s = 0.0;     ///< of the positions, towards where the craft goes
    double drift_from_s = 0.0;  ///< for 3 s
    std::string profiles = "nalsa";
    std::string axes = "{x: forward, y: right, z: down}";
    Eigen::Vector3d second_m = Eigen::Vector3d::Zero();  ///< of the second antenna, if there is one
};

/// Simulated recordings and their attempt.
class MastRun {
  public:
    explicit MastRun(const InertialRunSpec& spec, const MastAttempt& attempt)
        : simulated_(simulate_inertial(spec)) {
        drift(attempt);
        write_file_atomically(folder_.path() / "run.csv",
                              recording_of(simulated_.fixes, spec.origin));
        std::string second;
        if (spec.second_antenna_m) {
            write_file_atomically(folder_.path() / "bow.csv",
                                  recording_of(simulated_.second_fixes, spec.origin));
            // From the antenna to the reference point, which is at the IMU.
            second = fmt::format(
                "  - id: bow\n    recording: bow.csv\n{}    lever_arm_m: {{forward: {:.2f}, right: "
                "{:.2f}, down: {:.2f}}}\n",
                described, -attempt.second_m.x(), -attempt.second_m.y(), -attempt.second_m.z());
        }
        std::string imu = "time,gx,gy,gz,ax,ay,az\n";
        for (const ImuSample& sample : simulated_.samples) {
            const Eigen::Vector3d rate = attempt.rate_sign * sample.angle_rad / sample.interval_s;
            const Eigen::Vector3d force = sample.velocity_m_s / sample.interval_s;
            imu += fmt::format("{:.4f},{:.9f},{:.9f},{:.9f},{:.8f},{:.8f},{:.8f}\n", sample.time_s,
                               rate.x(), rate.y(), rate.z(), force.x(), force.y(), force.z());
        }
        write_file_atomically(folder_.path() / "imu.csv", imu);
        write_file_atomically(
            folder_.path() / "attempt.yaml",
            fmt::format(R"(schema: attempt/1.0
id: mast
craft: {{name: simulated yacht, class: land-yacht}}
place: a simulated lake
officials: [{{role: measurer}}]
receivers:
  - id: primary
    recording: run.csv
{}    imu:
      file: imu.csv
      columns: {{time: time, gyro_x: gx, gyro_y: gy, gyro_z: gz, accelerometer_x: ax, accelerometer_y: ay, accelerometer_z: az}}
      axes: {}
      grade: mems
      antenna_m: {{forward: 0.0, right: 0.0, down: {:.2f}}}
      reference_point_m: {{forward: 0.0, right: 0.0, down: 0.0}}
{}record: {{speed: 150, unit: km/h, source: "a simulation"}}
profiles: [{}]
)",
                        described, attempt.axes, attempt.antenna_down_m, second, attempt.profiles));
        write_craft_rule();
    }
    fs::path folder() const { return folder_.path() / "run"; }
    ProcessResult certified() const {
        EXPECT_EQ(runcert({"keygen", "--out", path("measurer"), "--no-password"}).exit_status, 0);
        return certify(folder_.path() / "attempt.yaml", folder(),
                       {"--no-render", "--key", path("measurer.key")});
    }
    ProcessResult verified() const {
        return runcert(
            {"verify", folder().string(), "--recompute", "--pubkey", path("measurer.pub")});
    }
    AttitudeTable attitude() const {
        return read_attitude(read_file(folder() / "4-attitude.ecsv"), "4-attitude.ecsv");
    }
    Windows windows() const { return read_windows(read_file(folder() / "5-windows.yaml"), "f"); }
    /// As it holds once officials have answered for the IMU.
    CertifiableWindow window(std::size_t rule = 0) const {
        const Windows found = windows();
        return *(found.with_files.empty() ? found.profiles : found.with_files).at(rule).best;
    }
    const std::vector<InertialTruth>& truth() const { return simulated_.truth; }

    /// The true chord speed of the reference point over a window, and that of the antenna.
    double true_speed_m_s(const WindowSpan& span) const {
        return true_speed_m_s(span, &InertialTruth::reference_point_m);
    }
    double true_antenna_speed_m_s(const WindowSpan& span) const {
        return true_speed_m_s(span, &InertialTruth::antenna_m);
    }

  private:
    double true_speed_m_s(const WindowSpan& span, Eigen::Vector3d InertialTruth::*point) const {
        const auto at = [&](double time_s) {
            for (const InertialTruth& one : truth())
                if (std::abs(one.time_s - time_s - truth().front().time_s) < 1e-4)
                    return one.*point;
            ADD_FAILURE() << time_s;
            return truth().front().*point;
        };
        const double start_s = span.start.seconds(), duration_s = span.duration.seconds();
        return (at(start_s + duration_s) - at(start_s)).head<2>().norm() / duration_s;
    }

    void drift(const MastAttempt& attempt) {
        if (attempt.drift_m_s == 0.0) return;
        const double begin_s = simulated_.fixes.front().time_s + attempt.drift_from_s;
        const Eigen::Vector3d along =
            (simulated_.fixes.back().enu_m - simulated_.fixes.front().enu_m).normalized();
        for (PositionFix& fix : simulated_.fixes)
            fix.enu_m += attempt.drift_m_s * std::clamp(fix.time_s - begin_s, 0.0, 3.0) * along;
    }

    /// NALSA's rule, of the craft's speed.
    void write_craft_rule() const {
        std::string rule =
            read_file(fs::path(RUNCERT_SOURCE_DIR) / "stages/check/profiles/nalsa.yaml");
        const auto replace = [&](std::string_view from, std::string_view to) {
            rule.replace(rule.find(from), from.size(), to);
        };
        replace("id: nalsa\n", "id: craft\nspeed_of: reference_point\n");
        write_file_atomically(folder_.path() / "craft.yaml", rule);
    }

    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    TemporaryFolder folder_;
    InertialRun simulated_;
};

InertialRunSpec mast_spec() {
    InertialRunSpec spec;
    spec.noise = imu_noise(ImuClass::mems);
    spec.seed = 5;
    spec.pitch_deg = 5.0;
    return spec;
}

TEST(MastChain, BothSpeedsAreWrittenAndThatOfTheHullIsRight) {
    const MastRun run(mast_spec(), {});
    const ProcessResult certified = run.certified();
    ASSERT_NE(certified.exit_status, 2) << certified.errors;
    const AttitudeTable attitude = run.attitude();
    EXPECT_EQ(attitude.consistency.standing, InertialStanding::consistent)
        << attitude.consistency.reason;
    EXPECT_EQ(attitude.consistency.start, InertialStart::course);
    EXPECT_EQ(attitude.antenna.declared, (LeverArm{0.0, 0.0, -5.0}));
    EXPECT_EQ(attitude.antenna.used, (LeverArm{0.0, 0.0, -5.0}));
    std::size_t known = 0;
    for (std::size_t i = 0; i < attitude.rows.size(); ++i) {
        const AttitudeEpoch& row = attitude.rows[i];
        if (!row.roll_deg) continue;
        ++known;
        const EulerAngles truth = euler_angles(run.truth()[i].imu.enu_from_body);
        EXPECT_NEAR(*row.roll_deg, truth.roll * degrees_per_radian, 0.3) << i;
        EXPECT_NEAR(*row.pitch_deg, truth.pitch * degrees_per_radian, 0.3) << i;
        EXPECT_NEAR(std::remainder(*row.heading_deg - truth.heading * degrees_per_radian, 360.0),
                    0.0, 0.6)
            << i;
    }
    EXPECT_GT(known, attitude.rows.size() - 15);
    const CertifiableWindow window = run.window();
    EXPECT_EQ(window.points.antenna_speed_m_s, window.speed_m_s);
    ASSERT_TRUE(window.points.reference_point_speed_m_s);
    const double expanded = *window.points.reference_point_expanded_uncertainty_m_s;
    EXPECT_LT(expanded, 0.008);
    EXPECT_NEAR(*window.points.reference_point_speed_m_s, run.true_speed_m_s(window.span),
                1.5 * expanded);
    // Beside the swinging antenna.
    EXPECT_GT(std::abs(*window.points.reference_point_speed_m_s - window.speed_m_s), 0.01);
    // The craft points into the wind by its leeway, 2 to 3 degrees; the plane's north is that of
    // the first position, and 3 s turn a geodesic by far less.
    ASSERT_TRUE(window.course && window.course->heading_deg);
    EXPECT_NEAR(window.course->plane_deg - *window.course->heading_deg, 2.5, 0.7);
    EXPECT_NEAR(window.course->loxodrome_deg, window.course->plane_deg, 0.05);
    EXPECT_NEAR(window.course->loxodrome_deg, window.course->geodesic_deg, 1e-3);
    EXPECT_NE(window.course->loxodrome_deg, window.course->geodesic_deg);
    const ProcessResult audit = runcert({"audit", run.folder().string()});
    for (const char* name :
         {"Course of the run", "Course of the window", "mean heading of the craft"})
        EXPECT_NE(audit.output.find(name), std::string::npos) << audit.output;
    // It verifies, each step made again; and no more if a table was changed.
    const ProcessResult whole = run.verified();
    EXPECT_NE(whole.output.find("\nVERIFIED"), std::string::npos) << whole.output;
    for (const char* table : {"1-imu.ecsv", "4-attitude.ecsv"}) {
        const std::string text = read_file(run.folder() / table);
        std::string changed = text;
        char& digit = changed[text.size() - 40];
        digit = digit == '1' ? '2' : '1';
        write_file_atomically(run.folder() / table, changed);
        EXPECT_EQ(run.verified().exit_status, 1) << table;
        write_file_atomically(run.folder() / table, text);
    }
}

TEST(MastChain, WhereImuAndPositionsDoNotAgreeThereIsNoSecondSpeedButAReason) {
    // The mast is twice as long as stated; the gyros' signs are wrong.
    for (const bool wrong_mast : {true, false}) {
        const MastRun run(mast_spec(), {.antenna_down_m = wrong_mast ? -2.5 : -5.0,
                                        .rate_sign = wrong_mast ? 1.0 : -1.0});
        const ProcessResult certified = run.certified();
        ASSERT_NE(certified.exit_status, 2) << certified.errors;
        const AttitudeTable attitude = run.attitude();
        EXPECT_NE(attitude.consistency.standing, InertialStanding::consistent);
        EXPECT_FALSE(attitude.consistency.reason.empty());
        EXPECT_FALSE(run.window().points.reference_point_speed_m_s);
        EXPECT_TRUE(run.window().points.antenna_speed_m_s);
    }
}

// Reversed on a straight run: displacements are right, and places on the craft are not.
TEST(MastChain, AxesThatPointBackwardsAreRefused) {
    InertialRunSpec spec = mast_spec();
    spec.antenna_m = {0.0, 0.0, -1.0};
    spec.roll_deg = 2.0;
    spec.pitch_deg = 1.0;
    const MastRun run(spec, {.antenna_down_m = -1.0, .axes = "{x: -forward, y: -right, z: down}"});
    ASSERT_NE(run.certified().exit_status, 2);
    const AttitudeTable attitude = run.attitude();
    EXPECT_NE(attitude.consistency.standing, InertialStanding::consistent);
    EXPECT_NE(attitude.consistency.reason.find("axes"), std::string::npos)
        << attitude.consistency.reason;
    EXPECT_FALSE(run.window().points.reference_point_speed_m_s);
}

TEST(MastChain, ARuleThatCountsTheCraftJudgesTheHull) {
    const MastRun run(mast_spec(), {.profiles = "nalsa, craft.yaml"});
    const ProcessResult certified = run.certified();
    ASSERT_NE(certified.exit_status, 2) << certified.errors;
    // Before that answer nothing is certified under the rule of the craft.
    EXPECT_FALSE(run.windows().profiles.at(1).best);
    EXPECT_NE(certified.output.find("answer for it (imu-as-measured)"), std::string::npos);
    const CertifiableWindow antenna = run.window(0), craft = run.window(1);
    EXPECT_GT(antenna.speed_m_s - craft.speed_m_s, 0.015);
    EXPECT_EQ(craft.points.reference_point_speed_m_s, craft.speed_m_s);
    EXPECT_NEAR(craft.speed_m_s, run.true_speed_m_s(craft.span),
                *craft.points.reference_point_expanded_uncertainty_m_s);
    // Another window is the craft's fastest; its speed there is that of the inertial solution.
    const double own_u = craft.standard_uncertainty_m_s;
    EXPECT_GT(own_u, 0.5 * antenna.standard_uncertainty_m_s);
    EXPECT_LT(own_u, 2.0 * antenna.standard_uncertainty_m_s);
    std::string symbols;
    for (const BudgetRow& row : craft.budget)
        if (std::string_view("ayz").find(row.symbol) != std::string_view::npos) {
            symbols += row.symbol;
            EXPECT_GT(row.contribution_m_s, 0.0) << row.source;
            EXPECT_LT(row.contribution_m_s, 0.02) << row.source;
        }
    EXPECT_EQ(symbols, "ayz");
    EXPECT_NE(run.verified().output.find("\nVERIFIED"), std::string::npos);
}

TEST(MastChain, TheImuContradictsADriftOfThePositions) {
    const MastRun run(mast_spec(), {.drift_m_s = 0.5, .drift_from_s = 83.9});
    const ProcessResult certified = run.certified();
    ASSERT_NE(certified.exit_status, 2) << certified.errors;
    // The drift makes the fastest window, and no window that overlaps it is certified.
    const ProfileWindows found = run.windows().profiles.at(0);
    ASSERT_TRUE(found.fastest) << certified.output;
    EXPECT_GT(found.fastest->speed_m_s, run.true_antenna_speed_m_s(found.fastest->span) + 0.3);
    const auto imu =
        std::ranges::find(found.fastest->witnesses, WitnessKind::imu, &WitnessedSpeed::kind);
    ASSERT_NE(imu, found.fastest->witnesses.end());
    EXPECT_TRUE(contradicts(*imu));
    EXPECT_NEAR(imu->speed_m_s, run.true_antenna_speed_m_s(found.fastest->span),
                4.0 * imu->standard_uncertainty_m_s);
    EXPECT_NEAR(found.best->speed_m_s, run.true_antenna_speed_m_s(found.best->span), 0.1);
}

// A second antenna at the bow, 2 m ahead: the craft stands, and its heading is known.
InertialRunSpec bow_spec() {
    InertialRunSpec spec = mast_spec();
    spec.antenna_m = {0.0, 0.0, -1.0};
    spec.second_antenna_m = Eigen::Vector3d(2.0, 0.3, -0.5);
    spec.stand_s = 30.0;
    spec.duration_s = 60.0;
    return spec;
}

TEST(MastChain, TwoAntennasShowTheHeading) {
    const InertialRunSpec spec = bow_spec();
    const MastRun run(spec, {.antenna_down_m = -1.0, .second_m = *spec.second_antenna_m});
    const ProcessResult certified = run.certified();
    ASSERT_NE(certified.exit_status, 2) << certified.errors;
    const AttitudeTable attitude = run.attitude();
    EXPECT_EQ(attitude.consistency.standing, InertialStanding::consistent)
        << attitude.consistency.reason;
    EXPECT_EQ(attitude.consistency.start, InertialStart::antennas);
    ASSERT_TRUE(attitude.baseline && attitude.baseline->difference_deg);
    EXPECT_EQ(attitude.baseline->receiver, "bow");
    EXPECT_EQ(attitude.baseline->declared, (LeverArm{2.0, 0.3, 0.5}));
    EXPECT_TRUE(attitude.baseline->agrees) << attitude.baseline->judgement;
    EXPECT_NEAR(*attitude.baseline->length_m, spec.second_antenna_m->norm(), 0.03);
    EXPECT_GT(attitude.baseline->epochs, 850);
    EXPECT_LT(std::abs(*attitude.baseline->difference_deg), 0.3);
    double squares = 0.0, count = 0.0;
    for (std::size_t i = 0; i < attitude.rows.size(); ++i) {
        const AttitudeEpoch& row = attitude.rows[i];
        ASSERT_EQ(row.baseline_heading_deg.has_value(), row.heading_deg.has_value()) << i;
        if (!row.baseline_heading_deg) continue;
        const EulerAngles truth = euler_angles(run.truth()[i].imu.enu_from_body);
        squares += std::pow(
            std::remainder(*row.baseline_heading_deg - truth.heading * degrees_per_radian, 360.0),
            2);
        count += 1.0;
    }
    EXPECT_NEAR(std::sqrt(squares / count), 0.58, 0.12);
    EXPECT_TRUE(run.window().points.reference_point_speed_m_s);
    const std::string audit = runcert({"audit", run.folder().string()}).output;
    EXPECT_NE(audit.find("the antenna of bow the heading is"), std::string::npos) << audit;
    const ProcessResult whole = run.verified();
    EXPECT_NE(whole.output.find("\nVERIFIED"), std::string::npos) << whole.output;
}

TEST(MastChain, AnAntennaThatIsNotWhereItIsStatedIsNamed) {
    const InertialRunSpec spec = bow_spec();
    for (const auto& [second_m, words] :
         {std::pair(Eigen::Vector3d(1.0, 0.3, -0.5), "Its place on the craft is not as stated"),
          std::pair(Eigen::Vector3d(0.3, -2.0, -0.5), "The two do not agree")}) {
        const MastRun run(spec, {.antenna_down_m = -1.0, .second_m = second_m});
        ASSERT_NE(run.certified().exit_status, 2);
        const AttitudeTable attitude = run.attitude();
        ASSERT_TRUE(attitude.baseline);
        EXPECT_FALSE(attitude.baseline->agrees);
        EXPECT_NE(attitude.baseline->judgement.find(words), std::string::npos)
            << attitude.baseline->judgement;
        // Of antennas at another distance no heading is taken.
        const bool as_stated = attitude.baseline->difference_deg.has_value();
        EXPECT_EQ(as_stated, second_m.x() < 0.5);
        EXPECT_EQ(std::ranges::any_of(attitude.rows,
                                      [](const AttitudeEpoch& row) {
                                          return row.baseline_heading_deg.has_value();
                                      }),
                  as_stated);
        EXPECT_EQ(attitude.consistency.standing, InertialStanding::consistent)
            << attitude.consistency.reason;
    }
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
