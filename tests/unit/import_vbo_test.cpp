#include <fmt/format.h>

#include <cmath>
#include <string>

#include "import_vbo_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace vbo_test;

TEST(Vbo, EveryField) {
    const Observations read = import_vbo(header + row + next_row);
    EXPECT_EQ(read.format, "vbo");
    EXPECT_EQ(read.frame, "geodetic");
    EXPECT_EQ(read.time_scale, "utc");
    EXPECT_EQ(read.device, "VBox II Version 4.5a, serial number 005201");
    // "VBox II Version 4.5a" does not say which part of it is what.
    EXPECT_EQ(read.instrument, (Instrument{.serial = "005201"}));
    EXPECT_EQ(import_vbo(replaced(header, "VBox II Version 4.5a",
                                  "Type : VBOX3i\r\nFirmware : 2.5 build 1") +
                         row + next_row)
                  .instrument,
              (Instrument{.model = "VBOX3i", .serial = "005201", .firmware = "2.5 build 1"}));
    EXPECT_EQ(read.accuracy_source, "none");
    EXPECT_EQ(read.facts.receiver, "primary");
    EXPECT_EQ(read.records.total, 2);
    EXPECT_EQ(read.records.bad, 0);
    EXPECT_EQ(to_utc_iso(*read.facts.first_epoch), "2006-07-31T16:22:35.400Z");
    EXPECT_DOUBLE_EQ(*read.facts.time_resolution_s, 0.01);
    EXPECT_NEAR(*read.facts.position_resolution_m, 0.01854, 1e-5);
    EXPECT_NEAR(read.facts.nominal_interval_s, 0.1, 1e-12);
    const Observation& first = read.rows.at(0);
    EXPECT_DOUBLE_EQ(*first.latitude_deg, 3119.09973 / 60.0);
    EXPECT_DOUBLE_EQ(*first.longitude_deg, -58.49277 / 60.0);
    EXPECT_DOUBLE_EQ(*first.height_m, 152.58);
    EXPECT_NEAR(*first.recorded_velocity_east_m_s, 20.0 * 0.5, 1e-12);
    EXPECT_NEAR(*first.recorded_velocity_north_m_s, -20.0 * std::sqrt(0.75), 1e-12);
    EXPECT_DOUBLE_EQ(*first.recorded_velocity_up_m_s, -1.25);
    EXPECT_FALSE(first.sigma_east_m || first.sigma_recorded_velocity_east_m_s);
    EXPECT_EQ(first.fix, FixType::dgps);
    EXPECT_EQ(first.satellites, 9);
    EXPECT_EQ(first.source_line, 26);
    EXPECT_TRUE(has_note(read, "above mean sea level"));
}

TEST(Vbo, UnitsOfSpeed) {
    const struct {
        std::string from, to;
        double speed_m_s;
    } cases[] = {
        {"velocity kmh", "velocity knots", 72.0 * 1852.0 / 3600.0},
        {"velocity kmh", "Velocity mph", 72.0 * 0.44704},
        {"velocity kmh", "velocity m/s", 72.0},
        {"velocity kmh", "velocity", 20.0},
        {"[channel units]\r\n",
         "[channel units]\r\n-\r\ns\r\nmin\r\nmin\r\nkm/h\r\ndeg\r\nm\r\nm/s\r\n", 20.0},
        {"kmh\r\nheading\r\nheight\r\nvertical velocity m/s\r\n\r\n[channel units]\r\n",
         "\r\nheading\r\nheight\r\nvertical velocity\r\n[channel units]\r\n"
         "-\r\ns\r\nmin\r\nmin\r\nkts\r\ndeg\r\nm\r\nm/s\r\n",
         72.0 * 1852.0 / 3600.0},
    };
    for (const auto& unit : cases) {
        const Observations read = import_vbo(replaced(header, unit.from, unit.to) + row);
        EXPECT_NEAR(std::hypot(*read.rows[0].recorded_velocity_east_m_s,
                               *read.rows[0].recorded_velocity_north_m_s),
                    unit.speed_m_s, 1e-9)
            << unit.to;
        EXPECT_TRUE(read.rows[0].recorded_velocity_up_m_s);
    }
    const Observations kmh =
        import_vbo(replaced(header, "vertical velocity m/s", "vertical vel kmh") + row);
    EXPECT_NEAR(*kmh.rows[0].recorded_velocity_up_m_s, -1.25 / 3.6, 1e-12);
    const Observations unknown =
        import_vbo(replaced(header, "vertical velocity m/s", "vertical velocity") + row);
    EXPECT_FALSE(unknown.rows[0].recorded_velocity_up_m_s);
    EXPECT_TRUE(has_note(unknown, "in a unit that the header does not name"));
}

