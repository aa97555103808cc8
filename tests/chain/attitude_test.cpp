#include <fmt/format.h>
#include <gtest/gtest.h>

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

/// What an attempt states, and what is wrong with its recordings.
struct MastAttempt {
    double antenna_down_m = -5.0;
    double rate_sign = 1.0;     ///< of the gyros
    double drift_m_s = 0.0;     ///< of the positions, towards where the craft goes
    double drift_from_s = 0.0;  ///< for 3 s
    std::string profiles = "nalsa";
};

/// Simulated recordings and their attempt.
class MastRun {
  public:
    explicit MastRun(const InertialRunSpec& spec, const MastAttempt& attempt)
        : simulated_(simulate_inertial(spec)) {
        drift(attempt);
        const LocalFrame frame(spec.origin);
        std::string positions = "time,lat,lon,height\n";
        for (const PositionFix& fix : simulated_.fixes) {
            const Geodetic place = frame.geodetic_from_enu({fix.enu_m});
            positions +=
                fmt::format("{:.3f},{:.10f},{:.10f},{:.4f}\n", fix.time_s, place.latitude.degrees(),
                            place.longitude.degrees(), place.height_m);
        }
        write_file_atomically(folder_.path() / "run.csv", positions);
        std::string imu = "time,gx,gy,gz,ax,ay,az\n";
        for (const ImuSample& sample : simulated_.samples) {
            const Eigen::Vector3d rate = attempt.rate_sign * sample.angle_rad / sample.interval_s;
            const Eigen::Vector3d force = sample.velocity_m_s / sample.interval_s;
            imu += fmt::format("{:.4f},{:.9f},{:.9f},{:.9f},{:.8f},{:.8f},{:.8f}\n", sample.time_s,
                               rate.x(), rate.y(), rate.z(), force.x(), force.y(), force.z());
        }
        write_file_atomically(folder_.path() / "imu.csv", imu);
        write_file_atomically(folder_.path() / "attempt.yaml",
                              fmt::format(R"(schema: attempt/1.0
id: mast
craft: {{name: simulated yacht, class: land-yacht}}
place: a simulated lake
officials: [{{role: measurer}}]
receivers:
  - id: primary
    recording: run.csv
    format: csv
    frame: geodetic
    columns: {{time: time, latitude: lat, longitude: lon, height: height}}
    accuracy: {{horizontal_m: 0.012, vertical_m: 0.020}}
    solution: fixed
    imu:
      file: imu.csv
      columns: {{time: time, gyro_x: gx, gyro_y: gy, gyro_z: gz, accelerometer_x: ax, accelerometer_y: ay, accelerometer_z: az}}
      axes: {{x: forward, y: right, z: down}}
      grade: mems
      antenna_m: {{forward: 0.0, right: 0.0, down: {:.2f}}}
      reference_point_m: {{forward: 0.0, right: 0.0, down: 0.0}}
record: {{speed: 150, unit: km/h, source: "a simulation"}}
profiles: [{}]
)",
                                          attempt.antenna_down_m, attempt.profiles));
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
    CertifiableWindow window(std::size_t rule = 0) const {
        return *windows().profiles.at(rule).best;
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

TEST(MastChain, ARuleThatCountsTheCraftJudgesTheHull) {
    const MastRun run(mast_spec(), {.profiles = "nalsa, craft.yaml"});
    const ProcessResult certified = run.certified();
    ASSERT_NE(certified.exit_status, 2) << certified.errors;
    const CertifiableWindow antenna = run.window(0), craft = run.window(1);
    EXPECT_GT(antenna.speed_m_s - craft.speed_m_s, 0.02);
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
    const MastRun run(mast_spec(), {.drift_m_s = 0.5, .drift_from_s = 90.0});
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

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
