#include "import_inspect_support.h"
#include "import_test_support.h"
#include "late_speeds.h"
#include "stages/import/fit/decode.h"

// Speeds that are not of the moments of their positions, named by `inspect` in every format.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;
using namespace late_speeds;

struct Format {
    const char* name;
    std::function<std::string(const std::vector<Row>&)> write;
    bool course;
};

Receiver receiver_of(const Format& format) {
    if (format.name != std::string("csv")) return pos_receiver();
    Receiver receiver = csv_receiver();
    receiver.frame = StatedFrame{CoordinateFrame::geodetic};
    receiver.height_m = 0.0;
    receiver.columns = {
        {"time", "time_s"}, {"latitude", "lat"}, {"longitude", "lon"}, {"speed", "speed"}};
    return receiver;
}

const std::vector<Format> formats{
    {"gpx", late_speeds::gpx, false},
    {"nmea", late_speeds::nmea, true},
    {"csv", late_speeds::csv, false},
    {"flysight", late_speeds::flysight, true},
    {"fit", [](const auto& rows) { return late_speeds::fit(rows, runcert::fit::crc16); }, false}};

Observations imported(const Format& format, const Recorded& recorded) {
    return import_text(receiver_of(format), format.write(recorded.rows()));
}

TEST(LateSpeeds, TheirDelayIsNamedInEveryFormat) {
    for (const Format& format : formats)
        for (const double delay_s : {5.0, 20.0, 43.0, 55.0, 100.0}) {
            SCOPED_TRACE(fmt::format("{} {}", format.name, delay_s));
            const Observations read =
                imported(format, {.duration_s = 500.0, .delay_s = always(delay_s)});
            const Inspection it = inspect(read);
            ASSERT_EQ(it.velocity_delays.size(), 1U);
            EXPECT_NEAR(it.velocity_delays[0].delay_s, delay_s, 0.51);
            EXPECT_TRUE(it.velocity_delays[0].beyond);
            EXPECT_EQ(it.speeds_alone > it.with_velocity / 2, !format.course);
            const std::string text = inspection_text(read);
            EXPECT_NE(text.find(fmt::format("{:.3g} s ± 0.3 s behind the positions",
                                            it.velocity_delays[0].delay_s)),
                      std::string::npos)
                << text;
            EXPECT_NE(text.find("are not those of the positions beside them"), std::string::npos);
        }
}

TEST(LateSpeeds, SpeedsOfTheirPositionsHaveNone) {
    for (const Format& format : formats)
        for (const double delay_s : {0.0, 1.0}) {
            SCOPED_TRACE(fmt::format("{} {}", format.name, delay_s));
            const Observations read = imported(format, {.delay_s = always(delay_s)});
            const Inspection it = inspect(read);
            ASSERT_EQ(it.velocity_delays.size(), 1U);
            EXPECT_NEAR(it.velocity_delays[0].delay_s, delay_s, 0.51);
            EXPECT_FALSE(it.velocity_delays[0].beyond);
            EXPECT_EQ(inspection_text(read).find("are not those of the positions"),
                      std::string::npos);
        }
}

TEST(LateSpeeds, LostInTheMiddleAreNamedWithWhereTheyAre) {
    const Observations read = imported(
        formats[0], {.board = {.longer_s = 3.0, .sails_s = 1200.0},
                     .duration_s = 1260.0,
                     .delay_s = [](double time_s) { return time_s < 600.0 ? 0.0 : 43.0; }});
    const Inspection it = inspect(read);
    ASSERT_EQ(it.velocity_delays.size(), 2U);
    EXPECT_FALSE(it.velocity_delays[0].beyond);
    EXPECT_NEAR(it.velocity_delays[1].from_s, 600.0, 31.0);
    EXPECT_NEAR(it.velocity_delays[1].delay_s, 43.0, 0.51);
    const std::string text = inspection_text(read);
    EXPECT_NE(text.find("from 0 s to"), std::string::npos) << text;
    EXPECT_NE(text.find("43 s ± 0.3 s behind the positions"), std::string::npos) << text;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
