#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "schemas/profile/profile.h"
#include "store_test_support.h"

// The rules that come with the program.

namespace runcert::RUNCERT_FILE {
namespace {

Profile builtin(const std::string& name) {
    return read_profile(builtin_profile(name), name + ".yaml");
}

const Clause& clause_of(const Profile& profile, const std::string& id) {
    const auto found = std::ranges::find(profile.clauses, id, &Clause::id);
    if (found == profile.clauses.end()) throw Failure(profile.id, "has no clause " + id, "Add it");
    return *found;
}

std::vector<std::string> question_ids(const Profile& profile) {
    std::vector<std::string> ids;
    for (const RuleQuestion& question : profile.questions)
        ids.push_back(question.id);
    return ids;
}

TEST(BuiltinProfiles, AreThoseOfTheFolderEachNamedAsItsFile) {
    const std::filesystem::path folder = std::string(RUNCERT_SOURCE_DIR) + "/stages/check/profiles";
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".yaml") continue;
        const std::string name = entry.path().stem().string();
        names.push_back(name);
        EXPECT_EQ(builtin_profile(name), resolved_profile(test::slurp(entry.path()), name));
        EXPECT_EQ(builtin(name).id, name);
    }
    std::ranges::sort(names);
    EXPECT_EQ(builtin_profiles(), names);
    EXPECT_EQ(names, (std::vector<std::string>{"evidence-general",
                                               "fai-speed-skydiving",
                                               "fai-speed-skydiving-2026",
                                               "fai-speed-skydiving-record",
                                               "fisly",
                                               "gps-ice-sailing-10s",
                                               "gps-ice-sailing-1h",
                                               "gps-ice-sailing-2s",
                                               "gps-ice-sailing-500m",
                                               "gps-ice-sailing-5x10s",
                                               "gps-ice-sailing-alpha-250",
                                               "gps-ice-sailing-alpha-500",
                                               "gps-ice-sailing-nautical-mile",
                                               "gps-speed-sailing-10s",
                                               "gps-speed-sailing-1h",
                                               "gps-speed-sailing-2s",
                                               "gps-speed-sailing-500m",
                                               "gps-speed-sailing-5x10s",
                                               "gps-speed-sailing-alpha-250",
                                               "gps-speed-sailing-alpha-500",
                                               "gps-speed-sailing-nautical-mile",
                                               "nalsa",
                                               "wssrc-500m",
                                               "wssrc-nautical-mile"}));
    EXPECT_EQ(builtin_profile("none"), "");
    EXPECT_EQ(builtin_profile(""), "");
}

// Every rule has a line in stages/check/published_rules.txt: sha256sum of its resolved text, two
// blanks, id, revision.
TEST(BuiltinProfiles, ArePublishedTexts) {
    for (const std::string& name : builtin_profiles()) {
        const Profile profile = builtin(name);
        EXPECT_EQ(profile.origin, RuleOrigin::built_in)
            << profile.sha256 << "  " << name << " " << profile.revision;
        EXPECT_EQ(profile.revision, 1);
        EXPECT_NO_THROW(require_own_id(profile, name));
    }
}

TEST(BuiltinProfiles, AnotherTextWithTheirIdIsRefused) {
    std::string text(builtin_profile("nalsa"));
    text += "# the same but for this line\n";
    const Profile other = read_profile(text, "nalsa.yaml");
    EXPECT_EQ(other.origin, RuleOrigin::own);
    EXPECT_THROW(require_own_id(other, "nalsa.yaml"), Failure);
    text.replace(text.find("id: nalsa"), 9, "id: NALSA");
    EXPECT_THROW(require_own_id(read_profile(text, "NALSA.yaml"), "NALSA.yaml"), Failure);
    text.replace(text.find("id: NALSA"), 9, "id: club");
    const Profile own = read_profile(text, "club.yaml");
    EXPECT_EQ(own.origin, RuleOrigin::own);
    EXPECT_NO_THROW(require_own_id(own, "club.yaml"));
}

TEST(BuiltinProfiles, EveryClauseSaysWhereItIsKnownFrom) {
    for (const std::string& name : builtin_profiles()) {
        SCOPED_TRACE(name);
        const Profile profile = builtin(name);
        EXPECT_FALSE(profile.body.empty() || profile.title.empty());
        EXPECT_TRUE(profile.overrides.empty());
        std::set<Computation> computations;
        for (const Clause& clause : profile.clauses) {
            SCOPED_TRACE(clause.id);
            computations.insert(clause.decided_by);
            EXPECT_GE(clause.text.size(), 15U);
            EXPECT_FALSE(clause.source.empty());
            // What was not found is not told as known, and the other way round.
            if (clause.source == "not found") {
                EXPECT_EQ(clause.certainty, Certainty::unconfirmed);
            }
            if (clause.source.starts_with("press") || clause.source.starts_with("newsletters") ||
                clause.source.starts_with("headings")) {
                EXPECT_NE(clause.certainty, Certainty::quoted);
            }
            EXPECT_EQ(clause.limit.has_value(), !clause.unit.empty());
        }
        if (profile.evidence) continue;
        // Each says over what, and by how much; a limit of accuracy where it has one is compared.
        EXPECT_TRUE(computations.contains(Computation::window_complete));
        EXPECT_TRUE(computations.contains(Computation::margin));
        EXPECT_EQ(computations.contains(Computation::accuracy),
                  profile.accuracy_limit_m_s.has_value());
    }
}

