#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "chain_support.h"
#include "core/decimal.h"
#include "core/text.h"
#include "schemas/attitude/declared.h"
#include "schemas/windows/windows.h"

// examples/mast: an antenna that swings on a mast is faster than its craft. The same with what goes
// wrong on a craft: a tape measure, a clock, no IMU at all.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// truth.csv, a map from column to value for each epoch.
std::vector<std::map<std::string, double>> read_truth(const fs::path& file) {
    const auto cells_of = [](const std::string& line) {
        std::vector<std::string> cells(1);
        for (const char c : line)
            if (c == ',')
                cells.emplace_back();
            else
                cells.back() += c;
        return cells;
    };
    std::vector<std::string> lines = lines_of(read_file(file));
    const std::vector<std::string> names = cells_of(lines.at(1));
    std::vector<std::map<std::string, double>> rows;
    for (std::size_t i = 2; i < lines.size(); ++i) {
        const std::vector<std::string> cells = cells_of(lines[i]);
        if (cells.size() != names.size()) continue;
        auto& row = rows.emplace_back();
        for (std::size_t k = 0; k < names.size(); ++k)
            row[names[k]] = parse_double(cells[k]).value();
    }
    return rows;
}

using Changes = std::vector<std::pair<std::string, std::string>>;

void change(std::string& text, const Changes& changes) {
    for (const auto& [from, to] : changes) {
        EXPECT_NE(text.find(from), std::string::npos) << from;
        text.replace(text.find(from), from.size(), to);
    }
}

/// The example's simulation, changed, and certified by its attempt, changed too.
class MastExample {
  public:
    explicit MastExample(const Changes& of_spec = {}, const Changes& of_attempt = {}) {
        std::string spec = read_file(examples / "mast/spec.yaml");
        change(spec, of_spec);
        write_file_atomically(folder_.path() / "spec.yaml", spec);
        const ProcessResult made = runcert({"simulate", (folder_.path() / "spec.yaml").string(),
                                            "--out", (folder_.path() / "made").string()});
        EXPECT_EQ(made.exit_status, 0) << made.errors;
        const fs::path attempt_file = folder_.path() / "made/attempt.yaml";
        std::string attempt = read_file(attempt_file);
        change(attempt, of_attempt);
        fs::copy_file(examples / "mast/nalsa-of-the-craft.yaml",
                      folder_.path() / "made/nalsa-of-the-craft.yaml");
        write_file_atomically(attempt_file, attempt);
        certified_ = certify(attempt_file, run(), {"--no-render"});
        EXPECT_LT(certified_.exit_status, 2) << certified_.errors;
        truth_ = read_truth(folder_.path() / "made/truth.csv");
    }

    fs::path run() const { return folder_.path() / "run"; }
    const ProcessResult& certified() const { return certified_; }
    const std::vector<std::map<std::string, double>>& truth() const { return truth_; }
    AttitudeTable attitude() const {
        return read_attitude(read_file(run() / "4-attitude.ecsv"), "4-attitude.ecsv");
    }
    /// As it holds once officials have answered for the files beside the recording.
    CertifiableWindow window() const {
        const Windows found = read_windows(read_file(run() / "5-windows.yaml"), "f");
        return *(found.with_files.empty() ? found.profiles : found.with_files).at(0).best;
    }
    YamlValue verdict() const {
        const YamlValue whole = read_yaml(run() / "6-verdict.yaml");
        return whole[whole["with_files"].exists() ? "with_files" : "profiles"].list().at(0);
    }

    /// Chord speed over a window, of the antenna or with "reference_" of the reference point.
    double true_speed_m_s(const WindowSpan& span, const std::string& of) const {
        const auto at = [&](double time_s) {
            return truth_.at(static_cast<std::size_t>(std::llround(time_s * 10.0)));
        };
        const double start_s = span.start.seconds(), duration_s = span.duration.seconds();
        const auto from = at(start_s), to = at(start_s + duration_s);
        return std::hypot(to.at(of + "east_m") - from.at(of + "east_m"),
                          to.at(of + "north_m") - from.at(of + "north_m")) /
               duration_s;
    }

