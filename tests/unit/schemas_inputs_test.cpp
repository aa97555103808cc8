#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/failure.h"
#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"
#include "schemas/verdict/declared.h"

// Who says what of an attempt: each key's origin, what it can change, and who answers for it.

namespace runcert::RUNCERT_FILE {
namespace {

bool is_leaf(const FieldRule& rule) {
    return std::ranges::none_of(
        rule.types, [](const std::string& type) { return type == "map" || type == "list"; });
}

TEST(Origins, EveryKeyOfAnAttemptHasOne) {
    for (const FieldRule& rule : attempt_schema().fields()) {
        if (!is_leaf(rule)) continue;
        SCOPED_TRACE(rule.path);
        const FieldOrigin* const origin = attempt_schema().origin_of(rule.path);
        ASSERT_NE(origin, nullptr);
        InputOrigin word{};
        EXPECT_TRUE(from_text(origin->origin, word)) << origin->origin;
    }
}

TEST(Origins, WhatCanChangeSomethingIsAnsweredForInAClauseThatThereIs) {
    // The recording of any receiver but the first is answered for in a clause of its own.
    std::set<std::string> claims, used{"secondary-as-recorded"};
    for (const Clause& own : own_clauses())
        if (own.decided_by == Computation::claims) claims.insert(own.id);
    const std::set<std::string> known{"speed", "uncertainty", "outcome", "requirements"};
    for (const FieldRule& rule : attempt_schema().fields()) {
        if (!rule.origin) continue;
        SCOPED_TRACE(rule.path);
        const FieldOrigin& origin = *rule.origin;
        for (const std::string& change : origin.changes)
            EXPECT_TRUE(known.contains(change)) << change;
        for (const std::string& name : origin.decides) {
            Computation computation{};
            EXPECT_TRUE(from_text(name, computation)) << name;
        }
        if (!origin.clause.empty()) {
            EXPECT_TRUE(claims.contains(origin.clause)) << origin.clause;
        }
        EXPECT_EQ(origin.changes.empty(), origin.clause.empty() && origin.decides.empty());
        used.insert(origin.clause);
    }
    for (const std::string& clause : claims)
        EXPECT_TRUE(used.contains(clause)) << clause;
}

constexpr std::string_view attempt_text = R"(schema: attempt/1.0
id: a
craft: {name: x, class: car}
attempts_made: 1
receivers:
  - id: one
    recording: [a.csv, b.csv]
    format: csv
    time_format: seconds
    columns: {time: t, east: 2}
    frame: {utm: {zone: 55, hemisphere: south}}
    accuracy: {horizontal_m: 0.01}
    antenna_height_m: 2
  - {id: two, recording: c.pos, solution: fixed}
records: [{profile: nalsa, speed: 100, unit: km/h, source: "a \"book\""}]
wind: {file: wind.csv, source: mast}
profiles: [nalsa, rules/ours.yaml]
parameters: {smooth: {jerk_density: 1}}
)";

std::string said(const AttemptInput& input) {
    return input.name + "=" + input.value + "," + input.origin.origin + "," + input.profile;
}

TEST(Origins, OfAnAttemptAllThatCanChangeSomethingIsListed) {
    std::vector<std::string> listed;
    for (const AttemptInput& input : read_attempt(attempt_text, "attempt.yaml").inputs)
        listed.push_back(said(input));
    EXPECT_EQ(
        listed,
        (std::vector<std::string>{
            "craft.class=car,claimed,", "attempts_made=1,claimed,",
            "receivers.one.recording=a.csv, b.csv,observed,", "receivers.one.format=csv,claimed,",
            "receivers.one.columns.time=t,claimed,", "receivers.one.columns.east=2,claimed,",
            "receivers.one.frame.utm.zone=55,claimed,",
            "receivers.one.frame.utm.hemisphere=south,claimed,",
            "receivers.one.accuracy.horizontal_m=0.01 m,claimed,",
            "receivers.two.recording=c.pos,handed_in,", "receivers.two.solution=fixed,claimed,",
            "records.nalsa.profile=nalsa,claimed,nalsa", "records.nalsa.speed=100,claimed,nalsa",
            "records.nalsa.unit=km/h,claimed,nalsa",
            "records.nalsa.source=a \"book\",claimed,nalsa", "wind.file=wind.csv,handed_in,",
            "wind.source=mast,claimed,", "profiles=rules/ours.yaml,claimed,",
            "parameters.smooth.jerk_density=1 m s-2.5,claimed,"}));
}

TEST(Origins, HowManyAttemptsWereMadeIsAClaimWhereNothingIsSaid) {
    const auto inputs = read_attempt(
                            "schema: attempt/1.0\nid: a\ncraft: {name: x, class: car}\n"
                            "receivers: [{id: one, recording: a.pos}]\nprofiles: [nalsa]\n",
                            "attempt.yaml")
                            .inputs;
    ASSERT_EQ(inputs.size(), 3U);
    EXPECT_EQ(said(inputs[2]), "attempts_made=1,claimed,");
}

TEST(Origins, ARuleCannotAskForClaims) {
    const std::string text =
        "schema: profile/1.0\nid: ours\nbody: b\ntitle: t\n"
        "window: {duration_s: 3, definition: displacement}\n"
        "margin: {kind: absolute, value: 1, unit: km/h}\nclauses:\n"
        "  - {id: wheel-as-measured, text: t, source: s, certainty: quoted, decided_by: claims}\n";
    try {
        read_profile(text, "ours.yaml");
        FAIL() << "it was read";
    } catch (const Failure& failure) {
        EXPECT_NE(std::string(failure.what()).find("ours.yaml:8"), std::string::npos)
            << failure.what();
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
