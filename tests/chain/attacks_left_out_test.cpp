#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/geodesy.h"
#include "motion_script.h"
#include "rules_support.h"

// A faster run whose rows are left out, whatever for: the record is never said to stand because of
// the slower one that is left.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// A row of RTKLIB's .pos.
struct Row {
    double time_s = 0.0;
    double east_m = 0.0, north_m = 0.0;
    int quality = 1;
    int satellites = 12;
    double sd_m = 0.01;
    double age_s = 1.0;
    double ratio = 20.0;
};

struct Hidden {
    std::string name;
    std::function<void(Row&, int)> hide;  ///< a row of the faster run, and its number among these
    double rate_hz = 10.0;
};

/// 108 km/h, and then 216 km/h in rows that are hidden.
class Attacks : public testing::Test {
  protected:
    static std::vector<Row> rows(const Hidden& hidden, const std::function<void(Row&)>& last) {
        MotionScript script;
        script.add(10.0).change_speed(30.0, 2.0, 1.0).add(8.0).change_speed(-30.0, 3.0, 1.0);
        script.add(20.0);
        const double from_s = script.duration_s() - 1.0;
        script.change_speed(60.0, 2.0, 1.0).add(6.0).change_speed(-60.0, 3.0, 1.0);
        const double to_s = script.duration_s() + 1.0;
        script.add(20.0);
        RandomGenerator random(7);
        std::vector<Row> made;
        int number = 0;
        for (int k = 0; k / hidden.rate_hz <= script.duration_s(); ++k) {
            Row row{.time_s = k / hidden.rate_hz};
            row.north_m = script.at(row.time_s).distance_m + 0.005 * random.normal();
            row.east_m = 0.005 * random.normal();
            if (row.time_s > from_s && row.time_s < to_s) hidden.hide(row, number++);
            if (row.time_s >= to_s && last) last(row);
            made.push_back(row);
        }
        return made;
    }

    static std::string pos(const std::vector<Row>& rows) {
        const LocalFrame frame({.latitude = Angle::from_degrees(-31.6),
                                .longitude = Angle::from_degrees(136.0),
                                .height_m = 110.0});
        const GpsTime first = parse_gps_iso("2026-03-14T03:20:18.000");
        std::string text =
            "%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   "
            "sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio\n";
        for (const Row& row : rows) {
            const Geodetic at = frame.geodetic_from_enu({{row.east_m, row.north_m, 0.0}});
            const CalendarTime time =
                first.plus_nanoseconds(std::llround(row.time_s * 1e9)).calendar();
            text += fmt::format(
                "{:04}/{:02}/{:02} {:02}:{:02}:{:02}.{:03} {:.10f} {:.10f} {:.4f} {} {} {:.4f} "
                "{:.4f} "
                "{:.4f} 0 0 0 {:.2f} {:.1f}\n",
                time.year, time.month, time.day, time.hour, time.minute, time.second,
                time.nanosecond / 1'000'000, at.latitude.degrees(), at.longitude.degrees(),
                at.height_m, row.quality, row.satellites, row.sd_m, row.sd_m, 2.0 * row.sd_m,
                row.age_s, row.ratio);
        }
        return text;
    }

    ProfileVerdict verdict(const std::vector<Row>& rows, double record_km_h = 150.0) const {
        recordings_.put("recording.pos", pos(rows));
        return recordings_.judge_one(
            fmt::format("schema: attempt/1.0\nid: hidden\ncraft: {{name: yacht, class: "
                        "land-yacht}}\nreceivers: [{{id: primary, recording: recording.pos}}]\n"
                        "record: {{speed: {}, unit: km/h, source: test}}\nprofiles: [nalsa]\n",
                        record_km_h));
    }

    Rules recordings_;
};

TEST_F(Attacks, LeftOut45AFasterRunThatIsLeftOutNeverEndsInNotBeaten) {
    const std::vector<Hidden> ways{
        // Nowhere for as long as makes it a place.
        {"far", [](Row& row, int k) { row.east_m += 150'000.0 * (1 + k / 25); }, 1.0},
        {"no fix", [](Row& row, int) { row.quality = 0; }},
        {"float", [](Row& row, int) { row.quality = 2; }},
        {"single", [](Row& row, int) { row.quality = 5; }},
        {"duplicate time", [](Row& row, int k) { row.time_s -= 0.1 * k; }},
        {"backward time", [](Row& row, int k) { row.time_s -= 0.2 * k; }},
        {"absurd accuracy", [](Row& row, int) { row.sd_m = 500.0; }},
        {"optimistic accuracy", [](Row& row, int) { row.sd_m = 1e-6; }},
        {"few satellites", [](Row& row, int) { row.satellites = 4; }},
        {"low ratio", [](Row& row, int) { row.ratio = 1.2; }},
        {"old corrections", [](Row& row, int) { row.age_s = 100.0; }},
        {"scattered", [](Row& row, int k) { row.east_m += k % 2 == 0 ? 3.0 : -3.0; }},
        {"outliers", [](Row& row, int k) { row.east_m += k % 4 == 0 ? 5.0 : 0.0; }},
        {"short arcs", [](Row& row, int k) { row.quality = k % 5 == 0 ? 1 : 2; }},
    };
    for (const Hidden& way : ways) {
        SCOPED_TRACE(way.name);
        const ProfileVerdict found = verdict(rows(way, {}));
        EXPECT_NE(found.outcome, Outcome::not_beaten) << found.reason;
        EXPECT_NE(found.outcome, Outcome::beaten) << found.reason;
        // Refused, or measured and too uncertain.
        EXPECT_TRUE(found.reason.find("The recording shows 21") != std::string::npos ||
                    found.speed_m_s.value_or(0.0) > 59.0)
            << found.reason;
    }
    // What is slower hides nothing.
    EXPECT_EQ(verdict(rows(ways[2], {}), 230.0).outcome, Outcome::not_beaten);
}

TEST_F(Attacks, LeftOut45AnotherPlaceIsSearchedInAFrameOfItsOwn) {
    const Hidden elsewhere{"elsewhere", [](Row& row, int) {
                               row.east_m += 120'000.0;
                               row.time_s += 7200.0;
                           }};
    const auto stays = [](Row& row) {
        row.east_m += 120'000.0;
        row.time_s += 7200.0;
    };
    const std::vector<Row> made = rows(elsewhere, stays);
    const ProfileVerdict found = verdict(made);
    EXPECT_EQ(found.outcome, Outcome::beaten) << found.reason;
    ASSERT_TRUE(found.speed_m_s.has_value());
    // At home the same run has the same speed.
    const Hidden nothing{"nothing", [](Row&, int) {}};
    const ProfileVerdict at_home = verdict(rows(nothing, {}));
    ASSERT_TRUE(at_home.speed_m_s.has_value());
    EXPECT_NEAR(*found.speed_m_s, *at_home.speed_m_s,
                0.2 * at_home.expanded_uncertainty_m_s.value());
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
