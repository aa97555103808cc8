#include <glob.h>

#include "core/random.h"
#include "make_day_support.h"
#include "store/pattern.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using test::DayTest;

struct FilePattern : DayTest {};

std::vector<std::string> files_of(const std::vector<PatternMatch>& matches) {
    std::vector<std::string> files;
    for (const PatternMatch& match : matches)
        files.push_back(match.file);
    return files;
}

/// The regular files that glob(3) of the C library finds.
std::vector<std::string> by_glob(const fs::path& folder, const std::string& pattern) {
    glob_t found{};
    const std::string prefix = folder.string() + "/";
    std::vector<std::string> files;
    if (glob((prefix + pattern).c_str(), GLOB_NOESCAPE | GLOB_NOSORT, nullptr, &found) == 0)
        for (std::size_t i = 0; i < found.gl_pathc; ++i)
            if (fs::is_regular_file(found.gl_pathv[i]))
                files.emplace_back(found.gl_pathv[i] + prefix.size());
    globfree(&found);
    std::sort(files.begin(), files.end());
    return files;
}

TEST_F(FilePattern, FindsWhatGlobOfTheCLibraryFinds) {
    RandomGenerator random(8);
    const auto word = [&random](std::string_view letters, std::size_t longest) {
        std::string text;
        for (std::size_t n = 1 + random.next() % longest; n > 0; --n)
            text += letters[random.next() % letters.size()];
        return text;
    };
    for (int i = 0; i < 300; ++i) {
        std::string name = word("ab. ", 5);
        if (name == "." || name == "..") continue;
        const std::string inside = random.next() % 2 == 0 ? "" : word("ab", 2) + ".d/";
        put(inside + name);
    }
    std::size_t found = 0;
    for (int i = 0; i < 2000; ++i) {
        std::string pattern = word("ab. **?", 5);
        if (random.next() % 2 == 0) pattern = word("ab*?", 3) + ".d/" + pattern;
        if (!is_pattern(pattern) || pattern.find("..") != std::string::npos) continue;
        const auto matches = matching_files(day(), pattern);
        ASSERT_EQ(files_of(matches), by_glob(day(), pattern)) << pattern;
        for (const PatternMatch& match : matches) {
            EXPECT_EQ(match.stood_for.size(), wildcard_count(pattern));
            EXPECT_EQ(filled_in(pattern, match.stood_for), match.file) << pattern;
        }
        found += matches.size();
    }
    EXPECT_GT(found, 1000U);
}

TEST_F(FilePattern, WhatAWildcardStandsFor) {
    put("left/heat-07.pos");
    const auto stood_for = [&](const char* pattern) {
        const auto matches = matching_files(day(), pattern);
        return matches.empty() ? std::vector<std::string>{"none"} : matches[0].stood_for;
    };
    using Texts = std::vector<std::string>;
    EXPECT_EQ(stood_for("left/*.pos"), Texts{"heat-07"});
    EXPECT_EQ(stood_for("left/heat-??.pos"), Texts{"07"});
    EXPECT_EQ(stood_for("left/heat-*.pos"), Texts{"07"});
    EXPECT_EQ(stood_for("*/heat-?*.pos"), (Texts{"left", "07"}));
    EXPECT_EQ(stood_for("l*t/*-*.*"), (Texts{"ef", "heat", "07", "pos"}));
    EXPECT_EQ(stood_for("left/heat-07.pos*"), Texts{""});
    EXPECT_EQ(stood_for("left/heat-???.pos"), Texts{"none"});
    EXPECT_EQ(stood_for("left"), Texts{"none"});
    EXPECT_EQ(stood_for("right/*.pos"), Texts{"none"});
    EXPECT_EQ(stood_for("left/heat-07.pos/*"), Texts{"none"});
}

/// Tried out one by one, thirty wildcards in a name of 200 characters would take for ever.
TEST_F(FilePattern, ManyWildcardsTakeNoLonger) {
    put(std::string(200, 'a'));
    std::string pattern;
    for (int i = 0; i < 30; ++i)
        pattern += "*a";
    EXPECT_EQ(matching_files(day(), pattern + "b").size(), 0U);
    EXPECT_EQ(matching_files(day(), pattern).size(), 1U);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