    /// The antenna's speed and, within its expanded uncertainty, that of the reference point are
    /// the true ones; the required speed lies between.
    void expect_both_speeds() const {
        const CertifiableWindow best = window();
        const double required_m_s = verdict()["required_speed_m_s"].real();
        const double antenna_m_s = true_speed_m_s(best.span, "");
        const double craft_m_s = true_speed_m_s(best.span, "reference_");
        EXPECT_EQ(best.points.antenna_speed_m_s, best.speed_m_s);
        EXPECT_NEAR(best.speed_m_s, antenna_m_s, 2.0 * best.standard_uncertainty_m_s);
        ASSERT_TRUE(best.points.reference_point_speed_m_s);
        const double found_m_s = *best.points.reference_point_speed_m_s;
        const double expanded_m_s = *best.points.reference_point_expanded_uncertainty_m_s;
        EXPECT_LT(expanded_m_s, 0.0135);
        EXPECT_NEAR(found_m_s, craft_m_s, expanded_m_s);
        EXPECT_LT(found_m_s + expanded_m_s, required_m_s - 0.1);
        EXPECT_GT(best.speed_m_s - 2.0 * best.standard_uncertainty_m_s, required_m_s + 0.1);
    }

  private:
    TemporaryFolder folder_;
    ProcessResult certified_;
    std::vector<std::map<std::string, double>> truth_;
};

const Changes of_the_craft{{"  - nalsa\n", "  - nalsa-of-the-craft.yaml\n"}};
const std::string roll = "roll: {amplitude_deg: 10";
const std::string imu = "imu: {grade: mems, rate_hz: 50}";

TEST(MastExample, TheAntennaIsAboveTheRequiredSpeedAndTheCraftBelow) {
    const MastExample example;
    const AttitudeTable attitude = example.attitude();
    ASSERT_EQ(attitude.consistency.standing, InertialStanding::consistent)
        << attitude.consistency.reason;
    EXPECT_EQ(attitude.consistency.start, InertialStart::course);
    example.expect_both_speeds();
    // Judged by the antenna, as no rule says otherwise.
    EXPECT_EQ(example.verdict()["outcome"].text(), "beaten");
    // Attitude, where the craft runs: within four standard uncertainties, and 0.3 degrees.
    std::size_t known = 0;
    ASSERT_EQ(attitude.rows.size(), example.truth().size());
    for (std::size_t i = 100; i < attitude.rows.size(); ++i) {
        const AttitudeEpoch& row = attitude.rows[i];
        const auto& truth = example.truth()[i];
        if (!row.roll_deg) continue;
        ++known;
        EXPECT_NEAR(*row.roll_deg, truth.at("roll_deg"), std::min(0.3, 4.0 * *row.sigma_roll_deg));
        EXPECT_NEAR(*row.pitch_deg, truth.at("pitch_deg"),
                    std::min(0.3, 4.0 * *row.sigma_pitch_deg));
        EXPECT_NEAR(std::remainder(*row.heading_deg - truth.at("heading_deg"), 360.0), 0.0,
                    std::min(0.6, 4.0 * *row.sigma_heading_deg));
    }
    EXPECT_EQ(known, attitude.rows.size() - 100);
    const ProcessResult compared =
        runcert({"compare", example.run().string(), "--truth",
                 (example.run().parent_path() / "made/truth.csv").string()});
    EXPECT_EQ(compared.exit_status, 0) << compared.errors;
}

TEST(MastExample, ATapeMeasureOffByTenCentimetresChangesNothingOfThat) {
    for (const char* error : {"{forward: 0, right: 0, down: 0.1}",
                              "{forward: 0, right: 0, down: "
                              "-0.1}",
                              "{forward: 0.1, right: 0.1, down: 0.1}"}) {
        SCOPED_TRACE(error);
        const MastExample example({{roll, std::string("tape_error_m: ") + error + "\n  " + roll}});
        EXPECT_EQ(example.attitude().consistency.standing, InertialStanding::consistent);
        example.expect_both_speeds();
    }
}