/// What the program itself asks is not what a rule says: no rule of the folder asks it too.
TEST(OwnClauses, StandBesideThoseOfEveryRule) {
    std::vector<std::string_view> computations;
    for (const Clause& clause : own_clauses()) {
        SCOPED_TRACE(clause.id);
        if (clause.decided_by != Computation::claims)
            computations.push_back(to_text(clause.decided_by));
        EXPECT_GE(clause.text.size(), 15U);
        EXPECT_EQ(clause.source, "this program's own requirement");
        EXPECT_EQ(clause.certainty, Certainty::quoted);
        EXPECT_FALSE(clause.limit);
        for (const std::string& name : builtin_profiles())
            for (const Clause& of_rule : builtin(name).clauses)
                EXPECT_FALSE(of_rule.id == clause.id || of_rule.decided_by == clause.decided_by)
                    << name;
    }
    EXPECT_EQ(computations,
              (std::vector<std::string_view>{"time_scale", "recording_date", "measured_positions",
                                             "stated_solution", "recorded_speeds", "speed_of"}));
}

/// What is merely not known is a question for the body: no official could attest it.
TEST(BuiltinProfiles, WhatIsNotKnownIsAQuestionUnlessItIsDecided) {
    for (const std::string& name : builtin_profiles()) {
        SCOPED_TRACE(name);
        for (const Clause& clause : builtin(name).clauses) {
            if (clause.certainty != Certainty::unconfirmed) continue;
            EXPECT_TRUE(clause.decided_by != Computation::attest || clause.id == "flat-course")
                << clause.id;
        }
        for (const RuleQuestion& question : builtin(name).questions)
            EXPECT_NE(question.text.find('?'), std::string::npos) << question.id;
    }
}

TEST(BuiltinProfiles, Nalsa) {
    const Profile profile = builtin("nalsa");
    EXPECT_EQ(profile.window_kind, WindowKind::time);
    EXPECT_EQ(profile.duration_s, 3.0);
    EXPECT_EQ(profile.definition, SpeedDefinition::displacement);
    EXPECT_DOUBLE_EQ(profile.accuracy_limit_m_s.value(), 0.8 / 3.6);
    EXPECT_EQ(profile.accuracy_unit, "km/h");
    EXPECT_EQ(profile.coverage_factor, 2.0);
    EXPECT_EQ(profile.margin_kind, MarginKind::absolute);
    EXPECT_DOUBLE_EQ(profile.margin, 0.44704);
    EXPECT_FALSE(profile.rounding || profile.result || profile.opposite_runs_within_s);
    EXPECT_EQ(clause_of(profile, "flat-course").decided_by, Computation::flatness);
    EXPECT_EQ(clause_of(profile, "flat-course").limit, 1.0);
    EXPECT_EQ(clause_of(profile, "flat-course").unit, "m");
    EXPECT_EQ(clause_of(profile, "own-start").decided_by, Computation::standing_start);
    std::vector<std::string> ids;
    for (const Clause& clause : profile.clauses)
        ids.push_back(clause.id);
    EXPECT_EQ(ids, (std::vector<std::string>{"average-over-3-s", "accuracy", "margin",
                                             "positions-on-the-earth", "secondary-method",
                                             "flat-course", "own-start", "wind-power-only",
                                             "observers", "measurement-plan"}));
    EXPECT_EQ(question_ids(profile), (std::vector<std::string>{"rounding", "decision-rule"}));
}

TEST(BuiltinProfiles, Fisly) {
    const Profile profile = builtin("fisly");
    EXPECT_EQ(profile.duration_s, 2.0);
    EXPECT_FALSE(profile.accuracy_limit_m_s);
    EXPECT_EQ(profile.margin_kind, MarginKind::relative);
    EXPECT_EQ(profile.margin, 0.002);
    ASSERT_TRUE(profile.rounding && profile.result);
    for (const DecimalRule& rule : {*profile.rounding, *profile.result}) {
        EXPECT_EQ(rule.mode, DecimalMode::truncate);
        EXPECT_EQ(rule.unit, "km/h");
        EXPECT_EQ(rule.decimals, 2);
    }
    EXPECT_EQ(profile.clauses.size(), 9U);
    EXPECT_EQ(clause_of(profile, "own-start").decided_by, Computation::standing_start);
    EXPECT_EQ(clause_of(profile, "flat-course").decided_by, Computation::attest);
    // 222.43 km/h and 0.2 % are 222.87486, which gives 222.87 either way: so the question says.
    EXPECT_EQ(std::floor(222.43 * 1.002 * 100.0), std::round(222.43 * 1.002 * 100.0));
    EXPECT_EQ(question_ids(profile),
              (std::vector<std::string>{"accuracy", "rounding", "flatness"}));
    EXPECT_NE(profile.questions[1].text.find("does not prove"), std::string::npos);
}

