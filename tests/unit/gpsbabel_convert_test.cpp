#include <algorithm>

#include "gpsbabel_support.h"
#include "import_test_support.h"
#include "stages/import/gpsbabel/gpsbabel.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

std::string failure_of_converting(const std::string& type, std::string_view bytes) {
    try {
        (void)gpsbabel::convert(type, {.name = "f", .bytes = bytes});
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "converted";
}

/// 200 points, 1 s apart: a Training Center file carries places, heights and times.
std::string training_center_track() {
    std::string points;
    for (int i = 0; i < 200; ++i)
        points += "<Trackpoint><Time>" +
                  to_utc_iso(gps_from_utc({2019, 4, 12, 0, 39, 0, 0})
                                 .plus_nanoseconds(i * GpsTime::nanoseconds_per_second),
                             0) +
                  "</Time><Position><LatitudeDegrees>" + format_fixed(54.3 + i * 1e-4, 7) +
                  "</LatitudeDegrees><LongitudeDegrees>" + format_fixed(-1.3 - i * 1e-4, 7) +
                  "</LongitudeDegrees></Position><AltitudeMeters>" + format_fixed(10.0 + i, 1) +
                  "</AltitudeMeters></Trackpoint>";
    return "<?xml version=\"1.0\"?><TrainingCenterDatabase><Activities><Activity Sport=\"Other\">"
           "<Id>2019-04-12T00:39:00Z</Id><Lap StartTime=\"2019-04-12T00:39:00Z\"><Track>" +
           points + "</Track></Lap></Activity></Activities></TrainingCenterDatabase>";
}

// gpsbabel obeys a gpsbabel.ini in the folder that it is called from: whoever hands one in would
// change what is read.
TEST(GpsbabelConvert, ObeysNoPreferencesOfTheFolderItIsCalledFrom) {
    if (!has_gpsbabel()) GTEST_SKIP() << "gpsbabel is not installed";
    const std::string text = training_center_track();
    const RecordingBytes recording{.name = "f.tcx", .bytes = text};
    const std::string before = gpsbabel::convert("gtrnctr", recording).gpx;
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "gpsbabel.ini",
                          "[gpx]\nelevprec=0\nsuppresswhite=1\n[gtrnctr]\n");
    const std::filesystem::path here = std::filesystem::current_path();
    std::filesystem::current_path(folder.path());
    const ProcessResult obeyed = run_process(
        {"sh", "-c", "cat > t.tcx && gpsbabel -t -i gtrnctr -f t.tcx -o gpx,gpxver=1.0 -F -"},
        {.standard_input = [&] {
            write_file_atomically(folder.path() / "in.tcx", text);
            return folder.path() / "in.tcx";
        }()});
    const std::string after = gpsbabel::convert("gtrnctr", recording).gpx;
    std::filesystem::current_path(here);
    EXPECT_EQ(obeyed.output.find("<ele>10.000"), std::string::npos) << "the file has no effect";
    const auto track = [](const std::string& gpx) { return gpx.substr(gpx.find("<bounds")); };
    EXPECT_EQ(track(after), track(before));  // what stands before says when it was converted
}

TEST(GpsbabelConvert, TrainingCenterTrackComesThroughWhole) {
    if (!has_gpsbabel()) GTEST_SKIP() << "gpsbabel is not installed";
    const std::string text = training_center_track();
    const RecordingBytes recording{.name = "f.tcx", .bytes = text};
    const std::string type = gpsbabel::type_of(pos_receiver(), recording);
    const gpsbabel::Converted converted = gpsbabel::convert(type, recording);
    EXPECT_EQ(converted.program.version.find_first_not_of("0123456789."), std::string::npos);
    const Observations read = gpsbabel::read_converted(pos_receiver(), recording, type, converted);
    EXPECT_EQ(read.variant, "gtrnctr");
    ASSERT_EQ(read.rows.size(), 200u);
    for (std::size_t i = 0; i < 200; ++i) {
        const auto n = static_cast<double>(i);
        EXPECT_NEAR(*read.rows[i].latitude_deg, 54.3 + n * 1e-4, 1e-9);
        EXPECT_NEAR(*read.rows[i].longitude_deg, -1.3 - n * 1e-4, 1e-9);
        EXPECT_NEAR(*read.rows[i].height_m, 10.0 + n, 1e-3);
        EXPECT_EQ(read.rows[i].time.nanoseconds,
                  static_cast<std::int64_t>(i) * GpsTime::nanoseconds_per_second);
    }
}

