#include "import_test_support.h"
#include "stages/import/gpsbabel/gpsbabel.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

const std::string fit = std::string("\x0e\x10\xd9\x07\x00\x00\x00\x00", 8) + ".FIT\x00\x00";

std::string type_of(const std::string& type, std::string_view bytes) {
    Receiver receiver = pos_receiver();
    receiver.gpsbabel_type = type;
    try {
        return gpsbabel::type_of(receiver, {.name = "f", .bytes = bytes});
    } catch (const Failure& failure) {
        return failure.what();
    }
}

TEST(Gpsbabel, RecognisesWellKnownFormats) {
    EXPECT_EQ(type_of("", fit), "garmin_fit");
    EXPECT_EQ(type_of("", "<?xml version='1.0'?>\n<TrainingCenterDatabase xmlns='x'>"), "gtrnctr");
    EXPECT_EQ(type_of("", "<!-- a --><kml>"), "kml");
    for (const char* other : {"", "<gpx>", "kml", "<html><kml>", ".FIT"})
        EXPECT_FALSE(gpsbabel::recognises(other)) << other;
    EXPECT_NE(type_of("", "what?").find("f:1:1: "), std::string::npos);
}

TEST(Gpsbabel, TakesNoDeviceAndNoOption) {
    EXPECT_EQ(type_of("humminbird", fit), "humminbird");
    for (const char* type : {"garmin", "xcsv,style=/etc/passwd", "gpx,gpxver=1.0", "-o", "../kml"})
        EXPECT_NE(type_of(type, fit).find("attempt.yaml:5:5: "), std::string::npos) << type;
    EXPECT_NE(type_of("garmin_fti", fit).find("Did you mean garmin_fit?"), std::string::npos);
}

TEST(Gpsbabel, WhatItMakesIsReadAndMarked) {
    const gpsbabel::Converted converted{
        .gpx =
            "<gpx version=\"1.0\" creator=\"GPSBabel\"><trkpt lat=\"1\" lon=\"2\"><ele>3</ele>"
            "<time>2019-04-12T00:39:56Z</time><course>90</course><speed>3.5</speed></trkpt>"
            "<trkpt lat=\"1\" lon=\"x\"><time>2019-04-12T00:39:56Z</time></trkpt></gpx>",
        .program = {.name = "gpsbabel", .version = "1.8.0", .sha256 = "05"}};
    const Observations read = gpsbabel::read_converted(
        pos_receiver(), {.name = "f.fit", .bytes = fit}, "garmin_fit", converted);
    EXPECT_EQ(read.format, "gpsbabel");
    EXPECT_EQ(read.variant, "garmin_fit");
    EXPECT_EQ(read.device, "");
    EXPECT_EQ(read.accuracy_source, "none");
    ASSERT_EQ(read.rows.size(), 1u);
    EXPECT_FALSE(read.rows[0].source_line || read.rows[0].source_byte);
    EXPECT_NEAR(*read.rows[0].recorded_velocity_east_m_s, 3.5, 1e-12);
    EXPECT_EQ(read.records.bad, 1);
    ASSERT_FALSE(read.notes.empty());
    EXPECT_TRUE(read.notes.front().starts_with(
        "The recording was read through gpsbabel, as its format garmin_fit"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