TEST(BuiltinProfiles, Wssrc) {
    for (const auto& [name, distance_m] :
         {std::pair{"wssrc-500m", 500.0}, {"wssrc-nautical-mile", 1852.0}}) {
        SCOPED_TRACE(name);
        const Profile profile = builtin(name);
        EXPECT_EQ(profile.window_kind, WindowKind::course);
        EXPECT_EQ(profile.distance_m, distance_m);
        EXPECT_EQ(profile.definition, SpeedDefinition::elapsed_time);
        EXPECT_EQ(profile.margin_kind, MarginKind::elapsed_time);
        EXPECT_EQ(profile.margin, 0.01);
        EXPECT_EQ(profile.margin_unit, "s");
        EXPECT_EQ(profile.current, CurrentUse::subtracted);
        EXPECT_FALSE(profile.accuracy_limit_m_s || profile.rounding);
        EXPECT_EQ(profile.result->mode, DecimalMode::nearest);
        EXPECT_EQ(rule_unit_name(profile), "kn");
        EXPECT_EQ(clause_of(profile, "current").decided_by, Computation::current);
        EXPECT_EQ(clause_of(profile, "current").limit, 1.0);
        EXPECT_EQ(clause_of(profile, "current").unit, "kn");
        EXPECT_EQ(clause_of(profile, "surveyed-course").decided_by, Computation::attest);
        EXPECT_EQ(clause_of(profile, "sail-area").decided_by, Computation::sail_area);
        for (const char* of_edition :
             {"hundredths-by-ratified-gear", "course-on-water", "commissioner",
              "timing-certificate", "video", "one-person", "human-power", "floats-at-rest",
              "no-wave-riding", "sail-area"})
            EXPECT_EQ(clause_of(profile, of_edition).edition, "2019") << of_edition;
        EXPECT_EQ(question_ids(profile),
                  (std::vector<std::string>{"accuracy", "rounding", "divisions"}));
    }
    EXPECT_EQ(clause_of(builtin("wssrc-500m"), "margin").certainty, Certainty::secondary);
    EXPECT_EQ(clause_of(builtin("wssrc-nautical-mile"), "margin").certainty,
              Certainty::unconfirmed);
}

TEST(BuiltinProfiles, SpeedSkydiving) {
    const Profile profile = builtin("fai-speed-skydiving");
    EXPECT_EQ(profile.duration_s, 3.0);
    EXPECT_TRUE(profile.exact_duration);
    EXPECT_EQ(profile.dimension, Dimension::vertical);
    EXPECT_EQ(profile.definition, SpeedDefinition::displacement);
    EXPECT_EQ(profile.ends, WindowEnds::epochs);
    EXPECT_EQ(profile.margin_kind, MarginKind::relative);
    EXPECT_EQ(profile.margin, 0.02);
    EXPECT_EQ(profile.margin_above, MarginBase::upper_limit);
    EXPECT_EQ(profile.rounding->mode, DecimalMode::truncate);
    EXPECT_EQ(profile.result->decimals, 2);
    EXPECT_EQ(clause_of(profile, "sampling-rate").limit, 5.0);
    EXPECT_EQ(clause_of(profile, "sampling-rate").unit, "Hz");
    EXPECT_EQ(clause_of(profile, "sample-accuracy").limit, 3.0);
    EXPECT_EQ(clause_of(profile, "sample-accuracy").unit, "m/s");
    EXPECT_EQ(profile.uncertainty.error_floor_m.at("single"), 0.5);
}

