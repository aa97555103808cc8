#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdio>
#include <set>

#include "import_nmea_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace nmea_test;
using nmea_test::sentence;  // not core/text.h's

std::size_t distinct_gga_times(const std::string& text) {
    std::set<std::string> times;
    for (std::size_t at = text.find("GGA,"); at != std::string::npos;
         at = text.find("GGA,", at + 1))
        times.insert(text.substr(at + 4, text.find(',', at + 4) - at - 4));
    return times.size();
}

TEST(NmeaInstrument, IsWhatTheReceiverSaysWhenItIsSwitchedOn) {
    const std::string on = sentence("GNTXT,01,01,02,u-blox AG - www.u-blox.com") +
                           sentence("GNTXT,01,01,02,HW UBX-M8030 00080000") +
                           sentence("GNTXT,01,01,02,ROM CORE 3.01 (107888)") +
                           sentence("GNTXT,01,01,02,FWVER=SPG 3.01") +
                           sentence("GNTXT,01,01,02,MOD=NEO-M8N-0");
    const std::string fixes = gga("120000.00") + rmc("120000.00", "010120") + gga("120000.10") +
                              rmc("120000.10", "010120");
    EXPECT_EQ(read_nmea(on + fixes).instrument,
              (Instrument{.make = "u-blox", .model = "NEO-M8N-0", .firmware = "SPG 3.01"}));
    EXPECT_FALSE(read_nmea(sentence("GNTXT,01,01,02,ANTSTATUS=OK") + fixes).instrument);
}

TEST(Nmea, RealLogOfStandingReceiverByHand) {
    const auto text = recorded("nmea_gst/static_f9p.nmea");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = read_nmea(*text);
    EXPECT_EQ(read.format, "nmea");
    EXPECT_EQ(read.time_scale, "utc");
    EXPECT_EQ(read.accuracy_source, "recording");
    EXPECT_EQ(read.variant, "NMEA 0183 with GGA, RMC, VTG, GST, GSA, ZDA");
    EXPECT_EQ(read.rows.size(), 29u);
    EXPECT_EQ(read.rows.size(), distinct_gga_times(*text));
    EXPECT_EQ(utc_of(read, 0), "2019-04-12T00:39:56.000Z");
    EXPECT_EQ(utc_of(read, 28), "2019-04-12T00:40:24.000Z");
    EXPECT_DOUBLE_EQ(read.facts.nominal_interval_s, 1.0);
    // 29 each of GGA, RMC, VTG, GST, ZDA and four times as many GSA.
    EXPECT_EQ(read.records.total, 29 * 9);
    EXPECT_EQ(read.records.bad, 0);
    // $GNGGA,003956.00,4552.65403,S,17030.00668,E,1,12,0.64,14.2,M,1.8,M,,
    // $GNGST,003956.00,235111,,,,2.3,3.5,4.0
    const Observation& row = read.rows.front();
    EXPECT_NEAR(*row.latitude_deg, -(45.0 + 52.65403 / 60.0), 1e-13);
    EXPECT_NEAR(*row.longitude_deg, 170.0 + 30.00668 / 60.0, 1e-13);
    EXPECT_NEAR(*row.height_m, 16.0, 1e-12);
    EXPECT_EQ(*row.sigma_north_m, 2.3);
    EXPECT_EQ(*row.sigma_east_m, 3.5);
    EXPECT_EQ(*row.sigma_up_m, 4.0);
    EXPECT_FALSE(row.correlation_east_north);
    EXPECT_EQ(row.fix, FixType::single);
    EXPECT_EQ(row.satellites, 12);
    EXPECT_EQ(row.source_line, 3);
    // It moves at 0.045 km/h by VTG, and nobody says where to.
    EXPECT_FALSE(row.recorded_velocity_east_m_s);
}

TEST(Nmea, RealLogWithContradictoryErrorEllipses) {
    const auto text = recorded("nmea_gst/static_skytraq.nmea");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = read_nmea(*text);
    EXPECT_EQ(read.rows.size(), 96u);
    EXPECT_EQ(read.rows.size(), distinct_gga_times(*text));
    EXPECT_EQ(utc_of(read, 0), "2016-04-07T21:31:21.000Z");
    EXPECT_EQ(utc_of(read, 95), "2016-04-07T21:32:56.000Z");
    EXPECT_EQ(read.records.bad, 0);
    // $GPGST,213121.000,16.1,22.2,10.2,2.0,0.4,0.6,1.4: axes of 22 m and deviations of 0.5 m.
    const Observation& row = read.rows.front();
    EXPECT_EQ(*row.sigma_north_m, 0.4);
    EXPECT_EQ(*row.sigma_east_m, 0.6);
    EXPECT_EQ(*row.sigma_up_m, 1.4);
    EXPECT_FALSE(row.correlation_east_north);
    EXPECT_TRUE(has_note(read, "GST error ellipses that do not agree"));
    EXPECT_NEAR(*row.height_m, 1102.537 - 20.3, 1e-9);
    EXPECT_EQ(row.fix, FixType::dgps);
    EXPECT_EQ(*row.recorded_velocity_east_m_s, 0.0);
}

