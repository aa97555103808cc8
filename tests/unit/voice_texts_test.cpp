#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "approved.h"

// What the program says, over the whole tree: sentences that are read once, and the field's terms.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

const fs::path root = RUNCERT_SOURCE_DIR;

struct Phrase {
    std::string where;  ///< file and line
    std::string text;
};

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// The files of these folders and files, but for what others wrote and for data.
std::vector<fs::path> files_of(const std::vector<std::string>& places) {
    static const std::set<std::string> kinds{".cpp", ".h",  ".yaml", ".html", ".md",
                                             ".txt", ".py", ".js",   ".sh"};
    std::vector<fs::path> files;
    for (const std::string& place : places) {
        if (fs::is_regular_file(root / place)) {
            files.push_back(root / place);
            continue;
        }
        for (const auto& entry : fs::recursive_directory_iterator(root / place)) {
            const std::string path = entry.path().generic_string();
            if (entry.is_regular_file() && kinds.contains(entry.path().extension().string()) &&
                path.find("/vendor/") == std::string::npos)
                files.push_back(entry.path());
        }
    }
    std::ranges::sort(files);
    return files;
}

std::string place(const fs::path& file, const std::string& text, std::size_t at) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(at);
    return fs::relative(file, root).generic_string() + ":" +
           std::to_string(1 + std::count(text.begin(), end, '\n'));
}

/// The texts in quotation marks of a source, adjacent ones joined; comments are none.
void add_literals(const fs::path& file, std::vector<Phrase>& phrases) {
    std::string text = text_of(file);
    bool quoted = false;
    for (std::size_t i = 0; i + 1 < text.size(); ++i) {
        if (text[i] == '\\') {
            ++i;
        } else if (text[i] == '\'' && !quoted && text[i + 1] == '"') {
            text[i + 1] = ' ';  // a character
        } else if (text[i] == '"') {
            quoted = !quoted;
        } else if (!quoted && text[i] == '/' && text[i + 1] == '/') {
            for (; i < text.size() && text[i] != '\n'; ++i)
                text[i] = ' ';
        }
    }
    static const std::regex literal("\"((?:[^\"\\\\\\n]|\\\\.)*)\"");
    std::size_t end = 0;
    for (std::sregex_iterator at(text.begin(), text.end(), literal), none; at != none; ++at) {
        const auto begin = static_cast<std::size_t>(at->position());
        const bool joined = !phrases.empty() && end != 0 &&
                            std::all_of(text.begin() + static_cast<std::ptrdiff_t>(end),
                                        text.begin() + static_cast<std::ptrdiff_t>(begin),
                                        [](char c) { return c == ' ' || c == '\n'; });
        if (joined)
            phrases.back().text += at->str(1);
        else
            phrases.push_back({place(file, text, begin), at->str(1)});
        end = begin + static_cast<std::size_t>(at->length());
    }
}

/// Every match of an expression's first group.
void add_matches(const fs::path& file, const std::string& text, const std::regex& expression,
                 std::vector<Phrase>& phrases) {
    for (std::sregex_iterator at(text.begin(), text.end(), expression), none; at != none; ++at)
        phrases.push_back(
            {place(file, text, static_cast<std::size_t>(at->position())), at->str(1)});
}

/// A page's paragraphs, list items and cells; commands and code are none.
void add_paragraphs(const fs::path& file, std::vector<Phrase>& phrases) {
    std::istringstream lines(text_of(file));
    std::string paragraph;
    std::size_t number = 0;
    bool code = false;
    const auto end = [&] {
        std::istringstream cells(paragraph);
        for (std::string cell; std::getline(cells, cell, '|');)
            phrases.push_back(
                {fs::relative(file, root).generic_string() + ":" + std::to_string(number), cell});
        paragraph.clear();
    };
    for (std::string line; std::getline(lines, line);) {
        ++number;
        const bool fence = line.starts_with("```");
        if (fence) code = !code;
        const bool begins = line.empty() || line[0] == '|' || line[0] == '-' || line[0] == '#' ||
                            line.starts_with("    ") || fence;
        if (begins) end();
        if (!code && !fence && !line.starts_with("    ")) paragraph += line + " ";
    }
    end();
}

std::vector<Phrase> all_phrases() {
    static const std::regex described(
        "(?:description|phrase|about|text|item|source): \"((?:[^\"\\\\]|\\\\.)*)\"");
    static const std::regex shown(">([^<>{}]*[^<>]*)<");
    std::vector<Phrase> phrases;
    for (const fs::path& file : files_of({"pipeline", "stages", "reports", "schemas", "examples",
                                          "README.md", "REFERENCES.md", "tests/README.md"})) {
        const std::string kind = file.extension().string();
        if (kind == ".cpp" || kind == ".h") add_literals(file, phrases);
        if (kind == ".yaml") add_matches(file, text_of(file), described, phrases);
        if (kind == ".html") add_matches(file, text_of(file), shown, phrases);
        if (kind == ".md") add_paragraphs(file, phrases);
    }
    return phrases;
}

