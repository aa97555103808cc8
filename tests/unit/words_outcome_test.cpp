#include <gtest/gtest.h>

#include <set>

#include "schemas/verdict/outcome.h"

namespace runcert::RUNCERT_FILE {
namespace {

std::vector<Requirement> requirements(std::initializer_list<RequirementStatus> of) {
    std::vector<Requirement> list;
    for (const RequirementStatus status : of)
        list.push_back({.clause = "c", .status = status});
    return list;
}

constexpr auto met = RequirementStatus::met;
constexpr auto attest = RequirementStatus::attest;

std::string title(const OutcomeState& state) {
    return outcome_words(state).title;
}

OutcomeState beaten(Standing standing, bool altered = false) {
    return {.outcome = Outcome::beaten,
            .standing = standing,
            .record_named = true,
            .rule_altered = altered};
}

TEST(WordsOfOutcomes, TheStandingCountsWhatPeopleMustStillAnswerFor) {
    EXPECT_EQ(standing_text(standing_of(requirements({met, met}), 0)), "complete");
    EXPECT_EQ(standing_text(standing_of(requirements({met, attest}), 0)), "awaiting 1 attestation");
    EXPECT_EQ(standing_text(standing_of(requirements({attest, attest}), 2)),
              "awaiting 2 attestations and 2 signatures");
    EXPECT_EQ(standing_text(standing_of(requirements({met}), 1)), "awaiting 1 signature");
    EXPECT_EQ(standing_of({}, 0).state, StandingState::complete);
}

// DESIGN, "Outcome and standing are two things".
TEST(WordsOfOutcomes, ARecordIsBeatenOnlyWhereNothingIsOpenAndTheRuleIsTheBodysOwn) {
    OutcomeState state = beaten(standing_of(requirements({met}), 0));
    EXPECT_EQ(title(state), "Measured speed exceeds the record");
    // By the roster of whoever reads it, and never without saying whose.
    state.vouched_by = "by the roster 4a84 9c1e: compare it with your body's";
    EXPECT_EQ(title(state), "Record beaten, by the roster 4a84 9c1e: compare it with your body's");
    state.standing = {.state = StandingState::awaiting, .unclosed = 1};
    EXPECT_EQ(title(state), "Measured speed exceeds the record; answers not closed");
    EXPECT_EQ(standing_text(state.standing), "answers not closed");
    state.standing = standing_of(requirements({met}), 0);
    state.rule_altered = true;
    EXPECT_EQ(title(state), "Measured speed exceeds the record under altered rules");
    EXPECT_EQ(title(beaten(standing_of(requirements({attest}), 0))),
              "Measured speed exceeds the record; 1 requirement still to be attested");
    EXPECT_EQ(title(beaten(standing_of(requirements({attest, attest}), 2), true)),
              "Measured speed exceeds the record under altered rules; 2 requirements still to be "
              "attested and 2 signatures required");
}

TEST(WordsOfOutcomes, WhatWasAnsweredButDoesNotCountIsSaid) {
    OutcomeState state = beaten({.state = StandingState::refused, .refused = 1});
    state.vouched_by = "by the roster 4a84 9c1e";
    EXPECT_EQ(title(state), "Measured speed exceeds the record; 1 requirement answered no");
    EXPECT_EQ(standing_text(state.standing), "1 requirement answered no");
    state.standing = {.state = StandingState::awaiting, .unvouched = 7};
    EXPECT_EQ(title(state),
              "Measured speed exceeds the record; 7 answers by keys that nobody vouched for");
    EXPECT_EQ(standing_text(state.standing), "7 answers by keys that nobody vouched for");
    state.standing.attestations = 2;
    EXPECT_EQ(standing_text(state.standing),
              "awaiting 2 attestations; 7 answers by keys that nobody vouched for");
}

TEST(WordsOfOutcomes, ANegativeOutcomeGivesItsReason) {
    OutcomeState state{.outcome = Outcome::not_proven, .record_named = true};
    EXPECT_EQ(title(state), "Not proven: required speed within the uncertainty");
    state.record_named = false;
    EXPECT_EQ(title(state), "Speed measured; the attempt names no record");
    state.outcome = Outcome::not_beaten;
    EXPECT_EQ(title(state), "Record not beaten: measured speed below the required speed");
    state.outcome = Outcome::not_certifiable;
    EXPECT_EQ(title(state), "Not certifiable");
}

TEST(WordsOfOutcomes, EveryOutcomeHasItsOwnMark) {
    std::set<std::string> marks;
    for (const Outcome outcome :
         {Outcome::beaten, Outcome::not_beaten, Outcome::not_proven, Outcome::not_certifiable})
        marks.insert(outcome_words({.outcome = outcome, .record_named = true}).mark);
    EXPECT_EQ(marks.size(), 4U);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