TEST(MastExample, AnArmThatIsStatedWrongIsTakenFromTheMotion) {
    const MastExample right;
    const EstimatedArm as_stated = right.attitude().antenna;
    EXPECT_EQ(as_stated.used, as_stated.declared);
    ASSERT_TRUE(as_stated.estimated && as_stated.sigma);
    for (const char* error :
         {"{forward: 0, right: 0, down: 1.0}", "{forward: 0.6, right: 0, down: 0}",
          "{forward: 0.3, right: -0.5, down: -0.4}"}) {
        SCOPED_TRACE(error);
        const MastExample example({{roll, std::string("tape_error_m: ") + error + "\n  " + roll}});
        const AttitudeTable attitude = example.attitude();
        const EstimatedArm& arm = attitude.antenna;
        ASSERT_TRUE(arm.estimated && arm.sigma);
        EXPECT_EQ(arm.used, *arm.estimated);
        EXPECT_NE(arm.used, arm.declared);
        for (const std::size_t k : {0U, 1U, 2U})
            EXPECT_NEAR((*arm.estimated)[k], as_stated.declared[k], 3.0 * (*arm.sigma)[k]);
        ASSERT_EQ(attitude.notes.size(), 1U);
        EXPECT_NE(attitude.notes[0].find("The motion shows the antenna elsewhere than stated"),
                  std::string::npos);
        // The tape may have been wrong to the antenna or to the IMU: the interval has both.
        const CertifiableWindow best = example.window();
        ASSERT_TRUE(best.points.reference_point_speed_m_s);
        EXPECT_NEAR(*best.points.reference_point_speed_m_s,
                    example.true_speed_m_s(best.span, "reference_"),
                    *best.points.reference_point_expanded_uncertainty_m_s);
        EXPECT_GT(*best.points.reference_point_expanded_uncertainty_m_s, 0.03);
    }
}

// Who says that the IMU is up the mast makes the hull's motion that of a point higher up.
TEST(MastExample, AnImuThatIsNotWhereItIsStatedBeatsNothing) {
    for (const auto& [antenna, point] :
         {std::pair("-9", "1"), std::pair("-5", "5"), std::pair("0", "10")}) {
        SCOPED_TRACE(antenna);
        const MastExample example(
            {}, {of_the_craft[0],
                 {"down: -10.0", std::string("down: ") + antenna},
                 {"down: 0.0\norigin", std::string("down: ") + point + "\norigin"}});
        EXPECT_NE(example.verdict()["outcome"].text(), "beaten");
    }
}

TEST(MastExample, AnOffsetOfTheImusClockIsFound) {
    for (const double late_s : {0.020, -0.020}) {
        SCOPED_TRACE(late_s);
        const MastExample example(
            {{imu, "imu: {grade: mems, rate_hz: 50, late_s: " + format_fixed(late_s, 3) + "}"}});
        const AttitudeTable attitude = example.attitude();
        EXPECT_EQ(attitude.consistency.standing, InertialStanding::consistent);
        ASSERT_TRUE(attitude.time_offset.estimated_s);
        // To be added to the IMU's times.
        EXPECT_NEAR(*attitude.time_offset.estimated_s, -late_s, 0.001);
        example.expect_both_speeds();
    }
}

// The bound of the antenna's motion by its declared height and the craft's angles is far wider than
// what is to be told apart.
TEST(MastExample, WithoutAnImuNothingIsBeaten) {
    const MastExample example({{imu + "\n", ""}});
    EXPECT_NE(example.verdict()["outcome"].text(), "beaten");
    EXPECT_FALSE(fs::exists(example.run() / "4-attitude.ecsv"));
    const CertifiableWindow window = example.window();
    const auto row = std::ranges::find(window.budget, "a", &BudgetRow::symbol);
    ASSERT_NE(row, window.budget.end());
    EXPECT_EQ(row->source, "motion of the antenna against the craft");
    EXPECT_GT(2.0 * window.standard_uncertainty_m_s,
              window.speed_m_s - example.true_speed_m_s(window.span, "reference_"));
}