/// Words between two marks of punctuation that end a thought: . ? ! ; : or a line.
std::size_t longest_sentence(const std::string& phrase) {
    static const std::regex code("`[^`]*`|\\$[^$]*\\$");
    std::istringstream words(
        std::regex_replace(std::regex_replace(phrase, code, "x"), std::regex("\\\\n"), " . "));
    std::size_t longest = 0;
    std::size_t count = 0;
    for (std::string word; words >> word;) {
        count += std::ranges::any_of(word, [](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '{';
        });
        longest = std::max(longest, count);
        if (std::string_view(".?!;:").find(word.back()) != std::string_view::npos) count = 0;
    }
    return longest;
}

TEST(Voice, SentencesAreReadOnce) {
    constexpr std::size_t most = 25;
    const std::vector<Phrase> phrases = all_phrases();
    EXPECT_GT(phrases.size(), 5000U);
    for (const Phrase& phrase : phrases)
        EXPECT_LE(longest_sentence(phrase.text), most) << phrase.where << ": " << phrase.text;
}

TEST(Voice, ALongSentenceIsFound) {
    std::string long_one;
    for (int i = 0; i < 26; ++i)
        long_one += "word ";
    EXPECT_EQ(longest_sentence(long_one), 26U);
    EXPECT_EQ(longest_sentence("One two: " + long_one + "and so on. Three."), 29U);
    EXPECT_EQ(longest_sentence("speed {} km/h ± {}; k = 2"), 4U);
}

// Terms that are not the field's (JCGM 200 and 100, ISO 19111, detection theory), and names that
// mislead. What keeps such a word: clause ids, words that attempts are written with.
TEST(Voice, TermsAreTheFields) {
    // In lower case, spaces for what is no word at their ends. Looked for one by one: a regular
    // expression of all takes twenty times as long.
    static const std::vector<std::string> not_used{"certified speed",
                                                   "speed to reach",
                                                   "to reach the target",
                                                   " u of it ",
                                                   " u of the speed ",
                                                   "least speed",
                                                   "left for a person",
                                                   "left to a person",
                                                   "for a person to attest",
                                                   "stated accurac",
                                                   " too good ",
                                                   " too bad ",
                                                   "slow error",
                                                   " learnt ",
                                                   "smallest error",
                                                   "could have missed",
                                                   "wrong position ",
                                                   "wrong positions ",
                                                   "wrong epoch ",
                                                   "wrong epochs ",
                                                   "kind of solution",
                                                   "kinds of solution",
                                                   "stretch without a break",
                                                   "stretches without a break",
                                                   "positions on the earth",
                                                   "local plane",
                                                   "heights above the ellipsoid",
                                                   "data do not tell",
                                                   "data cannot tell",
                                                   "made anew",
                                                   "no surer",
                                                   "_mps ",
                                                   "target_speed",
                                                   "target_m_s",
                                                   "target_km",
                                                   " learn_",
                                                   "told_by",
                                                   "detectableerror",
                                                   "workshop",
                                                   "raredecision",
                                                   "not_told",
                                                   "ask_witnesses",
                                                   "counted_axes",
                                                   "rowbyrow",
                                                   "timedrows",
                                                   "probability asked",
                                                   "probability is asked",
                                                   "probability needed",
                                                   "probability is needed",
                                                   "+/-"};
    const auto is_word = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
    };
    const auto stands_in = [&](const std::string& line, const std::string& phrase) {
        const bool begins = phrase.front() == ' ', ends = phrase.back() == ' ';
        const std::string words = phrase.substr(begins ? 1 : 0, phrase.size() - begins - ends);
        for (std::size_t at = line.find(words); at != std::string::npos;
             at = line.find(words, at + 1)) {
            const std::size_t end = at + words.size();
            if ((!begins || at == 0 || !is_word(line[at - 1])) &&
                (!ends || end == line.size() || !is_word(line[end])))
                return true;
        }
        return false;
    };
    EXPECT_TRUE(stands_in("what is too good.", " too good ") && stands_in("a_mps", "_mps "));
    EXPECT_FALSE(stands_in("too goodly", " too good ") || stands_in("stood good", " too good "));
    for (const fs::path& file : files_of({"pipeline", "stages", "reports", "schemas", "examples",
                                          "cmake", "README.md", "REFERENCES.md", "tests"})) {
        const std::string path = fs::relative(file, root).generic_string();
        if (path.starts_with("tests/fuzz/") || path == "tests/unit/voice_texts_test.cpp") continue;
        std::istringstream lines(text_of(file));
        std::size_t number = 0;
        for (std::string line; std::getline(lines, line);) {
            ++number;
            if (line.size() >= 2000) continue;
            std::ranges::transform(line, line.begin(),
                                   [](unsigned char c) { return std::tolower(c); });
            static const std::string key = "velocity_mps";  // which attempts are written with
            for (std::size_t at = line.find(key); at != std::string::npos; at = line.find(key))
                line.erase(at, key.size());
            for (const std::string& phrase : not_used)
                EXPECT_FALSE(stands_in(line, phrase)) << path << ":" << number << ": " << phrase;
        }
    }
}

