#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "chain_support.h"
#include "core/text.h"
#include "schemas/imu/declared.h"
#include "schemas/observations/observations.h"

// An IMU beside a recording, from the attempt to the products.

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr const char* keys = R"(
    imu:
      file: imu.csv
      columns: {time: time_s, gyro_x: gx, gyro_y: gy, gyro_z: gz, accelerometer_x: ax, accelerometer_y: ay, accelerometer_z: az}
      axes: {x: forward, y: right, z: down}
      grade: mems
      antenna_m: {forward: 0.0, right: 0.0, down: -5.0}
      reference_point_m: {forward: 0.5, right: 0.0, down: 0.0}
record:)";

/// The land yacht's example, its count of time begun at 100 s, with an IMU at rest beside it from
/// 99 s on.
class ImuRun {
  public:
    explicit ImuRun(const std::string& imu_keys = keys, double first_s = 99.0) {
        std::string recording;
        for (const std::string& line :
             lines_of(read_file(examples / "land_yacht/appendix_a_simulated_ppk.csv"))) {
            const std::size_t from = line.find(',') + 1, to = line.find(',', from);
            const auto time_s = parse_double(line.substr(from, to - from));
            recording += time_s ? fmt::format("{}{:.1f}{}\n", line.substr(0, from), *time_s + 100.0,
                                              line.substr(to))
                                : line + "\n";
        }
        write_file_atomically(folder_.path() / "appendix_a_simulated_ppk.csv", recording);
        std::string attempt = read_file(examples / "land_yacht/attempt.yaml");
        const std::size_t at = attempt.find("\nrecord:");
        attempt.replace(at, std::string_view("\nrecord:").size(), imu_keys);
        write_file_atomically(folder_.path() / "attempt.yaml", attempt);
        std::string samples = "time_s,gx,gy,gz,ax,ay,az\n";
        for (int i = 0; i < 4700; ++i)
            samples += fmt::format("{:.2f},0.001,0,{:.4f},0,0,-9.8\n", first_s + 0.01 * i,
                                   0.0001 * (i % 7));
        write_file_atomically(folder_.path() / "imu.csv", samples);
    }
    fs::path run() const { return folder_.path() / "run"; }
    ProcessResult certified() const {
        return certify(folder_.path() / "attempt.yaml", run(), {"--no-render"});
    }

  private:
    TemporaryFolder folder_;
};

TEST(ImuChain, ARecordingsOwnCountOfTimeTiesTheImuAndItsPositionsStayAsTheyAre) {
    const ImuRun with;
    const ProcessResult certified = with.certified();
    ASSERT_NE(certified.exit_status, 2) << certified.errors;
    const ImuTable imu = read_imu(read_file(with.run() / "1-imu.ecsv"), "1-imu.ecsv");
    ASSERT_EQ(imu.rows.size(), 4700U);
    EXPECT_FALSE(imu.first_epoch);
    EXPECT_EQ(imu.rows[0].time.nanoseconds, -1'000'000'000);
    EXPECT_EQ(imu.rows[4699].time.nanoseconds, 45'990'000'000);
    EXPECT_EQ(*imu.rows[0].source_line, 2);
    EXPECT_EQ(imu.grade, (ImuGrade{.name = "mems"}));
    EXPECT_EQ(imu.antenna, (LeverArm{0.0, 0.0, -5.0}));
    EXPECT_EQ(imu.reference_point, (LeverArm{0.5, 0.0, 0.0}));
    EXPECT_EQ(imu.header.parameters.at("imu").at("grade"), "mems");
    EXPECT_EQ(imu.notes.front(), "The IMU's times are taken as the recording's own count of time.");
    const ImuRun without("\nrecord:");
    ASSERT_NE(without.certified().exit_status, 2);
    const auto positions = [](const ImuRun& run) {
        return read_observations(read_file(run.run() / "1-observations.ecsv"), "f");
    };
    const Observations a = positions(with), b = positions(without);
    ASSERT_EQ(a.rows.size(), b.rows.size());
    EXPECT_EQ(a.rows.back().plane_east_m, b.rows.back().plane_east_m);
    EXPECT_EQ(*a.header.parameters, *b.header.parameters);
    EXPECT_FALSE(fs::exists(without.run() / "1-imu.ecsv"));
    EXPECT_EQ(read_file(with.run() / "2-enu.ecsv")
                  .substr(read_file(with.run() / "2-enu.ecsv").rfind("\n#")),
              read_file(without.run() / "2-enu.ecsv")
                  .substr(read_file(without.run() / "2-enu.ecsv").rfind("\n#")));
    // What is exported and audited knows the table.
    const ProcessResult exported =
        runcert({"export", with.run().string(), "--format", "csv", "--table", "imu", "--out", "-"});
    EXPECT_EQ(exported.exit_status, 0) << exported.errors;
    EXPECT_NE(exported.output.find("force_down"), std::string::npos)
        << exported.output.substr(0, 300);
    const ProcessResult none = runcert(
        {"export", without.run().string(), "--format", "csv", "--table", "imu", "--out", "-"});
    EXPECT_EQ(none.exit_status, 2);
    EXPECT_NE(none.errors.find("hands in no IMU"), std::string::npos) << none.errors;
    const ProcessResult audited = runcert({"audit", with.run().string()});
    EXPECT_EQ(audited.exit_status, 0) << audited.errors;
    EXPECT_NE(audited.output.find("1-imu.ecsv"), std::string::npos);
    EXPECT_NE(audited.output.find("4,700 samples"), std::string::npos) << audited.output;
}

TEST(ImuChain, AnImuOfAnotherRunIsRefused) {
    const ImuRun run(keys, 900.0);
    const ProcessResult refused = run.certified();
    EXPECT_EQ(refused.exit_status, 2);
    EXPECT_NE(refused.errors.find("share no time with the recording"), std::string::npos)
        << refused.errors;
    EXPECT_NE(refused.errors.find("attempt.yaml:17:"), std::string::npos) << refused.errors;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