// A rule that counts the craft, with a wrong tape, a late clock and no IMU.
TEST(MastExample, UnderARuleOfTheCraftNothingIsBeaten) {
    const std::vector<Changes> wrong{
        {},
        {{roll, "tape_error_m: {forward: 0, right: 0, down: 0.1}\n  " + roll}},
        {{roll, "tape_error_m: {forward: 0, right: 0, down: -0.1}\n  " + roll}},
        {{imu, "imu: {grade: mems, rate_hz: 50, late_s: 0.020}"}},
        {{imu + "\n", ""}}};
    for (const Changes& of_spec : wrong) {
        SCOPED_TRACE(of_spec.empty() ? "" : of_spec.front().second);
        const bool without_imu = &of_spec == &wrong.back();
        const MastExample example(of_spec, of_the_craft);
        EXPECT_EQ(example.verdict()["outcome"].text(),
                  without_imu ? "not_certifiable" : "not_beaten");
        const CertifiableWindow window = example.window();
        const double craft_m_s = example.true_speed_m_s(window.span, "reference_");
        EXPECT_NEAR(window.speed_m_s, craft_m_s, 2.0 * window.standard_uncertainty_m_s);
        if (without_imu) continue;
        EXPECT_EQ(window.points.reference_point_speed_m_s, window.speed_m_s);
        EXPECT_NEAR(*window.points.antenna_speed_m_s, example.true_speed_m_s(window.span, ""),
                    2.0 * window.standard_uncertainty_m_s);
        // No other 3 s of the craft were faster by more than that.
        double fastest_m_s = 0.0;
        const auto& truth = example.truth();
        for (std::size_t i = 0; i + 30 < truth.size(); ++i)
            fastest_m_s = std::max(fastest_m_s, std::hypot(truth[i + 30].at("reference_east_m") -
                                                               truth[i].at("reference_east_m"),
                                                           truth[i + 30].at("reference_north_m") -
                                                               truth[i].at("reference_north_m")) /
                                                    3.0);
        EXPECT_LT(fastest_m_s - craft_m_s, 2.0 * window.standard_uncertainty_m_s);
    }
}

TEST(MastExample, OfTheCraftIsTheSameAttemptUnderThatRule) {
    const TemporaryFolder folder;
    const ProcessResult certified =
        certify(examples / "mast/of-the-craft.yaml", folder.path() / "run", {"--no-render"});
    EXPECT_EQ(certified.exit_status, 1) << certified.errors;
    EXPECT_NE(certified.output.find("answer for it (imu-as-measured)"), std::string::npos)
        << certified.output;
}

TEST(MastExample, OnABankedOvalTheCraftIsKnownAsWell) {
    const MastExample example({{"craft:\n  antenna_m", "craft:\n  course: oval\n  antenna_m"},
                               {"  leeway_deg: 2.5\n", ""},
                               {"down: -10.0", "down: -3.0"},
                               {"class: land-yacht", "class: car"}});
    EXPECT_EQ(example.attitude().consistency.standing, InertialStanding::consistent)
        << example.attitude().consistency.reason;
    const CertifiableWindow window = example.window();
    ASSERT_TRUE(window.points.reference_point_speed_m_s);
    const double expanded_m_s = *window.points.reference_point_expanded_uncertainty_m_s;
    EXPECT_LT(expanded_m_s, 0.008);
    EXPECT_NEAR(*window.points.reference_point_speed_m_s,
                example.true_speed_m_s(window.span, "reference_"), expanded_m_s);
}

/// A receiver's raw signals, and a wheel whose scale was calibrated.
Changes three_witnesses(const std::string& stated_scale = "1.02") {
    return {{"imu:", "raw: {navigation: \"" + (examples / "phase/broadcast.nav").string() +
                         "\", phase_noise_m: 0.001, clock_drift: 3.0e-7}\n"
                         "wheel: {noise_m_s: 0.05, scale: 1.02, stated_scale: " +
                         stated_scale + ", expanded_uncertainty_scale: 0.003}\nimu:"}};
}

/// A wheel of the craft that really has the scale 1.02.
std::string wheel_stated_as(const std::string& scale) {
    return "wheel: {noise_m_s: 0.05, scale: 1.02, stated_scale: " + scale +
           ", expanded_uncertainty_scale: 0.003}\n";
}

/// What the attempt says of a mast without an IMU.
const Changes nothing_of_the_mast{
    {"    antenna_motion:\n      height_m: 10.0\n      roll_deg: 10.0\n      pitch_deg: 5.0\n"
     "      roll_period_s: 2.0\n      leeway_deg: 3.0\n",
     ""}};

const WitnessedSpeed* wheel_of(const std::vector<WitnessedSpeed>& witnesses) {
    const auto found = std::ranges::find(witnesses, WitnessKind::wheel, &WitnessedSpeed::kind);
    return found == witnesses.end() ? nullptr : &*found;
}

bool says(const MastExample& example, std::string_view words) {
    return example.certified().output.find(words) != std::string::npos;
}

