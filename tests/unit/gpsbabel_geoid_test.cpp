#include <gtest/gtest.h>

#include "core/failure.h"
#include "stages/import/geoid.h"

namespace runcert::RUNCERT_FILE {
namespace {

// NGA's test points of EGM96 (F477, OUTPUT.DAT). The grid of 15' is linear between its points,
// which in mountains leaves some decimetres.
TEST(Geoid, HeightsAreThePublishedOnes) {
    const Geoid egm96(GeoidModel::egm96);
    const struct {
        double latitude_deg, longitude_deg, height_m;
    } published[] = {{38.628155, 269.779155, -31.628}, {-14.621217, 305.021114, -2.969},
                     {46.874319, 102.448729, -43.575}, {-23.617446, 133.874712, 15.871},
                     {38.625473, 359.999500, 50.066},  {-0.466744, 0.002300, 17.329}};
    for (const auto& one : published)
        EXPECT_NEAR(egm96.height_m(one.latitude_deg, one.longitude_deg), one.height_m, 0.35)
            << one.latitude_deg;
    EXPECT_FALSE(egm96.grid().empty());
}

StreamedRecording recording() {
    StreamedRecording made;
    made.head.facts.georeferenced = true;
    made.rows = 2;
    made.give = [](const TakeRow& take) {
        Observation row;
        row.latitude_deg = -23.617446;
        row.longitude_deg = 133.874712;
        row.height_m = 100.0;
        take(row);
        row.height_m = OptionalReal();
        take(row);
    };
    return made;
}

TEST(Geoid, RaisesTheHeightsThatThereAre) {
    StreamedRecording raised = recording();
    Receiver receiver;
    raise_heights(raised, receiver);
    EXPECT_TRUE(raised.head.notes.empty());
    receiver.height_reference = HeightReference{.geoid = GeoidModel::egm96};
    raise_heights(raised, receiver);
    std::vector<OptionalReal> heights;
    raised.give([&](const Observation& row) { heights.push_back(row.height_m); });
    ASSERT_EQ(heights.size(), 2U);
    EXPECT_NEAR(*heights[0], 115.871, 0.35);
    EXPECT_FALSE(heights[1]);
    ASSERT_EQ(raised.head.notes.size(), 1U);
    EXPECT_EQ(raised.head.header.programs.at(0).sha256.size(), 64U);
    raised.head.facts.georeferenced = false;
    EXPECT_THROW(raise_heights(raised, receiver), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