TEST(BuiltinProfiles, SpeedSkydivingOf2026) {
    const Profile score = builtin("fai-speed-skydiving-2026");
    EXPECT_EQ(builtin("fai-speed-skydiving").superseded_by, score.id);
    EXPECT_EQ(score.valid_from, "2026-03-01");
    EXPECT_EQ(builtin("fai-speed-skydiving").superseded_from, score.valid_from);
    ASSERT_TRUE(score.within);
    EXPECT_EQ(score.within->from.event, WindowEvent::exit);
    EXPECT_EQ(score.within->from.speed_m_s, 10.0);
    EXPECT_EQ(score.within->to.at(0).height_m, 2256.0);
    EXPECT_EQ(score.within->to.at(1).height_m, 1707.0);
    EXPECT_EQ(score.within->validation_m, 1006.0);
    EXPECT_EQ(score.margin, 0.0);
    EXPECT_EQ(score.rounding->mode, DecimalMode::nearest);
    EXPECT_EQ(score.rounding->decimals, 2);
    EXPECT_EQ(clause_of(score, "exit-at-most").limit, 4277.0);
    EXPECT_EQ(clause_of(score, "validation-window").limit, 3.0);
    const Profile record = builtin("fai-speed-skydiving-record");
    EXPECT_EQ(record.margin, 0.02);
    EXPECT_EQ(record.margin_above, MarginBase::upper_limit);
    EXPECT_EQ(record.rounding->decimals, 0);
    EXPECT_EQ(record.within->validation_m, score.within->validation_m);
}

/// The rules on ice are those on water.
void expect_same_rule(const Profile& one, const Profile& other) {
    EXPECT_EQ(one.window_kind, other.window_kind);
    EXPECT_EQ(one.duration_s + one.distance_m, other.duration_s + other.distance_m);
    EXPECT_EQ(one.definition, other.definition);
    EXPECT_EQ(one.windows, other.windows);
    EXPECT_EQ(one.alpha, other.alpha);
    EXPECT_EQ(one.speed_source, other.speed_source);
    EXPECT_EQ(one.margin, other.margin);
    ASSERT_EQ(one.clauses.size(), other.clauses.size());
    for (std::size_t i = 0; i < one.clauses.size(); ++i) {
        const Clause &a = one.clauses[i], &b = other.clauses[i];
        EXPECT_EQ(a.id, b.id);
        EXPECT_EQ(a.text, b.text);
        EXPECT_EQ(a.source, b.source);
        EXPECT_EQ(a.decided_by, b.decided_by);
        EXPECT_EQ(a.limit, b.limit);
    }
    EXPECT_EQ(question_ids(one), question_ids(other));
}

TEST(BuiltinProfiles, Evidence) {
    const Profile profile = builtin("evidence-general");
    EXPECT_TRUE(profile.evidence);
    EXPECT_EQ(clause_of(profile, "two-witnesses").answered_by,
              (Answerer{.role = "witness", .count = 2}));
    for (const Clause& clause : profile.clauses)
        EXPECT_EQ(clause.decided_by, Computation::attest);
}

TEST(BuiltinProfiles, GpsSpeedSailing) {
    const struct {
        const char *name, *kind, *definition;
        double length;  ///< s or m
        std::int64_t windows;
    } expected[] = {
        {"2s", "time", "mean_n", 2.0, 1},
        {"10s", "time", "mean_n", 10.0, 1},
        {"5x10s", "time", "mean_n", 10.0, 5},
        {"500m", "distance", "path_length", 500.0, 1},
        {"nautical-mile", "distance", "path_length", 1852.0, 1},
        {"1h", "time", "mean_n", 3600.0, 1},
        {"alpha-250", "alpha", "path_length", 250.0, 1},
        {"alpha-500", "alpha", "path_length", 500.0, 1},
    };
    for (const auto& each : expected) {
        SCOPED_TRACE(each.name);
        const Profile profile = builtin(std::string("gps-speed-sailing-") + each.name);
        const Profile on_ice = builtin(std::string("gps-ice-sailing-") + each.name);
        expect_same_rule(profile, on_ice);
        EXPECT_EQ(clause_of(profile, "acceleration").limit, 5.0);
        EXPECT_EQ(clause_of(profile, "satellites").decided_by, Computation::satellites);
        EXPECT_EQ(clause_of(profile, "distance-above-5-kn").unit, "kn");
        EXPECT_EQ(clause_of(profile, "error-deduction").decided_by, Computation::device_deduction);
        EXPECT_EQ(profile.alpha, profile.window_kind == WindowKind::alpha ? AlphaChoice::any
                                                                          : AlphaChoice::longest);
        EXPECT_EQ(to_text(profile.window_kind), each.kind);
        EXPECT_EQ(to_text(profile.definition), each.definition);
        EXPECT_EQ(profile.duration_s + profile.distance_m, each.length);
        EXPECT_EQ(profile.windows, each.windows);
        EXPECT_EQ(profile.speed_source, SpeedSource::velocity);
        EXPECT_EQ(profile.proximity_m, 50.0);
        EXPECT_EQ(profile.turn_deg, 90.0);
        EXPECT_EQ(profile.margin_kind, MarginKind::absolute);
        EXPECT_EQ(profile.margin, 0.0);
        EXPECT_EQ(clause_of(profile, "margin").certainty, Certainty::unconfirmed);
        EXPECT_EQ(rule_unit_name(profile), "km/h");
        EXPECT_FALSE(profile.accuracy_limit_m_s || profile.rounding);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