TEST(Vbo, AnySetOfChannels) {
    // Another order, other channels between, one with blanks in its name in [header] alone.
    const std::string text =
        "File created on 31/07/2006 @ 17:55\n[header]\ntime\nlatitude\nlongitude\nvelocity "
        "quality\nlong acc g\nSolution Type\n[column names]\ntime lat long vel_quality longacc "
        "solution_type\n[data]\n162235.40 3119.09973 58.49277 3 +1.5E-01 4\n";
    const Observations read = import_vbo(text);
    EXPECT_EQ(read.rows[0].fix, FixType::fixed);
    EXPECT_FALSE(read.rows[0].recorded_velocity_east_m_s || read.rows[0].height_m ||
                 read.rows[0].satellites);
    EXPECT_DOUBLE_EQ(*read.rows[0].longitude_deg, -58.49277 / 60.0);
    EXPECT_TRUE(has_note(read, "height_m"));
    // [column names] of names with blanks has more words than columns; [header] has as many.
    const std::string blanks = replaced(text, "vel_quality longacc solution_type",
                                        "velocity quality long acc g solution type");
    EXPECT_EQ(import_vbo(blanks).rows[0].fix, FixType::fixed);
    const Observations unheaded =
        import_vbo(replaced(replaced(header, "heading\r\n", "x\r\n"), " heading ", " x ") + row);
    EXPECT_FALSE(unheaded.rows[0].recorded_velocity_east_m_s);
    EXPECT_NEAR(*unheaded.rows[0].recorded_speed_m_s,
                std::hypot(*import_vbo(header + row).rows[0].recorded_velocity_east_m_s,
                           *import_vbo(header + row).rows[0].recorded_velocity_north_m_s),
                1e-12);
    EXPECT_TRUE(has_note(unheaded, "without a course"));
    const Observations degrees = import_vbo(
        replaced(replaced(header, "latitude", "latitude deg"), "longitude", "longitude deg") +
        replaced(replaced(row, "+03119.09973", "51.5"), "+00058.49277", "1.25"));
    EXPECT_DOUBLE_EQ(*degrees.rows[0].latitude_deg, 51.5);
    EXPECT_DOUBLE_EQ(*degrees.rows[0].longitude_deg, -1.25);
}

TEST(Vbo, SatellitesWithTheirMarks) {
    const struct {
        const char* written;
        int satellites;
        FixType fix;
    } cases[] = {{"009", 9, FixType::unknown},
                 {"73", 9, FixType::unknown},  // brake trigger
                 {"201", 9, FixType::dgps},    // both
                 {"000", 0, FixType::none},
                 {"128", 0, FixType::none}};
    for (const auto& sats : cases) {
        const Observation first = import_vbo(header + replaced(row, "137", sats.written)).rows[0];
        EXPECT_EQ(first.satellites, sats.satellites);
        EXPECT_EQ(first.fix, sats.fix);
        EXPECT_EQ(first.latitude_deg.has_value(), sats.fix != FixType::none);
    }
    const Observation origin =
        import_vbo(header + replaced(replaced(row, "+03119.09973", "0.0"), "+00058.49277", "0.0"))
            .rows[0];
    EXPECT_EQ(origin.fix, FixType::none);
    EXPECT_FALSE(origin.latitude_deg || origin.recorded_velocity_east_m_s);
}

