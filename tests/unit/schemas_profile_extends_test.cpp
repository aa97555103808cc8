#include <gtest/gtest.h>

#include <string>

#include "schemas/profile/profile.h"
#include "store/sha256.h"
#include "store_test_support.h"

// A rule that extends one that comes with the program.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

const std::string club = R"(schema: profile/1.0
extends: gps-speed-sailing-500m
leaves_out: [witnessed, deductions]
id: club-250m
title: speed of a board over 250 m
window: {distance_m: 250}
accuracy: {limit: 0.5, unit: kn, coverage_factor: 2}
clauses:
  - {id: first, text: t, source: s, certainty: quoted, decided_by: attest}
  - {id: margin, text: Any higher speed counts., answered_by: null}
  - {id: last, text: t, source: s, certainty: quoted, decided_by: accuracy}
)";

std::vector<std::string> clause_ids(const Profile& profile) {
    std::vector<std::string> ids;
    for (const Clause& clause : profile.clauses)
        ids.push_back(clause.id);
    return ids;
}

TEST(ProfileExtends, WhatItLeavesOutIsAsThere) {
    const Profile base =
        read_profile(builtin_profile("gps-speed-sailing-500m"), "gps-speed-sailing-500m");
    const Profile profile = read_profile(club, "p");
    EXPECT_EQ(profile.id, "club-250m");
    EXPECT_EQ(profile.body, base.body);
    EXPECT_EQ(profile.window_kind, WindowKind::distance);
    EXPECT_EQ(profile.distance_m, 250.0);
    EXPECT_EQ(profile.definition, base.definition);
    EXPECT_EQ(profile.accuracy_limit, 0.5);
    EXPECT_EQ(clause_ids(profile),
              (std::vector<std::string>{"average-over-500-m", "first", "margin", "doppler-speeds",
                                        "acceleration", "hdop", "satellites", "distance-above-5-kn",
                                        "original-files", "handed-in", "approved-device",
                                        "error-deduction", "last"}));
    EXPECT_EQ(profile.clauses.at(2).text, "Any higher speed counts.");
    EXPECT_EQ(profile.clauses.at(2).source, base.clauses.at(1).source);
    EXPECT_EQ(profile.clauses.at(2).answered_by, Answerer{});
    ASSERT_EQ(profile.questions.size(), base.questions.size() - 1);
    EXPECT_EQ(profile.questions.at(0).id, "accuracy");
}

TEST(ProfileExtends, ItsHashIsThatOfTheTextWrittenOut) {
    const std::string text = resolved_profile(club, "p");
    EXPECT_EQ(text.find("extends"), std::string::npos);
    EXPECT_EQ(resolved_profile(text, "p"), text);
    const Profile profile = read_profile(club, "p");
    EXPECT_EQ(profile.sha256, sha256_hex(text));
    EXPECT_EQ(profile.sha256, read_profile(text, "p").sha256);
    EXPECT_EQ(profile.origin, RuleOrigin::own);
    // Text that looks like a number is text still.
    const std::string edition =
        replaced(club, "text: t, source: s, certainty: quoted, decided_by: attest",
                 "text: t, source: s, certainty: quoted, decided_by: attest, "
                 "edition: 9.10, where: \"2.0\"");
    const Profile again = read_profile(resolved_profile(edition, "p"), "p");
    EXPECT_EQ(again.clauses.at(1).edition, "9.10");
    EXPECT_EQ(again.clauses.at(1).where, "2.0");
}

TEST(ProfileExtends, ARuleThatExtendsNoneIsItsText) {
    const std::string text = "# a comment\n" + std::string(builtin_profile("nalsa"));
    EXPECT_EQ(resolved_profile(text, "p"), text);
}

TEST(ProfileExtends, BadInputIsNamedWithItsPlace) {
    const struct {
        std::string from, to, where, said;
    } cases[] = {
        {"gps-speed-sailing-500m", "gps-speed-sailing", "p:2:10",
         "no rule \"gps-speed-sailing\" comes with the program. Use one of: evidence-general,"},
        {"gps-speed-sailing-500m", "club-250m", "p:2:10",
         "the rule \"club-250m\" would extend itself. Name another rule"},
        {"id: club-250m", "id: gps-speed-sailing-10s", "p:2:10", "would extend itself"},
        {"gps-speed-sailing-500m", "[nalsa]", "p:2:10", "not text"},
        {"[witnessed, ", "[witness, ", "p:3:14", "has no clause or question \"witness\""},
        {"extends: gps-speed-sailing-500m\n", "", "p:2:13", "Add extends: with the rule's id"},
        {"id: club-250m\n", "", "p:1:1", "\"id\" is missing"},
        {"distance_m: 250", "duration_s: 250", "p:6:22", "kind: distance goes without duration_s"},
        {"distance_m: 250", "distance: 250", "p:6:10", "Did you mean \"distance_m\""},
        {"id: last", "id: first", "p:11:10", "two clauses have the id \"first\""},
        {"id: last", "id: margin", "p:10:10", "two entries have the id \"margin\""},
        {"kn, coverage_factor: 2}", "kn, coverage_factor: 2}\nevidence: true", "p:6:9",
         "a rule of evidence measures nothing"},
        // What comes from the other rule has the place of extends.
        {"kn, coverage_factor: 2}", "kn, coverage_factor: 2}\nspeed_of: reference_point", "p:8:11",
         "recorded velocities are those of the antenna"},
    };
    ASSERT_NO_THROW(read_profile(club, "p"));
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_profile(replaced(club, c.from, c.to), "p"); });
        EXPECT_EQ(said.where, c.where) << c.to << "\n" << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.to << "\n" << said.problem << ". " << said.remedy;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
