#include <regex>

#include "late_speeds.h"
#include "rules_support.h"

// Recorded speeds that are not those of the positions beside them: no rule of speeds certifies
// them, and no rule of positions is harmed by them.

namespace runcert::chain::RUNCERT_FILE {
namespace {

using namespace late_speeds;

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

struct Format {
    const char* name;
    std::string (*write)(const std::vector<Row>&);
    const char* receiver;  ///< what it takes beside accuracy
};

constexpr Format in_gpx{"run.gpx", gpx, ""};
constexpr Format in_nmea{"run.nmea", nmea, ""};
constexpr Format in_flysight{"run.csv", flysight, ""};
constexpr Format in_csv{
    "table.csv", csv,
    ", format: csv, frame: geodetic, columns: {time: time_s, latitude: lat, longitude: lon, "
    "speed: speed}, time_format: seconds, time_scale: gps"};

/// Under a rule of speeds over 2 s, out and back within 500 m, and one of positions over 10 s.
Verdict judged(const Rules& rules, const Recorded& recorded, const Format& format = in_gpx) {
    rules.put(format.name, format.write(recorded.rows()));
    rules.put("ten.yaml", profile_of("ten", "{duration_s: 10, definition: displacement}"));
    return rules.judge(fmt::format(
        "schema: attempt/1.0\nid: late\ncraft: {{name: x, class: board}}\nplace: p\n"
        "receivers:\n  - {{id: r1, recording: {}, accuracy: {{horizontal_m: 0.5, vertical_m: 1.0, "
        "velocity_mps: 0.1}}, height_m: 0{}}}\n"
        "record: {{speed: 5, unit: kn, source: s}}\n"
        "profiles: [gps-speed-sailing-2s, gps-speed-sailing-alpha-500, ten.yaml]\n",
        format.name, format.receiver));
}

const ProfileVerdict& two_s(const Verdict& verdict) {
    return verdict.profiles.at(0);
}
const ProfileVerdict& alpha(const Verdict& verdict) {
    return verdict.profiles.at(1);
}
const ProfileVerdict& ten_s(const Verdict& verdict) {
    return verdict.profiles.at(2);
}

void expect_refused(const ProfileVerdict& verdict) {
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable) << verdict.reason;
    EXPECT_TRUE(holds(verdict.reason, "speeds-of-these-positions")) << verdict.reason;
    EXPECT_TRUE(holds(verdict.reason, "the recorded velocities show")) << verdict.reason;
}

/// The legs' speed, 12 m/s, by the positions. Of one receiver's alone, chosen among many windows,
/// an error that nothing found may be too probable for a record.
void expect_right_by_positions(const Verdict& verdict) {
    const ProfileVerdict& found = ten_s(verdict);
    if (found.outcome == Outcome::not_proven) {
        EXPECT_GT(found.decision->by_uncertainty, found.decision->level) << found.reason;
        EXPECT_TRUE(holds(found.reason, "an error that nothing found is too probable"))
            << found.reason;
    } else {
        ASSERT_EQ(found.outcome, Outcome::beaten) << found.reason;
    }
    EXPECT_NEAR(*found.speed_m_s, 12.0, 0.3);
}

TEST(SpeedChannel, OfThePositionsMomentsIsCertified) {
    for (const Format& format : {in_gpx, in_nmea, in_flysight, in_csv}) {
        SCOPED_TRACE(format.name);
        const Rules rules;
        const Verdict verdict = judged(rules, {}, format);
        EXPECT_EQ(two_s(verdict).outcome, Outcome::beaten) << two_s(verdict).reason;
        EXPECT_EQ(alpha(verdict).outcome, Outcome::beaten) << alpha(verdict).reason;
        EXPECT_NEAR(*two_s(verdict).speed_m_s, 12.0, 0.2);
        // 500 m: a turn of 50 m in 25 s, 35 m in 5 s either side of it, and 380 m at full speed.
        EXPECT_NEAR(*alpha(verdict).speed_m_s, 500.0 / (25.0 + 10.0 + 380.0 / 12.0), 0.2);
        EXPECT_EQ(requirement_of(alpha(verdict), "speeds-of-these-positions").status,
                  RequirementStatus::met);
        EXPECT_EQ(requirement_of(two_s(verdict), "speeds-of-these-positions").status,
                  RequirementStatus::met);
        expect_right_by_positions(verdict);
    }
}

TEST(SpeedChannel, ThatIsLateIsNoSourceAndHarmsNoPositions) {
    for (const Format& format : {in_gpx, in_nmea, in_flysight, in_csv})
        for (const double delay_s : {5.0, 20.0, 43.0, 55.0, 100.0, -20.0}) {
            SCOPED_TRACE(fmt::format("{} {}", format.name, delay_s));
            const Rules rules;
            const Verdict verdict =
                judged(rules, {.duration_s = 450.0, .delay_s = always(delay_s)}, format);
            expect_refused(alpha(verdict));
            expect_refused(two_s(verdict));
            const std::regex said(delay_s < 0.0 ? "([0-9.]+) s ahead of the positions"
                                                : "([0-9.]+) s behind the positions");
            std::smatch found;
            const std::string reason = alpha(verdict).reason;
            ASSERT_TRUE(std::regex_search(reason, found, said)) << reason;
            EXPECT_NEAR(std::stod(found[1]), std::abs(delay_s), 0.1);
            expect_right_by_positions(verdict);
            EXPECT_TRUE(ten_s(verdict).witnesses.empty());
        }
}

TEST(SpeedChannel, LostInTheMiddleOrMoreAndMoreIsNoSource) {
    const Board board{.longer_s = 3.0, .sails_s = 1200.0};
    for (const auto& delay_s :
         {std::function<double(double)>([](double t) { return t < 600.0 ? 0.0 : 43.0; }),
          std::function<double(double)>([](double t) { return t / 20.0; })}) {
        const Rules rules;
        const Verdict verdict =
            judged(rules, {.board = board, .duration_s = 1260.0, .delay_s = delay_s});
        expect_refused(alpha(verdict));
        expect_refused(two_s(verdict));
        expect_right_by_positions(verdict);
    }
}

TEST(SpeedChannel, LostForAMomentIsLeftOutThere) {
    const Rules rules;
    const Verdict verdict =
        judged(rules, {.board = {.longer_s = 1.0, .sails_s = 7200.0},
                       .duration_s = 7200.0,
                       .delay_s = [](double t) { return t > 3000.0 && t < 3180.0 ? 43.0 : 0.0; }});
    EXPECT_EQ(two_s(verdict).outcome, Outcome::beaten) << two_s(verdict).reason;
    EXPECT_EQ(alpha(verdict).outcome, Outcome::beaten) << alpha(verdict).reason;
    EXPECT_LT(*alpha(verdict).speed_m_s, 9.0);
    expect_right_by_positions(verdict);
}

TEST(SpeedChannel, OfAnotherSessionOrAnotherScaleIsNoSource) {
    const std::vector<Row> positions = Recorded{.duration_s = 900.0}.rows();
    const std::vector<Row> others =
        Recorded{.board = {.leg_s = 37.0, .turn_s = 11.0, .longer_s = 0.7, .sails_s = 900.0},
                 .duration_s = 900.0}
            .rows();
    Recorded half{.factor = 1.5};
    for (const bool scaled : {false, true}) {
        const Rules rules;
        std::vector<Row> rows = scaled ? half.rows() : positions;
        for (std::size_t k = 0; !scaled && k < rows.size(); ++k)
            rows[k].speed_m_s = others[k].speed_m_s;
        static std::string text;
        text = gpx(rows);
        const Verdict verdict =
            judged(rules, {}, {"run.gpx", [](const std::vector<Row>&) { return text; }, ""});
        EXPECT_EQ(alpha(verdict).outcome, Outcome::not_certifiable) << alpha(verdict).reason;
        EXPECT_EQ(two_s(verdict).outcome, Outcome::not_certifiable) << two_s(verdict).reason;
        // Which of the two is wrong the recording does not tell.
        EXPECT_NE(ten_s(verdict).outcome, Outcome::not_beaten) << ten_s(verdict).reason;
    }
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