/// What stands between `begin` and `end` in the first `text` that has it.
std::optional<std::string> between(const std::string& text, const std::string& begin,
                                   const std::string& end) {
    const std::size_t at = text.find(begin);
    if (at == std::string::npos) return std::nullopt;
    const std::size_t from = at + begin.size();
    return text.substr(from, text.find(end, from) - from);
}

class NmeaByGpsbabel : public testing::TestWithParam<const char*> {};

// gpsbabel is an independent reader; it writes GPX with 1e-9 degrees, 1 mm and whole seconds. It
// is given the log without RMC: where RMC comes before GGA in an epoch, gpsbabel (1.8.0) puts each
// position at the time of the next.
TEST_P(NmeaByGpsbabel, SaysTheSame) {
    const std::string name = std::string("nmea_gst/") + GetParam();
    const auto text = recorded(name);
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    if (std::system("command -v gpsbabel > /dev/null") != 0)
        GTEST_SKIP() << "gpsbabel is not installed";
    const std::string command =
        fmt::format("grep -av RMC, '{}/{}' | gpsbabel -t -i nmea -f - -o gpx -F -",
                    std::getenv("RUNCERT_DATA"), name);
    std::string gpx;
    std::FILE* pipe = popen(command.c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
        gpx += static_cast<char>(c);
    ASSERT_EQ(pclose(pipe), 0);
    const Observations read = read_nmea(*text);
    std::size_t point = 0;
    for (std::size_t at = gpx.find("<trkpt"); at != std::string::npos; ++point) {
        const std::size_t end = gpx.find("</trkpt>", at);
        const std::string trkpt = gpx.substr(at, end - at);
        at = gpx.find("<trkpt", end);
        const Observation& row = read.rows.at(point);
        EXPECT_NEAR(*row.latitude_deg, std::stod(*between(trkpt, "lat=\"", "\"")), 0.51e-9);
        EXPECT_NEAR(*row.longitude_deg, std::stod(*between(trkpt, "lon=\"", "\"")), 0.51e-9);
        EXPECT_EQ(utc_of(read, point, 0), *between(trkpt, "<time>", "</time>"));
        const auto above_sea = between(trkpt, "<ele>", "</ele>");
        const auto geoid = between(trkpt, "<geoidheight>", "</geoidheight>");
        ASSERT_TRUE(above_sea && geoid);
        EXPECT_NEAR(*row.height_m, std::stod(*above_sea) + std::stod(*geoid), 0.51e-3);
    }
    EXPECT_EQ(point, read.rows.size());
}

INSTANTIATE_TEST_SUITE_P(Real, NmeaByGpsbabel,
                         testing::Values("static_f9p.nmea", "static_skytraq.nmea"),
                         [](const auto& instance) {
                             const std::string name = instance.param;
                             return name.substr(0, name.find('.'));
                         });

TEST(Nmea, SentencesOfOneTimeMakeOneEpoch) {
    // Any talker, in any order; VTG and GSA have no time and belong to the time before them.
    const Observations read =
        read_nmea(sentence("GBZDA,101112.25,05,03,2021,00,00") + gga("101112.25", "4") +
                  sentence("GNVTG,30.00,T,,M,19.438,N,36.000,K,R") +
                  sentence("GNGSA,A,3,01,02,,,,,,,,,,,1.0,0.5,0.9,1") +
                  sentence("GPGST,101112.25,1.0,0.020,0.010,30.0,0.0180,0.0132,0.035") +
                  sentence("GPGSV,1,1,01,01,40,100,40") +
                  sentence("GAGGA,101112.50,4530.0000060,N,"
                           "00915.0000000,E,5,9,1,120.5,M,47.25,M,,"));
    ASSERT_EQ(read.rows.size(), 2u);
    EXPECT_EQ(read.records.total, 6);  // the GSV is none
    EXPECT_EQ(utc_of(read, 0), "2021-03-05T10:11:12.250Z");
    EXPECT_EQ(utc_of(read, 1), "2021-03-05T10:11:12.500Z");
    const Observation& row = read.rows[0];
    EXPECT_EQ(*row.latitude_deg, 45.5);
    EXPECT_EQ(*row.longitude_deg, 9.25);
    EXPECT_EQ(*row.height_m, 167.75);
    EXPECT_EQ(row.fix, FixType::fixed);
    EXPECT_EQ(row.satellites, 10);
    EXPECT_EQ(*row.age_s, 1.5);
    EXPECT_NEAR(*row.recorded_velocity_east_m_s, 5.0, 1e-12);
    EXPECT_NEAR(*row.recorded_velocity_north_m_s, 10.0 * std::sqrt(0.75), 1e-12);
    EXPECT_FALSE(row.recorded_velocity_up_m_s);
    EXPECT_EQ(*row.sigma_north_m, 0.0180);
    EXPECT_EQ(*row.sigma_up_m, 0.035);
    // The ellipse's long axis of 20 mm points to 30 degrees: covariance by its own two axes.
    const double e[2] = {std::sin(M_PI / 6), std::cos(M_PI / 6)};  // east, north of the long axis
    const double a2 = 4e-4, b2 = 1e-4;
    const double ee = a2 * e[0] * e[0] + b2 * e[1] * e[1], nn = a2 * e[1] * e[1] + b2 * e[0] * e[0];
    EXPECT_NEAR(*row.correlation_east_north, (a2 - b2) * e[0] * e[1] / std::sqrt(ee * nn), 1e-12);
    EXPECT_EQ(read.rows[1].fix, FixType::float_ambiguities);
    EXPECT_FALSE(read.rows[1].sigma_east_m);
    EXPECT_FALSE(read.rows[1].recorded_velocity_east_m_s);
    // 1e-7 minutes of latitude are 0.185 mm.
    EXPECT_NEAR(*read.facts.position_resolution_m, 1.852e-4, 2e-6);
}

struct Kind {
    const char* quality;
    FixType fix;
};
class NmeaQuality : public testing::TestWithParam<Kind> {};

TEST_P(NmeaQuality, IsTheKindOfSolution) {
    const Observations read =
        read_nmea(gga("101112.00", GetParam().quality) + rmc("101112.00", "050321"));
    ASSERT_EQ(read.rows.size(), 1u);
    EXPECT_EQ(read.rows[0].fix, GetParam().fix);
    EXPECT_EQ(read.rows[0].latitude_deg.has_value(), GetParam().fix != FixType::none);
    EXPECT_EQ(has_note(read, "quality of 7 or more"), GetParam().quality[0] > '6');
}

INSTANTIATE_TEST_SUITE_P(
    All, NmeaQuality,
    testing::Values(Kind{"0", FixType::none}, Kind{"1", FixType::single}, Kind{"2", FixType::dgps},
                    Kind{"3", FixType::single}, Kind{"4", FixType::fixed},
                    Kind{"5", FixType::float_ambiguities}, Kind{"6", FixType::dead_reckoning},
                    Kind{"7", FixType::unknown}, Kind{"8", FixType::unknown}),
    [](const auto& instance) { return std::string("q") + instance.param.quality; });

TEST(Nmea, EverySentenceMustSayThatThereIsAFix) {
    const std::string position = gga("101112.00");
    const auto fix = [&](const std::string& more) {
        return read_nmea(position + more + rmc("101113.00", "050321")).rows.at(0).fix;
    };
    EXPECT_EQ(fix(""), FixType::single);
    EXPECT_EQ(fix(sentence("GPRMC,101112.00,V,,,,,,,050321,,,N")), FixType::none);
    EXPECT_EQ(fix(sentence("GPRMC,101112.00,A,4530.0,N,00915.0,E,1,2,050321,,,N")), FixType::none);
    EXPECT_EQ(fix(sentence("GPGSA,A,1,,,,,,,,,,,,,,,")), FixType::none);
    // A system without satellites is no reason while another has some.
    EXPECT_EQ(fix(sentence("GPGSA,A,3,,,,,,,,,,,,,,,") + sentence("GLGSA,A,1,,,,,,,,,,,,,,,")),
              FixType::single);
}

TEST(Nmea, RmcAloneHasNoHeight) {
    Receiver receiver = pos_receiver();
    const std::string text = rmc("101112.00", "050321") + rmc("101113.00", "050321");
    const Observations without = import_text(receiver, text);
    EXPECT_FALSE(without.facts.vertical_measured);
    EXPECT_FALSE(without.rows[0].height_m);
    EXPECT_EQ(*without.rows[0].latitude_deg, 45.5);
    EXPECT_EQ(without.rows[0].fix, FixType::single);
    EXPECT_NEAR(*without.rows[0].recorded_velocity_east_m_s, 18520.0 / 3600.0, 1e-12);
    receiver.height_m = 12.0;
    EXPECT_EQ(*import_text(receiver, text).rows[1].height_m, 12.0);
}

TEST(Nmea, GnsGivesPositionWhereGgaDoesNot) {
    const Observations read =
        read_nmea(rmc("101112.00", "050321") +
                  sentence("GNGNS,101112.00,4530.0000000,N,00915.0000000,E,RFNN,15,0.6,120.5,47.25,"
                           "2.0,0001,V"));
    ASSERT_EQ(read.rows.size(), 1u);
    EXPECT_EQ(read.rows[0].fix, FixType::fixed);
    EXPECT_EQ(*read.rows[0].height_m, 167.75);
    EXPECT_EQ(read.rows[0].satellites, 15);
    EXPECT_EQ(*read.rows[0].age_s, 2.0);
}

TEST(Nmea, HeightWithoutSeparationIsNoted) {
    const Observations read =
        read_nmea(sentence("GPGGA,101112.00,4530.0,N,00915.0,E,1,10,0.9,120.5,M,,,,") +
                  rmc("101112.00", "050321"));
    EXPECT_EQ(*read.rows[0].height_m, 120.5);
    EXPECT_TRUE(has_note(read, "above mean sea level"));
}

/// Ten epochs of RMC and GGA, `talker(i)` that of the epoch's, so many minutes of latitude north.
template <class Talker>
std::string of_talker(Talker talker, double minutes) {
    std::string text;
    for (int i = 0; i < 10; ++i)
        text += sentence(fmt::format("{}GGA,10111{}.00,52{:07.4f},N,00507.2000,E,4,12,0.5,40.0,M,"
                                     "45.0,M,1.0,0000",
                                     talker(i), i, minutes)) +
                sentence(fmt::format("{}RMC,10111{}.00,A,52{:07.4f},N,00507.2000,E,10.0,0.0,050321,"
                                     ",,R",
                                     talker(i), i, minutes));
    return text;
}

/// Every line of one text before that of the other.
std::string interleaved(const std::string& one, const std::string& other) {
    std::string text;
    for (std::size_t a = 0, b = 0; a < one.size() && b < other.size();) {
        const std::size_t end_a = one.find('\n', a) + 1, end_b = other.find('\n', b) + 1;
        text += one.substr(a, end_a - a) + other.substr(b, end_b - b);
        a = end_a;
        b = end_b;
    }
    return text;
}

TEST(Nmea, OfSeveralTalkersWhosePositionsAlternateOneIsRead) {
    const auto always = [](const char* word) { return [word](int) { return word; }; };
    const std::string both =
        interleaved(of_talker(always("GP"), 30.0), of_talker(always("GN"), 30.5));
    const Observations read = read_nmea(both);
    ASSERT_EQ(read.rows.size(), 10U);
    for (const Observation& row : read.rows)
        EXPECT_NEAR(*row.latitude_deg, 52.0 + 30.5 / 60.0, 1e-9);
    EXPECT_TRUE(has(fmt::format("{}", fmt::join(read.notes, " ")),
                    "those of GN are used, and 20 sentences of others are not"))
        << read.notes.back();
    // One receiver that uses more satellites from an epoch on.
    const Observations one = read_nmea(of_talker([](int i) { return i < 5 ? "GP" : "GN"; }, 30.0));
    EXPECT_EQ(one.rows.size(), 10U);
    EXPECT_FALSE(has(fmt::format("{}", fmt::join(one.notes, " ")), "talkers"));
    // One receiver whose types have talkers of their own.
    std::string mixed = of_talker(always("GP"), 30.0);
    for (std::size_t at = mixed.find("$GPRMC"); at != std::string::npos;
         at = mixed.find("$GPRMC", at + 1)) {
        const std::size_t star = mixed.find('*', at);
        mixed = mixed.substr(0, at) + sentence("GN" + mixed.substr(at + 3, star - at - 3)) +
                mixed.substr(mixed.find('\n', at) + 1);
    }
    EXPECT_EQ(read_nmea(mixed).rows.size(), 10U);
    EXPECT_FALSE(has(fmt::format("{}", fmt::join(read_nmea(mixed).notes, " ")), "talkers"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