constexpr std::string_view calibrate = "Calibrate the wheel again";

// With an IMU the antenna's swing is known to millimetres.
TEST(WheelUnderAMast, ByAnImuItIsComparedWithThePathOfTheCraft) {
    const MastExample right({{imu, wheel_stated_as("1.02") + imu}});
    const CertifiableWindow window = right.window();
    const WitnessedSpeed* const wheel = wheel_of(window.witnesses);
    ASSERT_NE(wheel, nullptr);
    // Its scale alone makes 0.09 m/s.
    EXPECT_LT(wheel->standard_uncertainty_m_s, 0.12);
    EXPECT_NEAR(wheel->speed_m_s, right.true_speed_m_s(window.span, ""),
                2.0 * wheel->standard_uncertainty_m_s);
    EXPECT_LT(wheel->normalised_error, 0.5);
    EXPECT_GT(wheel->share, 0.05);
    EXPECT_FALSE(says(right, calibrate));
    EXPECT_EQ(right.verdict()["outcome"].text(), "beaten");
    for (const char* const scale : {"1.05", "0.99"}) {
        SCOPED_TRACE(scale);
        const MastExample wrong({{imu, wheel_stated_as(scale) + imu}});
        EXPECT_TRUE(says(wrong, calibrate)) << wrong.certified().output;
        const Windows found = read_windows(read_file(wrong.run() / "5-windows.yaml"), "f");
        // No window of half the speed takes the place of the fastest.
        ASSERT_FALSE(found.profiles.at(0).fastest);
        const CertifiableWindow& fastest = found.profiles.at(0).best.value();
        const WitnessedSpeed* const said = wheel_of(fastest.witnesses);
        ASSERT_NE(said, nullptr);
        EXPECT_TRUE(contradicts(*said));
        EXPECT_NEAR(said->speed_m_s / wrong.true_speed_m_s(fastest.span, ""),
                    parse_double(scale).value() / 1.02, 0.004);
        EXPECT_EQ(wrong.verdict()["outcome"].text(), "not_certifiable");
    }
}

// Without one, only what the declared mast allows: more than 3 % of a speed over 3 s.
TEST(WheelUnderAMast, ByItsBoundTheSwingIsAllowedFor) {
    const std::string without = imu + "\n";
    const MastExample right({{without, wheel_stated_as("1.02")}});
    const CertifiableWindow window = right.window();
    const WitnessedSpeed* const wheel = wheel_of(window.witnesses);
    ASSERT_NE(wheel, nullptr);
    EXPECT_FALSE(contradicts(*wheel));
    EXPECT_LE(wheel->normalised_error, 1.0);
    // The swing's bound, 0.78 m/s, as rectangular.
    EXPECT_GT(wheel->standard_uncertainty_m_s, 0.45);
    EXPECT_NEAR(wheel->speed_m_s, right.true_speed_m_s(window.span, "reference_"),
                wheel->standard_uncertainty_m_s);
    EXPECT_FALSE(says(right, calibrate));
    // The whole recording says more than one window.
    for (const char* const scale : {"1.05", "0.99"}) {
        SCOPED_TRACE(scale);
        const MastExample wrong({{without, wheel_stated_as(scale)}});
        EXPECT_TRUE(says(wrong, calibrate)) << wrong.certified().output;
        EXPECT_NE(wrong.verdict()["outcome"].text(), "beaten");
    }
}

// With neither, the antenna is taken to be the craft: the differences make the wheel less certain.
TEST(WheelUnderAMast, OfWhichNothingIsSaidItCannotJudgeTheAntenna) {
    const std::string without = imu + "\n";
    const MastExample right({{without, wheel_stated_as("1.02")}}, nothing_of_the_mast);
    const CertifiableWindow window = right.window();
    const WitnessedSpeed* const wheel = wheel_of(window.witnesses);
    ASSERT_NE(wheel, nullptr);
    EXPECT_FALSE(contradicts(*wheel));
    EXPECT_GT(wheel->standard_uncertainty_m_s, 0.3);
    EXPECT_LT(wheel->share, 0.02);
    EXPECT_FALSE(says(right, calibrate));
    const MastExample wrong({{without, wheel_stated_as("1.05")}}, nothing_of_the_mast);
    EXPECT_TRUE(says(wrong, calibrate)) << wrong.certified().output;
}