/// A real recording as a Garmin FIT file: gpsbabel's own writer leaves points at one place out.
TEST(GpsbabelConvert, FitOfARecording) {
    if (!has_gpsbabel()) GTEST_SKIP() << "gpsbabel is not installed";
    const auto bytes = recorded("nmea_gst/static_skytraq.nmea");
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const std::string fit = gpsbabel_converted("nmea", *bytes, "garmin_fit");
    const RecordingBytes recording{.name = "f.fit", .bytes = fit};
    const std::string type = gpsbabel::type_of(pos_receiver(), recording);
    EXPECT_EQ(type, "garmin_fit");
    const Observations read = gpsbabel::read_converted(pos_receiver(), recording, type,
                                                       gpsbabel::convert(type, recording));
    const std::vector<ReferencePoint> reference = gpsbabel_points("nmea", *bytes);
    std::size_t compared = 0;
    for (const Observation& row : read.rows) {
        const std::string utc =
            to_utc_iso(read.facts.first_epoch->plus_nanoseconds(row.time.nanoseconds), 0);
        const auto same = std::find_if(
            reference.begin(), reference.end(),
            [&](const ReferencePoint& point) { return point.utc.substr(0, 19) + "Z" == utc; });
        ASSERT_NE(same, reference.end()) << utc;
        // FIT has 2^31 steps to half a turn.
        EXPECT_NEAR(*row.latitude_deg, same->latitude_deg, 1e-7);
        EXPECT_NEAR(*row.longitude_deg, same->longitude_deg, 1e-7);
        ++compared;
    }
    EXPECT_GT(compared, 0u);
}

TEST(GpsbabelConvert, ItsWordsAreInTheMessage) {
    if (!has_gpsbabel()) GTEST_SKIP() << "gpsbabel is not installed";
    const std::string what = failure_of_converting("garmin_fit", std::string(200, 'x'));
    EXPECT_TRUE(what.starts_with("f:1:1: gpsbabel cannot read it as garmin_fit: ")) << what;
}

TEST(GpsbabelConvert, WithoutItThePackageIsNamed) {
    setenv("RUNCERT_EXTERNAL_PATH", "/nowhere", 1);
    const std::string what = failure_of_converting("kml", "<kml/>");
    unsetenv("RUNCERT_EXTERNAL_PATH");
    EXPECT_NE(what.find("Install the package gpsbabel"), std::string::npos) << what;
}

TEST(GpsbabelConvert, NoProgramOfThatNameInPathOrFolderIsRun) {
    if (!has_gpsbabel()) GTEST_SKIP() << "gpsbabel is not installed";
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "gpsbabel", "#!/bin/sh\necho 9.9.9\n");
    std::filesystem::permissions(folder.path() / "gpsbabel", std::filesystem::perms::owner_all);
    const std::string path = std::getenv("PATH");
    const std::filesystem::path here = std::filesystem::current_path();
    setenv("PATH", (folder.path().string() + ":" + path).c_str(), 1);
    std::filesystem::current_path(folder.path());
    const std::string text = training_center_track();
    const auto converted = gpsbabel::convert("gtrnctr", {.name = "f.tcx", .bytes = text});
    std::filesystem::current_path(here);
    setenv("PATH", path.c_str(), 1);
    EXPECT_NE(converted.program.version, "9.9.9");
    EXPECT_EQ(converted.program.sha256,
              run_process({"sha256sum", "/usr/bin/gpsbabel"}).output.substr(0, 64));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
