#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "import_test_support.h"

// Columbus loggers' tables, in their modes and with their ways to fill cells up.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

const std::string simple =
    "INDEX,TAG,DATE,TIME,LATITUDE N/S,LONGITUDE E/W,HEIGHT,SPEED,HEADING,VOX\r\n";

struct Mode {
    const char* name;
    std::string text;  ///< * is what fills cells up
};

void PrintTo(const Mode& mode, std::ostream* out) {
    *out << mode.name;
}

const Mode modes[] = {
    {"Simple", simple +
                   "1*****,T,140613,101112,52.123456N,005.654321W,-5***,36**,270,*********\r\n"
                   "2*****,V,140613,101113,52.123456S,005.654465E,-5***,36**,90*,VOX00002*\r\n"},
    {"WithoutVoice",
     "INDEX,TAG,DATE,TIME,LATITUDE N/S,LONGITUDE E/W,HEIGHT,SPEED,HEADING\n"
     "1,T,140613,101112,52.1234560N,5.6543210W,-5,36.0,270\n"
     "2,T,140613,101113,52.1234560S,5.6544650E,-5,36.0,90,\n"},
    {"WithPressure",
     "INDEX,TAG,DATE,TIME,LATITUDE N/S,LONGITUDE E/W,HEIGHT,SPEED,HEADING,PRES,TEMP\n"
     "1,T,140613,101112,52.123456N,5.654321W,-5,36,270,1021.3,18\n"
     "2,T,140613,101113,52.123456S,5.654465E,-5,36,90,1021.3,18 \n"},
    {"Professional",
     "INDEX,TAG,DATE,TIME,LATITUDE N/S,LONGITUDE E/W,HEIGHT,SPEED,HEADING,FIX MODE,VALID,PDOP,HDOP,"
     "VDOP,VOX\r\n"
     "1*****,T,140613,101112,52.123456N,005.654321W,-5***,36**,270,3D,SPS "
     ",2.3**,2.1**,1.0**,****\r\n"
     "2*****,T,140613,101113,52.123456S,005.654465E,-5***,36**,90*,3D,DGPS,2.3**,2.1**,1.0**,****"
     "\r\n"}};

class Columbus : public testing::TestWithParam<Mode> {};

TEST_P(Columbus, IsReadWithoutADescription) {
    for (const char fill : {' ', '\0'}) {
        std::string text = GetParam().text;
        std::replace(text.begin(), text.end(), '*', fill);
        const Observations read = import_text(pos_receiver(), text);
        EXPECT_EQ(read.format, "columbus");
        EXPECT_EQ(read.records.bad, 0) << noted(read);
        ASSERT_EQ(read.rows.size(), 2U);
        // yymmdd: not the 14th of June 2013.
        EXPECT_EQ(to_utc_iso(*read.facts.first_epoch), "2014-06-13T10:11:12.000Z");
        EXPECT_EQ(read.rows[1].time.nanoseconds, 1'000'000'000);
        const Observation &west = read.rows[0], &east = read.rows[1];
        EXPECT_EQ(*west.latitude_deg, 52.123456);
        EXPECT_EQ(*west.longitude_deg, -5.654321);
        EXPECT_EQ(*east.latitude_deg, -52.123456);
        EXPECT_EQ(*east.longitude_deg, 5.654465);
        EXPECT_EQ(*west.height_m, -5.0);
        EXPECT_NEAR(*west.recorded_velocity_east_m_s, -10.0, 1e-9);
        EXPECT_NEAR(*east.recorded_velocity_east_m_s, 10.0, 1e-9);
        const bool professional = std::string(GetParam().name) == "Professional";
        EXPECT_EQ(west.fix, professional ? FixType::single : FixType::unknown);
        EXPECT_EQ(east.fix, professional ? FixType::dgps : FixType::unknown);
        EXPECT_TRUE(has_note(read, "above mean sea level"));
    }
}

INSTANTIATE_TEST_SUITE_P(All, Columbus, testing::ValuesIn(modes),
                         [](const auto& mode) { return std::string(mode.param.name); });

TEST(ColumbusTime, MayBeLocal) {
    Receiver receiver = pos_receiver();
    receiver.time_scale = "local";
    receiver.utc_offset_h = 2.0;
    const Observations read =
        import_text(receiver, simple + "1,T,140613,011112,52.1N,5.1E,3,36,270,\r\n");
    EXPECT_EQ(to_utc_iso(*read.facts.first_epoch), "2014-06-12T23:11:12.000Z");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
