#include <algorithm>
#include <cstdlib>

#include "import_test_support.h"
#include "stages/import/rinex/rinex.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

struct Pair {
    std::string rover, base, navigation;
};

std::optional<Pair> recorded_pair() {
    const auto file = [](const char* name) {
        return recorded(std::string("rinex_pair/yamatogawa_") + name);
    };
    const auto rover = file("rover.obs");
    if (!rover) return std::nullopt;
    return Pair{*rover, *file("master.obs"), *file("rover.nav")};
}

rinex::Solution solve(const Receiver& receiver, const Pair& pair) {
    return rinex::solve(receiver, {.name = "rover.obs", .bytes = pair.rover},
                        {.name = "base.obs", .bytes = pair.base},
                        {{.name = "rover.nav", .bytes = pair.navigation}});
}

Receiver rinex_receiver(const std::string& pass = "forward") {
    Receiver receiver = pos_receiver();
    receiver.format = "rinex";
    receiver.solution_pass = pass;
    return receiver;
}

#define REQUIRE_PAIR(pair)             \
    const auto pair = recorded_pair(); \
    if (!pair) GTEST_SKIP() << "RUNCERT_DATA is not set"

TEST(Rinex, IsRecognisedByItsHeaderLine) {
    EXPECT_TRUE(rinex::recognises(
        "     2.11           OBSERVATION DATA    M (MIXED)           RINEX VERSION / TYPE\n"));
    EXPECT_FALSE(rinex::recognises("%  GPST  latitude(deg)"));
    EXPECT_FALSE(rinex::recognises(""));
}

const std::string compact =
    "1.0                 COMPACT RINEX FORMAT                    CRINEX VERS   / TYPE\n"
    "RNX2CRX ver.4.0.7                       14-Mar-26 10:00     CRINEX PROG / DATE\n"
    "     2.11           OBSERVATION DATA    M (MIXED)           RINEX VERSION / TYPE\n";

TEST(Rinex, CompactFilesAreRefusedByNameInEachRole) {
    const std::string plain =
        "     2.11           OBSERVATION DATA    M (MIXED)           RINEX VERSION / TYPE\n";
    for (const std::size_t role : {0, 1, 2}) {
        Pair pair{plain, plain, plain};
        std::string* files[] = {&pair.rover, &pair.base, &pair.navigation};
        *files[role] = compact;
        try {
            (void)solve(rinex_receiver(), pair);
            FAIL();
        } catch (const Failure& failure) {
            const char* names[] = {"rover.obs:1:1", "base.obs:1:1", "rover.nav:1:1"};
            EXPECT_EQ(failure.where(), names[role]);
            EXPECT_TRUE(has(failure.what(), "compact RINEX (Hatanaka)")) << failure.what();
            EXPECT_TRUE(has(failure.remedy(), "CRX2RNX"));
        }
    }
    EXPECT_TRUE(has(failure_of(pos_receiver(), compact), "CRX2RNX"));
}

// The README of the data says: 203 epochs, nearly all float.
TEST(Rinex, APairIsSolvedForwardsAndBackwardsApart) {
    REQUIRE_PAIR(pair);
    const rinex::Solution solution = solve(rinex_receiver(), *pair);
    const Observations forward = rinex::read(rinex_receiver(), solution, "forward.primary.pos");
    const Observations backward =
        rinex::read(rinex_receiver("backward"), solution, "backward.primary.pos");
    EXPECT_EQ(forward.format, "rinex");
    EXPECT_EQ(forward.rows.size(), 203U);
    EXPECT_GT(
        std::count_if(forward.rows.begin(), forward.rows.end(),
                      [](const Observation& row) { return row.fix == FixType::float_ambiguities; }),
        190);
    EXPECT_EQ(forward.records.bad, 0);
    EXPECT_TRUE(forward.rows.front().sigma_east_m);
    EXPECT_EQ(forward.variant, "solved by RTKLIB ver.2.4.3, forward");
    EXPECT_NE(backward.variant, forward.variant);
    // A combination would be nearer to both, and the same whichever way one asks.
    EXPECT_NE(forward.rows.back().latitude_deg, backward.rows.back().latitude_deg);
    EXPECT_NE(forward.notes.back().find("The backward solution, kept beside it"), std::string::npos)
        << forward.notes.back();
}

TEST(Rinex, TheSameTwiceAndWithoutAPathOfTheMachine) {
    REQUIRE_PAIR(pair);
    const rinex::Solution first = solve(rinex_receiver(), *pair);
    const rinex::Solution second = solve(rinex_receiver(), *pair);
    EXPECT_EQ(first.forward, second.forward);
    EXPECT_EQ(first.backward, second.backward);
    EXPECT_EQ(first.forward.find("/tmp"), std::string::npos);
    EXPECT_NE(first.forward.find("% solution  : Forward"), std::string::npos);
    EXPECT_NE(first.backward.find("% solution  : Backward"), std::string::npos);
    EXPECT_NE(first.configuration.find("pos2-armode        =continuous"), std::string::npos);
}

TEST(Rinex, ABasePositionMovesTheSolutionWithIt) {
    REQUIRE_PAIR(pair);
    Receiver moved = rinex_receiver();
    // That of the file's header, 34.590871529 135.512913551 60.6743, 10 m higher.
    moved.base_position = Geodetic{.latitude = Angle::from_degrees(34.590871529),
                                   .longitude = Angle::from_degrees(135.512913551),
                                   .height_m = 70.6743};
    const auto read = [&](const Receiver& receiver) {
        return rinex::read(receiver, solve(receiver, *pair), "f");
    };
    const Observations as_in_file = read(rinex_receiver());
    const Observations higher = read(moved);
    ASSERT_EQ(as_in_file.rows.size(), higher.rows.size());
    EXPECT_NEAR(*higher.rows[100].height_m - *as_in_file.rows[100].height_m, 10.0, 0.1);
}

TEST(Rinex, WhatCannotBeSolvedSaysWhy) {
    const auto said = [](const Pair& pair) -> std::string {
        try {
            (void)solve(rinex_receiver(), pair);
        } catch (const Failure& failure) {
            return failure.what();
        }
        return "solved";
    };
    const std::string header =
        "     2.11           OBSERVATION DATA    G (GPS)             RINEX VERSION / TYPE\n";
    EXPECT_NE(said({header, header, header}).find("rover.obs: "), std::string::npos);
    EXPECT_NE(said({"x\n", "x\n", "x\n"}).find("Check that rover, base and navigation are RINEX"),
              std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