// A recording is evidence: nobody is told to change it, only what is unreadable and what to hand
// in.
TEST(Voice, NoMessageAsksToChangeARecording) {
    static const std::regex asks(
        "(?:correct|edit|rewrite|repair|fix|cut|delete|remove|drop) (?:or take out "
        ")?(?:the|that|this|"
        "a) (?:line|row|point|record|file)|take (?:the|that|this|a) (?:line|row|point|record)s? "
        "out|"
        "take out (?:the|that|this|a) (?:line|row|point|record)|[,;] (?:or )?take it out|cut it|"
        "^take it out|^correct it|^close it|^write (?:it|them|dates|times|\\{)|cut the file",
        std::regex::icase | std::regex::optimize);
    std::vector<Phrase> phrases;
    std::vector<std::string> places{"stages/import", "stages/enu", "stages/screen",
                                    "pipeline/store/measured_series.cpp"};
    for (const fs::path& file : files_of(places))
        if (file.extension() == ".cpp" || file.extension() == ".h") add_literals(file, phrases);
    EXPECT_GT(phrases.size(), 1000U);
    for (const Phrase& phrase : phrases) {
        // What the attempt says is the official's own.
        if (phrase.text == "Write it as 2023-07-11: year, month, day") continue;
        EXPECT_FALSE(std::regex_search(phrase.text, asks)) << phrase.where << ": " << phrase.text;
    }
    for (const char* forbidden :
         {"Correct the line, or take it out", "Take the line out", "Take it out",
          "The line is damaged; take it out", "Correct or take out the line",
          "Cut it into several files", "Write {}: export it", "Close it, or take it out"})
        EXPECT_TRUE(std::regex_search(forbidden, asks)) << forbidden;
}

/// The arguments of a call whose opening parenthesis is at `at`, as they are written.
std::vector<std::string> arguments(const std::string& text, std::size_t at) {
    std::vector<std::string> all(1);
    int depth = 0;
    for (bool quoted = false; at < text.size(); ++at) {
        const char c = text[at];
        if (quoted || c == '"') {
            if (c == '"') quoted = !quoted;
            all.back() += c;
            if (c == '\\') all.back() += text[++at];
        } else if (std::string_view("([{").find(c) != std::string_view::npos) {
            if (++depth > 1) all.back() += c;
        } else if (std::string_view(")]}").find(c) != std::string_view::npos) {
            if (--depth == 0) return all;
            all.back() += c;
        } else if (c == ',' && depth == 1) {
            all.emplace_back();
        } else {
            all.back() += c;
        }
    }
    return all;
}

/// An argument on one line, adjacent texts joined; a text with its figures alone where it is one.
std::string written(std::string argument) {
    argument = std::regex_replace(argument, std::regex("\"\\s*\"|^\\s+|\\s+$"), "");
    argument = std::regex_replace(argument, std::regex("\\s+"), " ");
    static const std::regex text("^(?:fmt::format\\()?\"((?:[^\"\\\\]|\\\\.)*)\"(?:,.*\\))?$");
    std::smatch found;
    return std::regex_match(argument, found, text) ? found.str(1) : "(" + argument + ")";
}

// Every message of a failure says where, what and what to do; the page that a program prints makes
// sentences of the last two (core/text.h, `sentence`).
TEST(Voice, EveryFailureSaysWhereWhatAndWhatToDo) {
    static const std::regex call("\\bFailure\\(");
    static const std::regex comment("//[^\\n]*");
    std::string table;
    std::size_t count = 0;
    for (const fs::path& file : files_of({"pipeline", "stages", "reports", "schemas"})) {
        if (file.extension() != ".cpp") continue;
        const std::string text = std::regex_replace(text_of(file), comment, "");
        std::string rows;
        for (std::sregex_iterator at(text.begin(), text.end(), call), none; at != none; ++at) {
            const auto parts =
                arguments(text, static_cast<std::size_t>(at->position() + at->length()) - 1);
            if (parts.size() == 1) continue;  // a copy
            ++count;
            ASSERT_EQ(parts.size(), 3U) << file << ": " << parts[0];
            const std::string what = written(parts[1]);
            const std::string remedy = written(parts[2]);
            for (const std::string& part : parts)
                EXPECT_NE(written(part), "") << file << ": " << what;
            EXPECT_FALSE(what.ends_with('.')) << file << ": " << what;
            EXPECT_FALSE(remedy.ends_with('.')) << file << ": " << remedy;
            EXPECT_TRUE(std::isupper(static_cast<unsigned char>(remedy[0])) != 0 ||
                        std::string_view("({`").find(remedy[0]) != std::string_view::npos)
                << file << ": " << remedy;
            rows += "  where       " + written(parts[0]) + "\n  what        " + what +
                    "\n  what to do  " + remedy + "\n\n";
        }
        if (!rows.empty()) table += fs::relative(file, root).generic_string() + "\n" + rows;
    }
    EXPECT_GT(count, 300U);
    test::expect_approved("failures.txt", table);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
