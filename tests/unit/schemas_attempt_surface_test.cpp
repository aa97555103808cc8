#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "schemas/attempt/attempt.h"
#include "schemas_attempt_support.h"
#include "store_test_support.h"

// The keys of the surface that a receiver's craft runs on.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;

Attempt read(const std::string& receiver_keys, const std::string& more = {}) {
    return read_attempt(
        "schema: attempt/1.0\nid: a\ncraft: {name: x, class: car}\nreceivers:\n"
        "  - id: primary\n    recording: run.csv\n" +
            receiver_keys + more + "profiles: [nalsa]\n",
        "attempt.yaml");
}

std::string surface(const std::string& keys) {
    return "    antenna_height_m: 1.25\n    surface: {file: course.xml, source: a survey" + keys +
           "}\n";
}

std::string refused(const std::string& receiver_keys) {
    const auto said = failure_of([&] { (void)read(receiver_keys); });
    return said.where + ": " + said.problem + ". " + said.remedy;
}

bool says(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(SurfaceKeys, AreReadAndHaveDefaults) {
    const Attempt attempt = read(surface(
        ", frame: {utm: {zone: 55, hemisphere: south}}, heights: geoid, undulation_m: -3.5, "
        "vertical_sd_m: 0.02, unit: us-ft, axes: north-east-up, tilt_max_deg: 20"));
    ASSERT_TRUE(has_surface(attempt.receivers[0]));
    const Surface& read_back = *attempt.receivers[0].surface;
    EXPECT_EQ(read_back.file, "course.xml");
    EXPECT_EQ(read_back.frame->utm_zone->zone, 55);
    EXPECT_EQ(read_back.heights, SurfaceHeights::geoid);
    EXPECT_EQ(read_back.undulation, -3.5);
    EXPECT_EQ(read_back.vertical_sd, 0.02);
    EXPECT_EQ(read_back.unit, "us-ft");
    EXPECT_EQ(read_back.axes, "north-east-up");
    EXPECT_EQ(read_back.tilt_max_deg, 20.0);
    EXPECT_EQ(read(surface("")).receivers[0].surface->tilt_max_deg, 10.0);
    // How the positions are read does not hang on it, nor on the antenna's height.
    EXPECT_FALSE(reading_of(attempt.written("primary"))->contains("surface"));
    EXPECT_FALSE(reading_of(attempt.written("primary"))->contains("antenna_height_m"));
    EXPECT_EQ(reading_of(attempt.written("primary"), "surface")->at("surface").at("unit"), "us-ft");
    EXPECT_FALSE(reading_of(attempt.written("primary"), "surface")->at("surface").contains("file"));
    EXPECT_FALSE(has_surface(read("").receivers[0]));
}

TEST(SurfaceKeys, StagesReadWhatTheyUseAlone) {
    const Attempt attempt =
        read(surface(", frame: geodetic, heights: ellipsoid, tilt_max_deg: 20"));
    const Attempt screened = part_read_by(attempt, "screen");
    ASSERT_TRUE(has_surface(screened.receivers[0]));
    EXPECT_EQ(screened.receivers[0].surface->tilt_max_deg, 20.0);
    EXPECT_EQ(screened.receivers[0].antenna_height_m, 1.25);
    EXPECT_FALSE(screened.receivers[0].surface->frame);
    const Attempt smoothed = part_read_by(attempt, "smooth");
    ASSERT_TRUE(has_surface(smoothed.receivers[0]));
    EXPECT_EQ(smoothed.receivers[0].surface->tilt_max_deg, 10.0);  // the default
    EXPECT_FALSE(part_read_by(attempt, "window").receivers[0].surface);
}

TEST(SurfaceKeys, WhatCannotBeComparedIsRefused) {
    EXPECT_TRUE(says(refused("    surface: {file: a.xml, source: a survey}\n"),
                     "Add antenna_height_m to the receiver"));
    EXPECT_TRUE(says(refused(surface(", frame: geodetic")), "heights: geoid, with undulation_m"));
    EXPECT_TRUE(says(refused(surface(", frame: geodetic, heights: geoid")), "Add undulation_m"));
    EXPECT_TRUE(says(refused(surface(", frame: geodetic, heights: ellipsoid, undulation_m: 3")),
                     "Write heights: geoid, or remove undulation_m"));
    EXPECT_TRUE(says(refused(surface(", frame: ecef, heights: ellipsoid")), "plan coordinates"));
    EXPECT_TRUE(says(refused(surface(", frame: local_plane")), "Add origin:"));
    EXPECT_TRUE(
        says(refused("    frame: local_plane\n" + surface(", frame: geodetic, heights: ellipsoid")),
             "frame: local_plane"));
    EXPECT_TRUE(says(refused(surface(", frame: local_plane, heights: ellipsoid")),
                     "counted from its origin"));
    EXPECT_TRUE(says(refused(surface(", unit: furlong")), "furlong"));
    EXPECT_NO_THROW(read("    frame: local_plane\n" + surface(", frame: local_plane")));
    EXPECT_NO_THROW(read(surface(", frame: local_plane"),
                         "origin: {latitude_deg: 1, longitude_deg: 2, height_m: 3}\n"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
