#include "draft/draft.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "draft/fitting_rules.h"
#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A solution with all that one can say.
HandedIn solution() {
    HandedIn file{.path = "rover.pos"};
    Recognition& is = file.is;
    is.format = "rtklib-pos";
    is.first = parse_gps_iso("2026-03-14T10:00:18");
    is.last = parse_gps_iso("2026-03-14T10:01:18");
    is.span_s = 60.0;
    is.fixes = {{.fix = "fixed", .epochs = 600}};
    return file;
}

Draft draft_of(HandedIn file) {
    Arrangement one = arrange({file});
    return {{std::move(file)}, std::move(one)};
}

std::vector<std::string> open_keys(const Draft& draft, bool required_alone = false) {
    std::vector<std::string> keys;
    for (const Gap& gap : draft.gaps())
        if (gap.required || !required_alone) keys.push_back(gap.key);
    return keys;
}

bool is_open(const Draft& draft, const std::string& key) {
    return std::ranges::count(open_keys(draft), key) > 0;
}

std::string refused(Draft& draft, const std::string& key, const std::string& answer) {
    const auto before = draft.keys();
    try {
        draft.set(key, answer);
    } catch (const Failure& failure) {
        EXPECT_EQ(draft.keys(), before) << key;
        return failure.problem() + ". " + failure.remedy();
    }
    return "taken";
}

TEST(Draft, AsksForNothingThatTheRecordingAnswers) {
    EXPECT_EQ(open_keys(draft_of(solution())),
              (std::vector<std::string>{"craft.name", "craft.class", "profiles", "pilot", "place",
                                        "officials", "record.speed",
                                        "receivers.primary.antenna_height_m"}));
}

/// An IMU's table, whose times have no date.
HandedIn imu_table(double first_s) {
    HandedIn file{.path = "imu.csv"};
    file.is.kind = RecordingKind::imu;
    file.is.format = "csv";
    file.is.count_s = first_s;
    file.is.needed = {{.key = "imu.start_gps", .reason = "why"},
                      {.key = "imu.antenna_m", .reason = "why", .required = true},
                      {.key = "imu.grade", .reason = "why"}};
    file.is.span_s = 60.0;
    const std::pair<const char*, const char*> proposed[] = {{"imu.columns.time", "t"},
                                                            {"imu.columns.gyro_x", "2"},
                                                            {"imu.columns.gyro_y", "3"},
                                                            {"imu.columns.gyro_z", "4"},
                                                            {"imu.columns.accelerometer_x", "5"},
                                                            {"imu.columns.accelerometer_y", "6"},
                                                            {"imu.columns.accelerometer_z", "7"},
                                                            {"imu.axes.x", "forward"},
                                                            {"imu.axes.y", "-right"},
                                                            {"imu.axes.z", "-down"},
                                                            {"imu.rate_hz", "100.5"},
                                                            {"imu.gyro_unit", "deg/s"}};
    for (const auto& [key, value] : proposed)
        file.is.proposed.push_back({.key = key, .value = value, .reason = "by its name"});
    return file;
}