TEST(Vbo, SolutionTypes) {
    const std::string typed = replaced(header, "height vert-vel", "height solution_type");
    const FixType kinds[] = {
        FixType::none,  FixType::single,  FixType::dgps,           FixType::float_ambiguities,
        FixType::fixed, FixType::unknown, FixType::dead_reckoning, FixType::unknown};
    for (int type = 0; type < 8; ++type)
        EXPECT_EQ(
            import_vbo(typed + replaced(row, "-001.250", fmt::format("{:02}", type))).rows[0].fix,
            kinds[type]);
}

TEST(Vbo, BadLinesAreCountedAndListed) {
    const struct {
        std::string from, to, what;
    } cases[] = {
        {"162235.40", "166035.40", "\"166035.40\" is not a time of day"},
        {"162235.40", "242235.40", "not a time of day"},
        {"162235.40", "-1622.40", "not a time of day"},
        {"162235.40", "1162235.40", "not a time of day"},
        {"162235.40", "235960.00", "no second 60"},
        {"+03119.09973", "+05400.1", "latitude of 90.0016"},
        {"+03119.09973", "0x10", "not a number"},
        {"+00058.49277", "12000", "longitude of -200 degrees"},
        {"+00058.49277", "58,49277", "decimal comma"},
        {"072.000", "-72.000", "velocity of -72"},
        {"072.000", "nan", "no number"},
        {"150.00", "999.00", "heading of 999"},
        {"+00152.58", "1e400", "height"},
        {"137", "256", "count of satellites"},
        {" -001.250", "", "7 fields; most rows have 8"},
        {"-001.250", "-001.250 4", "9 fields; most rows have 8"},
    };
    for (const auto& bad : cases) {
        const Observations read =
            import_vbo(header + row + replaced(row, bad.from, bad.to) + next_row);
        ASSERT_EQ(read.records.bad, 1) << bad.what;
        EXPECT_EQ(read.records.total, 3);
        EXPECT_EQ(read.rows.size(), 2u);
        EXPECT_EQ(read.records.bad_records[0].line, 27);
        EXPECT_TRUE(has(read.records.bad_records[0].what, bad.what))
            << read.records.bad_records[0].what;
    }
}

TEST(Vbo, CutOffAnywhere) {
    const std::string whole = header + row + next_row;
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const std::string message = failure_of(pos_receiver(), whole.substr(0, size));
        if (size < header.size() + row.size() - 9) {
            EXPECT_NE(message, "read") << size;
        }
        EXPECT_EQ(message.find("fault of the program"), std::string::npos);
    }
    const Observations read = import_vbo(header + row + next_row.substr(0, 42));
    EXPECT_EQ(read.records.bad, 1);
    EXPECT_TRUE(has(read.records.bad_records[0].what, "the last line is cut off: it has 5 fields"));
}

TEST(VboRefused, SaysWhere) {
    const struct {
        std::string text, where, what;
    } cases[] = {
        {header, "f:1:1", "no epochs"},
        {replaced(header, "[data]\r\n", ""), "f:1:1", "no section [data]"},
        {replaced(header, " lat ", " latt ") + row, "f:23:1", "no column is named \"lat\""},
        {replaced(header, " time ", " tame ") + row, "f:23:1", "no column is named \"time\""},
        {header + replaced(row, " 162235.40", " x"), "f:26:5", "not a time of day"},
    };
    for (const auto& bad : cases) {
        Receiver receiver = pos_receiver();
        const std::string message = failure_of(receiver, bad.text);
        EXPECT_EQ(message.rfind(bad.where + ": ", 0), 0u) << message;
        EXPECT_TRUE(has(message, bad.what)) << message;
        receiver.format = "vbo";
        EXPECT_EQ(failure_of(receiver, bad.text), message);
    }
    std::string many = "[header]\n";
    for (int i = 0; i < 10'001; ++i)
        many += "x\n";
    Receiver receiver = pos_receiver();
    receiver.format = "vbo";
    EXPECT_TRUE(has(failure_of(receiver, many), "more than 10000 channels"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
