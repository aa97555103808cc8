// The fast parser of YAML against the one that has the last word: what it reads, both read alike.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/failure.h"
#include "core/random.h"
#include "files/atomic_file.h"
#include "files/yaml_input.h"
#include "files/yaml_parsers.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// A node with all below it, with places and quotes, in words.
std::string description(const YamlNode& node) {
    std::string text = std::to_string(node.mark().line) + ":" + std::to_string(node.mark().column);
    if (node.is_null()) return text + " null";
    if (node.is_scalar())
        return text + (node.is_quoted() ? " quoted '" : " plain '") + std::string(node.scalar()) +
               "'";
    text += node.is_map() ? " {" : " [";
    for (std::size_t i = 0; i < node.size(); ++i) {
        if (node.is_map()) text += description(node.key(i)) + " = ";
        text += description(node.is_map() ? node.value(i) : node.item(i)) + ", ";
    }
    return text + (node.is_map() ? "}" : "]");
}

/// What parse_yaml gives by either parser, or the failure.
std::string by_any(const std::string& text) {
    try {
        return description(parse_any_yaml(text, "f"));
    } catch (const Failure& failure) {
        return failure.where() + ": " + failure.problem();
    }
}

struct Outcome {
    std::size_t read = 0;  ///< texts that the fast parser read
    std::vector<std::string> different;
};

void compare(const std::string& text, Outcome& outcome) {
    const std::optional<YamlNode> common = parse_common_yaml(text);
    if (!common) return;
    ++outcome.read;
    const std::string any = by_any(text);
    if (description(*common) != any)
        outcome.different.push_back(text + "\n--- fast: " + description(*common) +
                                    "\n--- other: " + any);
}

std::vector<std::string> documents_of_the_tree() {
    std::vector<std::string> texts;
    for (const char* folder : {"schemas", "stages/check/profiles", "examples", "reports"})
        for (const auto& entry :
             fs::recursive_directory_iterator(fs::path(RUNCERT_SOURCE_DIR) / folder))
            if (entry.path().extension() == ".yaml") texts.push_back(read_file(entry.path()));
    return texts;
}

TEST(YamlParsers, TheFastOneReadsWhatTheProjectWrites) {
    const std::vector<std::string> texts = documents_of_the_tree();
    ASSERT_GT(texts.size(), 30U);
    Outcome outcome;
    for (const std::string& text : texts)
        compare(text, outcome);
    EXPECT_GT(outcome.read, texts.size() * 9 / 10);
    for (const std::string& difference : outcome.different)
        ADD_FAILURE() << difference;
}

TEST(YamlParsers, TheFastOneLeavesWhatItMayReadOtherwise) {
    for (const char* text : {"a:\tb\n",
                             "a: |\n  x\n",
                             "a: >\n  x\n",
                             "a: x\n  y\n",
                             "a: \"x\n  y\"\n",
                             "a:\n",
                             "- \n",
                             "a: &x 1\n",
                             "a: !!seq [1]\n",
                             "! a: b\n",
                             "%YAML 1.2\n---\na: 1\n",
                             "a: 1\n---\nb: 2\n",
                             "[a: 1]\n",
                             "{a, b}\n",
                             "a: 1\na: 2\n",
                             "~: 1\n",
                             "? [a]\n: 1\n",
                             "null\n",
                             "",
                             "a: [1\n"})
        EXPECT_FALSE(parse_common_yaml(text)) << text;
}

/// Small documents with what the two could see differently, and documents of the tree cut down.
std::vector<std::string> seeds() {
    std::vector<std::string> texts{
        "a: 1\nb: [x, 'y', \"z\"]\nc: {d: ~, e: null, 'f': \"\\u00b5\\n\"}\n# end\n",
        "- a: 1\n  b: 2\n-   - x\n    - y: z # comment\n- []\n- {}\n",
        "k:\n- 1\n- 2\nl:\n  m:\n    n: \"a: b, c\"\no: a-b:c d#e\n",
        "\xc3\xa9t\xc3\xa9: [\"\xe5\x90\x8d\", b]\nx: \xe2\x82\xac {y: 1}\r\nz: 'it''s'\r\n",
        "{\"a\": 1, \"b\": {\"c\": [1, 2.5, true, null, \"x\"]}}\n",
        "---\na: b\n...\n",
        "? a\n: b\n",
        "a: 'x' \nb : c\n'd' : e\n",
        "t: 2026-03-14T10:00:00\nu: km/h\nv: -1\nw: - x\n",
        "[a, [b, {c: d}], e]\n"};
    for (const std::string& text : documents_of_the_tree()) {
        const std::size_t middle = text.find('\n', text.size() / 2) + 1;
        texts.push_back(text.substr(0, text.find('\n', 300) + 1));
        texts.push_back(text.substr(middle, text.find('\n', middle + 200) + 1 - middle));
    }
    return texts;
}

std::string changed(std::string text, RandomGenerator& random) {
    const std::vector<std::string> pieces{
        ":", ": ", "- ",   "-",   ",",       "[",       "]",    "{",        "}",
        "#", " #", "'",    "\"",  "\\",      "\n",      "\n  ", " ",        "  ",
        "?", "? ", "!",    "&",   "*",       "%",       "@",    "`",        "|",
        ">", "~",  "null", "...", "\n---\n", "\n...\n", "\r\n", "\xc3\xa9", "a",
        "0", "=",  "<<",   ".",   "\\x41",   "\\u263a", "\\/",  "\\ "};
    const auto below = [&](std::size_t count) {
        return static_cast<std::size_t>(random.uniform() * static_cast<double>(count));
    };
    const std::size_t changes = 1 + below(4);
    for (std::size_t i = 0; i < changes && !text.empty(); ++i) {
        const std::size_t at = below(text.size());
        switch (below(3)) {
            case 0:
                text.erase(at, 1 + below(3));
                break;
            case 1:
                text.insert(at, pieces[below(pieces.size())]);
                break;
            default:
                text.replace(at, 1, pieces[below(pieces.size())]);
        }
    }
    return text;
}

TEST(YamlParsers, BothReadAThousandChangedDocumentsAlike) {
    const std::vector<std::string> texts = seeds();
    RandomGenerator random(20261122);
    Outcome outcome;
    const char* more = std::getenv("RUNCERT_TEST_TEXTS");
    const int count = more ? std::atoi(more) : 20'000;
    for (int i = 0; i < count; ++i) {
        const std::string text = changed(
            texts[static_cast<std::size_t>(random.uniform() * static_cast<double>(texts.size()))],
            random);
        // What parse_yaml refuses before either sees it.
        bool is_sound = true;
        try {
            (void)parse_yaml(text, "f");
        } catch (const Failure& failure) {
            is_sound = failure.problem().find("control characters") == std::string::npos;
        }
        if (is_sound) compare(text, outcome);
    }
    EXPECT_GT(outcome.read, static_cast<std::size_t>(count) / 10);
    for (std::size_t i = 0; i < std::min<std::size_t>(10, outcome.different.size()); ++i)
        ADD_FAILURE() << outcome.different[i];
    EXPECT_EQ(outcome.different.size(), 0U);
}

}  // namespace
}  // namespace runcert
