#include <cmath>

#include "import_test_support.h"
#include "stages/import/rinex/rinex.h"

namespace runcert::import_test {
namespace RUNCERT_FILE {

struct ReadFile {
    MeasurementFacts facts;
    std::vector<MeasuredEpoch> epochs;
};

ReadFile read_observations(std::string_view text) {
    ReadFile file;
    file.facts =
        rinex::read_measurements({.name = "f.obs", .bytes = text},
                                 [&](MeasuredEpoch& epoch) { file.epochs.push_back(epoch); });
    return file;
}

std::string observation_failure(std::string_view text) {
    try {
        (void)read_observations(text);
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "read";
}

rinex::NavigationFile navigation(std::string_view text) {
    return rinex::read_navigation({.name = "f.nav", .bytes = text});
}

std::string navigation_failure(std::string_view text) {
    try {
        (void)navigation(text);
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "read";
}

const SignalMeasurement* find(const MeasuredEpoch& epoch, const std::string& satellite,
                              const std::string& signal) {
    for (const SignalMeasurement& each : epoch.measurements)
        if (to_text(each.satellite) == satellite && to_text(each.signal) == signal) return &each;
    return nullptr;
}

// Header labels begin at the 61st character.
std::string labelled(std::string text, const std::string& label) {
    text.resize(60, ' ');
    return text + label + "\n";
}

std::string head_2(const std::string& types = "     4    C1    L1    S1    D1",
                   const std::string& more = {}) {
    return labelled("     2.11           OBSERVATION DATA    G (GPS)", "RINEX VERSION / TYPE") +
           more + labelled(types, "# / TYPES OF OBSERV") +
           labelled("  2010     1     6     5    57   14.0000000     GPS", "TIME OF FIRST OBS") +
           labelled("", "END OF HEADER");
}

std::string head_3(const std::string& more = {}, const std::string& scale = "GPS") {
    return labelled("     3.03           OBSERVATION DATA    M: Mixed", "RINEX VERSION / TYPE") +
           labelled("G    4 C1C L1C D1C S1C", "SYS / # / OBS TYPES") +
           labelled("E    2 C1X L1X", "SYS / # / OBS TYPES") + more +
           labelled("  2011    01    15    02    26   43.0000000     " + scale,
                    "TIME OF FIRST OBS") +
           labelled("", "END OF HEADER");
}

const std::string epoch_3 =
    "> 2011 01 15 02 26 43.5000000  0  3\n"
    "G01  20671985.904 8 108632018.816 8      -527.250         52.000\n"
    "E11  24671985.904   129632018.81627\n"
    "R05  20671985.904 8 108632018.816 8\n";

// The header of a station of the IGS (Trimble NetR9), and what converters leave blank.
TEST(RinexInstrument, IsWhatTheHeaderSays) {
    const std::string version =
        labelled("     3.04           OBSERVATION DATA    M", "RINEX VERSION / TYPE");
    const std::string end = labelled("", "END OF HEADER");
    const std::string receiver =
        labelled("5429R48872          TRIMBLE NETR9       5.45", "REC # / TYPE / VERS");
    EXPECT_EQ(rinex::instrument_of(
                  version + receiver +
                  labelled("5033344124          TRM59800.00     SCIT", "ANT # / TYPE") + end),
              (Instrument{.model = "TRIMBLE NETR9",
                          .serial = "5429R48872",
                          .firmware = "5.45",
                          .antenna = "TRM59800.00     SCIT, number 5033344124"}));
    EXPECT_EQ(rinex::instrument_of(version +
                                   labelled("                    u-blox", "REC # / TYPE / VERS") +
                                   labelled("17", "ANT # / TYPE") + end),
              (Instrument{.model = "u-blox", .antenna = "number 17"}));
    EXPECT_TRUE(rinex::instrument_of(version + labelled("", "REC # / TYPE / VERS") +
                                     labelled("", "ANT # / TYPE") + end + receiver)
                    .empty());
    EXPECT_TRUE(rinex::instrument_of("").empty());
}

TEST(RinexMeasurements, Version2OfARealBaseIsReadWhole) {
    const auto text = recorded("rinex_pair/yamatogawa_master.obs");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const ReadFile file = read_observations(*text);
    EXPECT_EQ(file.facts.format, "RINEX 2.10");
    EXPECT_EQ(file.facts.records.bad, 0);
    ASSERT_EQ(file.epochs.size(), 193U);
    EXPECT_EQ(to_iso(file.epochs[0].time), "2010-01-06T05:57:14.000");
    // Nine satellites: 1C with its phase, 2W (P2) with its phase.
    EXPECT_EQ(file.epochs[0].measurements.size(), 18U);
    const SignalMeasurement* second = find(file.epochs[0], "G04", "2W");
    ASSERT_TRUE(second);
    EXPECT_EQ(*second->pseudorange_m, 20671984.224);
    EXPECT_EQ(*second->phase_cycles, 84648326.266);
    EXPECT_EQ(*second->strength_db_hz, 47.0);
    EXPECT_FALSE(second->loss_of_lock || second->half_cycle);
    EXPECT_EQ(second->line, 16);  // the first of the satellite's two
    ASSERT_TRUE(file.facts.approximate_position);
    EXPECT_EQ(file.facts.approximate_position->m.x(), -3749943.5172);
}

TEST(RinexMeasurements, HalfCyclesAreOpenWhereTheIndicatorSaysSo) {
    const auto text = recorded("rinex_pair/yamatogawa_rover.obs");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const ReadFile file = read_observations(*text);
    EXPECT_EQ(file.facts.records.bad, 0);
    int half = 0, lost = 0, all = 0;
    for (const MeasuredEpoch& epoch : file.epochs)
        for (const SignalMeasurement& each : epoch.measurements) {
            half += each.half_cycle;
            lost += each.loss_of_lock;
            ++all;
        }
    // Counted in the file's own characters.
    EXPECT_EQ(all, 1913);
    EXPECT_EQ(half, 599);
    EXPECT_EQ(lost, 195);
    bool noted = false;
    for (const std::string& note : file.facts.notes)
        noted = noted || (has(note, "Line 9") && has(note, "wavelength factor 2"));
    EXPECT_TRUE(noted);
    const SignalMeasurement* first = find(file.epochs[0], "G02", "1C");
    ASSERT_TRUE(first);
    EXPECT_EQ(*first->phase_cycles, -7818.263);
    EXPECT_EQ(*first->doppler_hz, 2781.846);
}

TEST(RinexMeasurements, Version3OfAGeodeticReceiverIsReadWhole) {
    const auto text = recorded("rinex_still/javad.obs");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const ReadFile file = read_observations(*text);
    EXPECT_EQ(file.facts.format, "RINEX 3.03");
    EXPECT_EQ(file.facts.records.bad, 0);
    EXPECT_EQ(file.epochs.size(), 130U);
    EXPECT_GT(file.facts.set_aside.at(SatelliteSystem::glonass), 130);
    EXPECT_TRUE(find(file.epochs[0], "G01", "1C") != nullptr ||
                find(file.epochs[0], "G11", "1C") != nullptr);
}

TEST(RinexMeasurements, EpochsOfBothSystemsAreRead) {
    const ReadFile file = read_observations(head_3() + epoch_3);
    ASSERT_EQ(file.epochs.size(), 1U);
    EXPECT_EQ(to_iso(file.epochs[0].time), "2011-01-15T02:26:43.500");
    ASSERT_EQ(file.epochs[0].measurements.size(), 2U);
    const SignalMeasurement& galileo = file.epochs[0].measurements[1];
    EXPECT_EQ(to_text(galileo.satellite), "E11");
    EXPECT_EQ(to_text(galileo.signal), "1X");
    EXPECT_TRUE(galileo.half_cycle);
    EXPECT_FALSE(galileo.loss_of_lock);
    EXPECT_EQ(file.facts.set_aside.at(SatelliteSystem::glonass), 1);
}

TEST(RinexMeasurements, TimeScalesAreBroughtToGpsTime) {
    EXPECT_EQ(to_iso(read_observations(head_3({}, "GLO") + epoch_3).epochs[0].time),
              "2011-01-15T02:26:58.500");
    EXPECT_EQ(to_iso(read_observations(head_3({}, "BDT") + epoch_3).epochs[0].time),
              "2011-01-15T02:26:57.500");
    EXPECT_TRUE(has(observation_failure(head_3({}, "XYZ") + epoch_3), "f.obs:4:49"));
    EXPECT_TRUE(has(observation_failure(head_3({}, "XYZ") + epoch_3), "time system \"XYZ\""));
}

TEST(RinexMeasurements, EventsArePassedOverAndHeadersInsideRead) {
    const std::string event = "> 2011 01 15 02 26 43.7000000  5  1\nanything at all\n";
    const std::string types = ">                              4  1\n" +
                              labelled("E    3 C1X L1X D1X", "SYS / # / OBS TYPES");
    const std::string later =
        "> 2011 01 15 02 26 44.5000000  1  1\n"
        "E11  24671985.904   129632018.816         527.250\n";
    const ReadFile file = read_observations(head_3() + epoch_3 + event + types + later);
    ASSERT_EQ(file.epochs.size(), 2U);
    EXPECT_EQ(file.facts.records.bad, 0);
    const SignalMeasurement& galileo = file.epochs[1].measurements[0];
    EXPECT_EQ(*galileo.doppler_hz, 527.25);
    EXPECT_TRUE(galileo.loss_of_lock) << "a power failure ends every arc";
}

TEST(RinexMeasurements, WhatCannotBeReadIsCountedAndReadingGoesOn) {
    std::string bad = replaced(epoch_3, "108632018.816", "1086320x8.816");
    std::string later = replaced(epoch_3, "43.5000000", "44.5000000");
    const ReadFile file =
        read_observations(head_3() + epoch_3 + replaced(bad, "43.50", "43.75") + later);
    EXPECT_EQ(file.epochs.size(), 2U);
    ASSERT_EQ(file.facts.records.bad, 1);
    EXPECT_EQ(*file.facts.records.bad_records[0].column, 20);
    EXPECT_TRUE(has(file.facts.records.bad_records[0].what, "1086320x8.816"));
    // More satellites than the epoch announces, fewer, a repeated satellite, one not later.
    for (const std::string& wrong :
         {replaced(bad, "0  3\n", "0  2\n"), replaced(bad, "0  3\n", "0  4\n"),
          replaced(epoch_3, "E11", "G01"), epoch_3, replaced(epoch_3, "G01", "Q01"),
          replaced(epoch_3, "2011 01 15", "2011 13 15"), replaced(epoch_3, "0  3\n", "7  3\n")}) {
        const ReadFile read = read_observations(head_3() + epoch_3 + wrong + later);
        EXPECT_EQ(read.epochs.size(), 2U) << wrong;
        EXPECT_GE(read.facts.records.bad, 1) << wrong;
    }
}

TEST(RinexMeasurements, DataThatDisagreeWithTheHeaderAreRefused) {
    const std::string more = replaced(epoch_3, "52.000\n", "52.000  20671985.904\n");
    EXPECT_TRUE(has(observation_failure(head_3() + more), "more observations than"));
    const std::string unknown = replaced(epoch_3, "E11", "E11");
    const std::string without = replaced(head_3(), "E    2 C1X L1X", "J    2 C1X L1X");
    EXPECT_TRUE(has(observation_failure(without + unknown), "names no types of Galileo"));
}

TEST(RinexMeasurements, HeadersThatAreNotUnderstoodAreRefusedWithTheirLine) {
    EXPECT_TRUE(has(observation_failure(replaced(head_3(), "3.03", "1.03") + epoch_3), "f.obs:1"));
    EXPECT_TRUE(has(observation_failure(replaced(head_3(), "OBSERVATION", "NAVIGATION ") + epoch_3),
                    "kind \"N\""));
    EXPECT_TRUE(has(observation_failure(head_3(labelled("G  10", "SYS / SCALE FACTOR")) + epoch_3),
                    "f.obs:4:3"));
    EXPECT_TRUE(has(observation_failure(head_3().substr(0, 200)), "END OF HEADER"));
    EXPECT_TRUE(has(observation_failure(head_3()), "no epochs"));
    EXPECT_TRUE(has(observation_failure(head_2("     1    C1")), "no carrier phase"));
    EXPECT_TRUE(has(observation_failure("x"), "no RINEX file"));
    EXPECT_TRUE(has(observation_failure(""), "the recording is empty"));
}

TEST(RinexMeasurements, Version2OfManySatellitesGoesOnInASecondLine) {
    std::string text = head_2() + " 10  1  6  5 57 14.0000000  0 13";
    for (int i = 1; i <= 12; ++i)
        text += fmt::format("G{:2}", i);
    text += "\n" + std::string(32, ' ') + "G13\n";
    for (int i = 1; i <= 13; ++i)
        text +=
            fmt::format("  2112490{}.520 8 111012132.702 8        51.000       123.456\n", i % 10);
    const ReadFile file = read_observations(text);
    ASSERT_EQ(file.epochs.size(), 1U);
    ASSERT_EQ(file.epochs[0].measurements.size(), 13U);
    EXPECT_EQ(*file.epochs[0].measurements[12].pseudorange_m, 21124903.520);
    EXPECT_EQ(to_text(file.epochs[0].measurements[0].satellite), "G01");
}

TEST(RinexMeasurements, AnIndicatorOfAnOpenHalfCycleIsKept) {
    const std::string epoch =
        " 10  1  6  5 57 14.0000000  0  1G02\n  21124906.520 8 111012132.70238\n";
    const auto measured =
        read_observations(head_2("     2    C1    L1") + epoch).epochs[0].measurements[0];
    EXPECT_TRUE(measured.half_cycle && measured.loss_of_lock);
}

TEST(RinexNavigation, BroadcastOrbitsAndClocksAreThoseOfRtklib) {
    const auto text = recorded("rinex_pair/yamatogawa_rover.nav");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    struct Row {
        std::uint8_t number;
        double second;
        Eigen::Vector3d position_m;
        double clock_us;
    };
    // RTKLIB's eph2pos; rinex_oracle_test asks it for every satellite and epoch.
    const Row rows[] = {{2, 280634.0, {-3795575.549, 15167469.885, 21407006.301}, 212.280023},
                        {5, 280700.0, {1248885.907, 25266367.594, 7931837.541}, -19.706606},
                        {13, 280800.0, {-18198776.913, -428610.181, 19218199.350}, 306.665892}};
    Ephemerides ephemerides(navigation(*text).ephemerides);
    for (const Row& row : rows) {
        const GpsTime time = GpsTime::from_week(1565, std::llround(row.second * 1e9));
        const auto chosen = ephemerides.choose({SatelliteSystem::gps, row.number}, time);
        ASSERT_TRUE(chosen);
        const SatelliteState state = satellite_state(ephemerides[*chosen], time);
        EXPECT_LT((state.position_m - row.position_m).cwiseAbs().maxCoeff(), 0.001)
            << int{row.number} << ": " << (state.position_m - row.position_m).transpose();
        EXPECT_NEAR(state.clock_s * 1e6, row.clock_us, 1e-5);
    }
}

TEST(RinexNavigation, MixedNavigationIsReadAndTheRestSetAside) {
    const auto text = recorded("rinex_still/javad.nav");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const rinex::NavigationFile file = navigation(*text);
    int gps = 0, galileo = 0;
    for (const Ephemeris& each : file.ephemerides)
        ++(each.satellite.system == SatelliteSystem::gps ? gps : galileo);
    EXPECT_GT(gps, 8);
    EXPECT_GE(galileo, 1);
    EXPECT_FALSE(file.notes.empty());
}

TEST(RinexNavigation, WhatIsNoEphemerisIsSetAsideWithItsLine) {
    const auto text = recorded("rinex_pair/yamatogawa_rover.nav");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const std::string bad = replaced(*text, "5.153650835037D+03", "5.15365083x037D+03");
    const rinex::NavigationFile file = navigation(bad);
    EXPECT_EQ(file.ephemerides.size() + 1, navigation(*text).ephemerides.size());
    ASSERT_FALSE(file.notes.empty());
    EXPECT_TRUE(has(file.notes[0], "line 4")) << file.notes[0];
    EXPECT_TRUE(has(file.notes[0], "5.15365083x037e+03")) << file.notes[0];
    EXPECT_TRUE(has(navigation_failure(replaced(*text, "NAVIGATION", "OBSERVATIO")), "kind"));
    EXPECT_TRUE(has(navigation_failure("x"), "no RINEX file"));
    EXPECT_TRUE(has(navigation_failure(text->substr(0, 600)), "lines of 8"));
    EXPECT_TRUE(navigation(text->substr(0, 243)).ephemerides.empty());
}

TEST(RinexNavigation, AKindThatIsNoLetterIsShownEscaped) {
    EXPECT_TRUE(
        has(navigation_failure(labelled("     3.04           \x01: NAV", "RINEX VERSION / TYPE")),
            "kind \"\\x01\""));
    EXPECT_TRUE(
        has(observation_failure(labelled("     3.04           \x01: OBS", "RINEX VERSION / TYPE")),
            "kind \"\\x01\""));
}

TEST(RinexNavigation, OfGlonassAloneIsSetAside) {
    const rinex::NavigationFile file =
        navigation(labelled("     2.01           GLONASS NAV DATA", "RINEX VERSION / TYPE") +
                   labelled("", "END OF HEADER"));
    EXPECT_TRUE(file.ephemerides.empty());
    EXPECT_EQ(file.notes, std::vector<std::string>{"Navigation of GLONASS is not used."});
}

TEST(RinexNavigation, AnOrbitThatIsNoneIsRefused) {
    const auto text = recorded("rinex_pair/yamatogawa_rover.nav");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const std::string bad = replaced(*text, "5.153650835037D+03", "5.153650835037D-03");
    const rinex::NavigationFile file = navigation(bad);
    ASSERT_FALSE(file.notes.empty());
    EXPECT_TRUE(has(file.notes[0], "no orbit of a navigation satellite")) << file.notes[0];
}

}  // namespace RUNCERT_FILE
}  // namespace runcert::import_test