TEST(Draft, AnImuIsWrittenAsItsFileSaysAndItsArmIsAskedFor) {
    const auto draft_with = [](double first_s) {
        std::vector<HandedIn> files{solution(), imu_table(first_s)};
        Arrangement one = arrange(files);
        return Draft(std::move(files), std::move(one));
    };
    // From the recording's first epoch, and of the GPS week: 6 days, 10 h and 18 s.
    for (const double first_s : {-3.0, 6 * 86'400.0 + 36'018.0}) {
        const Draft one = draft_with(first_s);
        EXPECT_EQ(open_keys(one, true),
                  (std::vector<std::string>{"craft.name", "craft.class", "profiles",
                                            "receivers.primary.imu.antenna_m"}));
    }
    EXPECT_TRUE(is_open(draft_with(-3.0), "receivers.primary.imu.start_gps"));
    EXPECT_FALSE(is_open(draft_with(6 * 86'400.0 + 36'018.0), "receivers.primary.imu.start_gps"));
    Draft draft = draft_with(46'408.0);
    EXPECT_TRUE(is_open(draft, "receivers.primary.imu.start_gps"));
    draft.set("imu.start_gps", "2026-03-14T10:00:18.25");
    draft.set("receivers.primary.imu.antenna_m", "{forward: 0, right: 0.5, down: -5}");
    draft.set("imu.grade", "mems");
    EXPECT_NE(refused(draft, "imu.grade", "good"), "taken");
    EXPECT_FALSE(is_open(draft, "receivers.primary.imu.grade"));
    draft.set("craft.name", "a");
    draft.set("craft.class", "land-yacht");
    draft.set("profiles", "nalsa");
    const Attempt attempt = read_attempt(draft.text(), "attempt.yaml");
    const Imu& imu = *attempt.receivers[0].imu;
    EXPECT_EQ(imu.file, "imu.csv");
    EXPECT_EQ(imu.columns.at("accelerometer_z"), "7");
    EXPECT_EQ(imu.axes->y, CraftAxis::left);
    EXPECT_EQ(imu.rate_hz, 100.5);
    EXPECT_EQ(imu.antenna, (LeverArm{0.0, 0.5, -5.0}));
    EXPECT_EQ(to_iso(*imu.start_gps), "2026-03-14T10:00:18.250");
    EXPECT_EQ(imu.grade->name, "mems");
}

TEST(Draft, OfASurfaceFrameHeightsAndSourceAreAskedFor) {
    HandedIn ground{.path = "course.csv"};
    ground.is.kind = RecordingKind::surface;
    ground.is.triangles = 2;
    for (const char* key : {"frame", "unit", "source"})
        ground.is.needed.push_back({.key = std::string("surface.") + key, .required = true});
    std::vector<HandedIn> files{solution(), ground};
    Arrangement one = arrange(files);
    Draft draft(std::move(files), std::move(one));
    const auto open = [&] {
        std::vector<std::string> keys;
        for (const std::string& key : open_keys(draft, true))
            if (key.starts_with("receivers.primary.")) keys.push_back(key.substr(18));
        return keys;
    };
    using Keys = std::vector<std::string>;
    EXPECT_EQ(open(),
              (Keys{"surface.frame", "surface.unit", "surface.source", "antenna_height_m"}));
    // On the Earth heights have a reference; in a plane they count from its origin.
    draft.set("surface.frame", "local_plane");
    EXPECT_EQ(open(), (Keys{"surface.unit", "surface.source", "antenna_height_m"}));
    EXPECT_TRUE(is_open(draft, "origin"));
    draft.set("surface.frame", "53 south");
    EXPECT_FALSE(is_open(draft, "origin"));
    EXPECT_EQ(open(),
              (Keys{"surface.unit", "surface.source", "surface.heights", "antenna_height_m"}));
    EXPECT_NE(refused(draft, "surface.heights", "sea level"), "taken");
    draft.set("surface.heights", "geoid");
    EXPECT_EQ(open(),
              (Keys{"surface.unit", "surface.source", "surface.undulation_m", "antenna_height_m"}));
    draft.set("surface.undulation_m", "-3.2");
    draft.set("surface.unit", "m");
    draft.set("surface.source", "a survey, the day before");
    draft.set("antenna_height_m", "1.2");
    EXPECT_EQ(open(), Keys{});
    draft.set("craft.name", "a");
    draft.set("craft.class", "land-yacht");
    draft.set("profiles", "nalsa");
    const Attempt attempt = read_attempt(draft.text(), "attempt.yaml");
    const Surface& surface = *attempt.receivers[0].surface;
    EXPECT_EQ(surface.file, "course.csv");
    EXPECT_EQ(surface.frame->utm_zone->zone, 53);
    EXPECT_EQ(surface.undulation, -3.2);
    EXPECT_EQ(surface.source, "a survey, the day before");
}

TEST(Draft, AsksForWhatARecordingNeeds) {
    HandedIn file = solution();
    file.is.needed = {
        {.key = "height_m", .reason = "No heights.", .values = {}, .required = true},
        {.key = "time_scale", .reason = "Not said.", .values = {"utc", "local"}, .required = true}};
    Draft draft = draft_of(file);
    EXPECT_TRUE(is_open(draft, "receivers.primary.height_m"));
    draft.set("height_m", "40");
    EXPECT_FALSE(is_open(draft, "receivers.primary.height_m"));
    EXPECT_FALSE(is_open(draft, "receivers.primary.utc_offset_h"));
    draft.set("time_scale", "local");
    EXPECT_TRUE(is_open(draft, "receivers.primary.utc_offset_h"));
}

TEST(Draft, WrittenWithItsAnswersItIsAnAttempt) {
    Draft draft = draft_of(solution());
    draft.set("craft.name", "Yacht: \"A\" #1");
    draft.set("craft.class", "land-yacht");
    draft.set("record.speed", "202.9 km/h");
    EXPECT_TRUE(is_open(draft, "record.source"));
    draft.set("record.source", "NALSA, 2009");
    draft.set("officials", "measurer Ann Lee, judge");
    draft.set("antenna_height_m", "1.2");
    draft.take_proposals();
    EXPECT_TRUE(open_keys(draft, true).empty());
    const Attempt attempt = read_attempt(draft.text(), "attempt.yaml");
    EXPECT_EQ(attempt.craft.name, "Yacht: \"A\" #1");
    EXPECT_EQ(attempt.record->speed, 202.9);
    EXPECT_EQ(attempt.record->unit, "km/h");
    ASSERT_EQ(attempt.officials.size(), 2U);
    EXPECT_EQ(attempt.officials[0].name, "Ann Lee");
    EXPECT_EQ(attempt.officials[1].role, "judge");
    draft.set("officials", "judge Lee, Ann;");
    EXPECT_EQ(read_attempt(draft.text(), "attempt.yaml").officials.at(0).name, "Lee, Ann");
    EXPECT_EQ(attempt.receivers[0].antenna_height_m, 1.2);
    EXPECT_EQ(attempt.profiles, std::vector<std::string>{"nalsa"});
    EXPECT_NE(draft.text().find("\n# pilot: \"...\"  # "), std::string::npos) << draft.text();
}

TEST(Draft, LinesThatAreLeftOutAreAnAttemptOnceCompleted) {
    HandedIn file = solution();
    file.is.needed = {{.key = "solution", .reason = "Not said.", .values = {"fixed", "float"}}};
    const Draft draft = draft_of(file);
    std::string text = draft.text();
    // The first two lines are about the file.
    text = text.substr(text.find("schema:"));
    for (std::size_t at = 0; (at = text.find("# ", at)) != std::string::npos; at += 2)
        if (at == 0 || text.find_last_not_of(' ', at - 1) == text.rfind('\n', at))
            text.erase(at, 2);
    // What nobody completes is refused, and not taken for an answer.
    EXPECT_THROW(read_attempt(text, "attempt.yaml"), Failure) << text;
    const std::pair<std::string, std::string> completed[] = {
        {"class: ...", "class: car"},         {"profiles: [...]", "profiles: [nalsa]"},
        {"YYYY-MM-DD", "2026-03-14"},         {"speed: ...", "speed: 202.9"},
        {"solution: ...", "solution: float"}, {"antenna_height_m: ...", "antenna_height_m: 1.2"}};
    for (const auto& [open, answer] : completed) {
        ASSERT_NE(text.find(open), std::string::npos) << open << text;
        text.replace(text.find(open), open.size(), answer);
    }
    const Attempt attempt = read_attempt(text, "attempt.yaml");
    EXPECT_EQ(attempt.craft.name, "...");
    EXPECT_EQ(attempt.receivers[0].antenna_height_m, 1.2);
    EXPECT_EQ(attempt.receivers[0].solution, "float");
    EXPECT_EQ(attempt.record->speed, 202.9);
}

TEST(Draft, RefusesAnswersThatCannotBe) {
    Draft draft = draft_of(solution());
    const struct {
        const char *key, *answer, *said;
    } cases[] = {{"craft.class", "boat", "not one of land-yacht"},
                 {"profiles", "nalsaa", "Did you mean nalsa?"},
                 {"record.speed", "440,5 km/h", "decimal comma"},
                 {"record.speed", "440.5", "names no unit"},
                 {"record.speed", "5000 km/h", "no speed that a craft has a record of"},
                 {"record.speed", "0.2 kn", "no speed that a craft has a record of"},
                 {"records.nalsa", "200 km/h", "does not claim the rule"},
                 {"accuracy.horizontal_m", "0,02", "decimal comma"},
                 {"accuracy.horizontal_m", "50", "above 10"},
                 {"accuracy.horizontal_m", "good", "not a number"},
                 {"solution", "fix", "not one of fixed"},
                 {"start_gps", "yesterday", "time"},
                 {"craft", "{name: x", ""},
                 {"plase", "x", "Did you mean \"place\"?"},
                 {"receivers.third.solution", "fixed", "no receiver"},
                 {"officials", ",", "names nobody"}};
    for (const auto& one : cases) {
        const std::string said = refused(draft, one.key, one.answer);
        EXPECT_NE(said, "taken") << one.key << " " << one.answer;
        EXPECT_NE(said.find(one.said), std::string::npos) << said;
    }
}

TEST(Draft, TakesNamesAsPeopleWriteThem) {
    Draft draft = draft_of(solution());
    draft.set("craft.name", "Yacht");
    draft.set("craft.class", "Land yacht");
    draft.set("profiles", "NALSA");
    draft.set("record.speed", "110 Knots");
    draft.set("record.source", "NALSA, 2009");
    draft.set("lever_arm_m", "0.5 0 -1.2");
    const Attempt attempt = read_attempt(draft.text(), "attempt.yaml");
    EXPECT_EQ(attempt.craft.kind, "land-yacht");
    EXPECT_EQ(attempt.profiles, std::vector<std::string>{"nalsa"});
    EXPECT_EQ(attempt.record->unit, "kn");
    EXPECT_EQ(attempt.record->speed, 110.0);
    EXPECT_EQ((*attempt.receivers[0].lever_arm)[2], -1.2);
}

TEST(Draft, ARecordForEachRuleThatIsClaimed) {
    Draft draft = draft_of(solution());
    draft.set("craft.name", "Board");
    draft.set("craft.class", "board");
    draft.set("profiles", "gps-speed-sailing");
    EXPECT_FALSE(is_open(draft, "record.speed"));
    EXPECT_EQ(std::ranges::count_if(open_keys(draft),
                                    [](const std::string& key) {
                                        return key.starts_with("records.gps-speed-sailing-");
                                    }),
              7);
    draft.set("records.gps-speed-sailing-2s", "45.2 kn");
    EXPECT_TRUE(is_open(draft, "records.gps-speed-sailing-2s.source"));
    draft.set("records.gps-speed-sailing-2s.source", "the body's list");
    draft.set("records.gps-speed-sailing-500m", "40 kn");
    draft.set("records.gps-speed-sailing-500m.source", "the body's list");
    EXPECT_FALSE(is_open(draft, "records.gps-speed-sailing-2s"));
    EXPECT_TRUE(is_open(draft, "records.gps-speed-sailing-10s"));
    const Attempt attempt = read_attempt(draft.text(), "attempt.yaml");
    ASSERT_NE(attempt.record_for("gps-speed-sailing-2s"), nullptr);
    EXPECT_EQ(attempt.record_for("gps-speed-sailing-2s")->speed, 45.2);
    EXPECT_EQ(attempt.record_for("gps-speed-sailing-500m")->speed, 40.0);
    EXPECT_EQ(attempt.record_for("gps-speed-sailing-10s"), nullptr);
}

TEST(Draft, TwoRecordingsOfOneNameHaveTwoIds) {
    HandedIn second = solution();
    second.is.first = parse_gps_iso("2026-03-14T11:30:18");
    EXPECT_NE(draft_of(solution()).keys()["id"], draft_of(second).keys()["id"]);
    second.path = "rover-2026-03-14.pos";
    EXPECT_EQ(draft_of(second).keys()["id"], "rover-2026-03-14-1130");
}

TEST(Draft, OffersFixTypesWhereTheClassUsesNoneOfThem) {
    HandedIn file = solution();
    file.is.fixes = {{.fix = "single", .epochs = 10}, {.fix = "none", .epochs = 2}};
    Draft draft = draft_of(file);
    draft.set("craft.class", "board");
    EXPECT_FALSE(is_open(draft, "parameters.screen.allowed_fixes"));
    draft.set("craft.class", "car");
    EXPECT_TRUE(is_open(draft, "parameters.screen.allowed_fixes"));
    draft.set("parameters.screen.allowed_fixes", "single");
    EXPECT_FALSE(is_open(draft, "parameters.screen.allowed_fixes"));
}

TEST(Draft, EveryRuleIsProposedForSomeCraftAndNoneThatIsNot) {
    std::vector<std::string> proposed{"evidence-general"};  // beside a rule
    for (const std::string& of_class : attempt_schema().find("craft.class")->values)
        for (const std::string day : {"2026-01-01", "2026-09-01"})
            for (const std::string& rule :
                 fitting_rules(of_class, parse_gps_iso(day + "T12:00:00"))) {
                Draft draft = draft_of(solution());
                draft.set("profiles", rule);  // a name that is read
                for (const std::string& name :
                     read_attempt(
                         "schema: attempt/1.0\nid: x\ncraft: {name: x, class: car}\nreceivers: "
                         "[{id: a, recording: a}]\nprofiles: [" +
                             rule + "]\n",
                         "x")
                         .profiles)
                    proposed.push_back(name);
            }
    for (const std::string& rule : builtin_profiles())
        EXPECT_GT(std::ranges::count(proposed, rule), 0) << rule;
    EXPECT_TRUE(fitting_rules("car", std::nullopt).empty());
    EXPECT_EQ(fitting_rules("skydiver", parse_gps_iso("2026-01-01T00:00:00")).back(),
              "fai-speed-skydiving");
    EXPECT_EQ(fitting_rules("skydiver", parse_gps_iso("2026-09-01T00:00:00")).front(),
              "fai-speed-skydiving-2026");
}

TEST(Draft, ADayHasWhatIsAnsweredInCommon) {
    HandedIn second = solution(), table = solution();
    second.path = "rover.nmea";
    table.path = "log.csv";
    table.is.format = "csv";
    table.is.proposed = {{.key = "columns.time", .value = "1", .reason = {}},
                         {.key = "frame", .value = "geodetic", .reason = {}}};
    Draft day = Draft::of_day({solution(), second, table}, "Lake day");
    day.set("craft.name", "Yacht");
    day.set("craft.class", "land-yacht");
    day.set("solution", "fixed");
    day.take_proposals();
    const YamlValue read(parse_yaml(day.text(), "day.yaml"), "day.yaml");
    EXPECT_EQ(read["id"].text(), "Lake-day");
    EXPECT_EQ(read["defaults"]["craft"]["name"].text(), "Yacht");
    const YamlValue common = read["defaults"];
    EXPECT_EQ(common["solution"].text(), "fixed");
    EXPECT_FALSE(common["recording"].exists());
    ASSERT_EQ(read["attempts"].list().size(), 3U);
    EXPECT_EQ(read["attempts"].list()[0]["id"].text(), "rover");
    EXPECT_EQ(read["attempts"].list()[1]["id"].text(), "rover-2");
    const YamlValue third = read["attempts"].list()[2];
    EXPECT_EQ(third["recording"].text(), "log.csv");
    EXPECT_EQ(third["columns"]["time"].integer(), 1);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