/// The same craft, stiffer and with its antenna on the roof.
Changes on_the_roof(Changes more) {
    more.insert(more.end(), {{roll, "roll: {amplitude_deg: 1"},
                             {"pitch: {amplitude_deg: 5", "pitch: {amplitude_deg: 0.5"},
                             {"down: -10.0", "down: -1.2"}});
    return more;
}

/// The normalised error of each witness of a window.
std::map<std::string, double> witnesses_of(const CertifiableWindow& window) {
    std::map<std::string, double> errors;
    for (const WitnessedSpeed& one : window.witnesses)
        errors[std::string(to_text(one.kind))] = one.normalised_error;
    return errors;
}

TEST(ThreeWitnesses, WheelPhasesAndImuOfOneRunAgree) {
    const MastExample example(on_the_roof(three_witnesses()));
    const CertifiableWindow window = example.window();
    const auto errors = witnesses_of(window);
    ASSERT_EQ(errors.size(), 3U);
    EXPECT_LE(errors.at("phases"), 1.0);
    EXPECT_LE(errors.at("imu"), 1.0);
    EXPECT_LE(errors.at("wheel"), 1.0);
    ASSERT_EQ(example.attitude().consistency.standing, InertialStanding::consistent);
    ASSERT_TRUE(window.points.reference_point_speed_m_s);
    EXPECT_NEAR(*window.points.reference_point_speed_m_s,
                example.true_speed_m_s(window.span, "reference_"),
                *window.points.reference_point_expanded_uncertainty_m_s);
    for (const WitnessedSpeed& one : window.witnesses)
        EXPECT_NEAR(one.speed_m_s, example.true_speed_m_s(window.span, ""),
                    2.0 * one.standard_uncertainty_m_s);
    // The required speed is above what the craft did.
    EXPECT_EQ(example.verdict()["outcome"].text(), "not_beaten");
}

TEST(ThreeWitnesses, TheOneThatIsWrongIsNamed) {
    // The wheel, by a scale that is 3 % too large.
    const MastExample wheel(on_the_roof(three_witnesses("1.05")));
    const auto errors = witnesses_of(wheel.window());
    EXPECT_GT(errors.at("wheel"), 1.0);
    EXPECT_LE(errors.at("phases"), 1.0);
    EXPECT_TRUE(says(wheel, "multiplied by 1.01997 (standard uncertainty"))
        << wheel.certified().output;
    EXPECT_EQ(wheel.attitude().consistency.standing, InertialStanding::consistent);
    const std::string alone =
        "The speeds of a wheel contradict the positions there and stand alone";
    EXPECT_TRUE(says(wheel, alone)) << wheel.certified().output;
    EXPECT_TRUE(says(wheel, "and the displacements by the IMU agree with the positions"));
    EXPECT_TRUE(says(wheel, calibrate));
    const std::string explained = runcert({"explain", wheel.run().string(), "decision"}).output;
    // Broken into lines.
    EXPECT_NE(explained.find("stand alone"), std::string::npos) << explained;
    // The positions, by a drift that makes them faster than required.
    Changes drift = on_the_roof(three_witnesses());
    drift.push_back({"raw:",
                     "faults: {ramps: [{from_s: 38, to_s: 50, east_m_s: 0.15, north_m_s: "
                     "0.08}]}\nraw:"});
    const MastExample positions(drift);
    EXPECT_TRUE(says(positions, "contradicted by the carrier phases"))
        << positions.certified().output;
    EXPECT_EQ(positions.verdict()["outcome"].text(), "not_certifiable");
    // The IMU, by the unit of its gyros, where the craft swings.
    const MastExample gyros(three_witnesses(), {{"gyro_unit: rad/s", "gyro_unit: deg/s"}});
    const AttitudeTable attitude = gyros.attitude();
    EXPECT_NE(attitude.consistency.standing, InertialStanding::consistent);
    ASSERT_FALSE(attitude.consistency.reason.empty());
    EXPECT_TRUE(says(gyros, attitude.consistency.reason)) << gyros.certified().output;
    EXPECT_FALSE(gyros.window().points.reference_point_speed_m_s);
    EXPECT_LE(witnesses_of(gyros.window()).at("phases"), 1.0);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
