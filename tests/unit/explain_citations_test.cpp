#include <gtest/gtest.h>

#include <algorithm>

#include "approved.h"
#include "reports/explain/explain.h"

// Where every clause of the rules that come with the program is known from.

namespace runcert::RUNCERT_FILE {
namespace {

std::vector<Profile> all_rules() {
    std::vector<Profile> rules;
    for (const std::string& name : builtin_profiles())
        rules.push_back(read_profile(builtin_profile(name), name + ".yaml"));
    return rules;
}

/// Texts that whoever wrote the rules down has read, or has read quoted. What is marked as quoted
/// is from one of them; all else is from a secondary source, or not confirmed.
const struct {
    std::string_view source;
    std::string_view edition;
} texts_read[] = {
    {"NALSA rules", "2009"},  // as [DHD22] quotes them
    {"FAI/ISC competition rules of speed skydiving", "1 March 2026"},
};

TEST(Citations, AreApprovedOneByOne) {
    test::ApprovedTexts texts("explain_citations.txt");
    texts.add("clauses of the rules, and where they are known from", citations_text(all_rules()));
}

TEST(Citations, WhatIsQuotedWasReadAndHasItsPlace) {
    const std::string method =
        test::text_of_file(std::filesystem::path(RUNCERT_SOURCE_DIR) / "reports/METHOD.md");
    const auto expect_place_in_method = [&](const Clause& clause) {
        constexpr std::string_view file = "METHOD.md, ";
        ASSERT_TRUE(clause.where.starts_with(file)) << clause.id << ": " << clause.where;
        EXPECT_NE(method.find("\n## " + clause.where.substr(file.size()) + "\n"), std::string::npos)
            << clause.where;
    };
    for (const Profile& rule : all_rules())
        for (const Clause& clause : rule.clauses) {
            SCOPED_TRACE(rule.id + "/" + clause.id);
            if (clause.certainty != Certainty::quoted) continue;
            EXPECT_FALSE(clause.where.empty());
            if (clause.source == own_source) {
                expect_place_in_method(clause);
                continue;
            }
            EXPECT_TRUE(std::ranges::any_of(texts_read, [&](const auto& read) {
                return clause.source == read.source && clause.edition == read.edition;
            })) << clause.source;
        }
    for (const Clause& own : own_clauses()) {
        EXPECT_EQ(own.source, own_source) << own.id;
        EXPECT_EQ(own.certainty, Certainty::quoted) << own.id;
        expect_place_in_method(own);
    }
}

TEST(Citations, EveryRuleSaysUntilWhenItsTextsWereLookedAt) {
    for (const Profile& rule : all_rules())
        EXPECT_GE(rule.looked_at, "2026-11-27") << rule.id;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
