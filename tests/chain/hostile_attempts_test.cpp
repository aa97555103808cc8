#include "hostile_support.h"

// Attempts and profiles that are wrong, odd or meant to harm.

namespace runcert::chain::RUNCERT_FILE {
namespace {

HostileCase attempt(const std::string& name, const std::string& text,
                    std::vector<std::string> said) {
    return {
        .name = name,
        .prepare = [text](const fs::path& folder) { write_plainly(folder / "attempt.yaml", text); },
        .said = std::move(said)};
}

HostileCase changed(const std::string& name, const std::string& what, const std::string& by,
                    std::vector<std::string> said) {
    return attempt(name, replaced(good_attempt, what, by), std::move(said));
}

/// A profile beside the attempt, which claims it.
HostileCase profile(const std::string& name, const std::string& text,
                    std::vector<std::string> said) {
    return {.name = name,
            .prepare =
                [text](const fs::path& folder) {
                    write_plainly(folder / "rule.yaml", text);
                    write_plainly(folder / "attempt.yaml",
                                  replaced(good_attempt, "[nalsa]", "[rule.yaml]"));
                },
            .said = std::move(said)};
}

/// Nine levels of aliases, nine to a level: 9^9 values.
std::string alias_bomb() {
    std::string text = "a: &a [x, x, x, x, x, x, x, x, x]\n";
    for (char level = 'b'; level <= 'i'; ++level)
        text += fmt::format("{0}: &{0} [{1}]\n", level,
                            repeated(fmt::format("*{}, ", static_cast<char>(level - 1)), 8) +
                                fmt::format("*{}", static_cast<char>(level - 1)));
    return text;
}

std::vector<HostileCase> cases() {
    const std::string brackets = repeated("[", 100'000) + repeated("]", 100'000);
    return {
        attempt("alias bomb", alias_bomb() + good_attempt, {"attempt.yaml:1:", "aliases"}),
        attempt("100 000 brackets", "id: " + brackets, {"attempt.yaml:1:", "nested"}),
        attempt("100 000 brackets that stay open", "id: " + repeated("[", 100'000),
                {"attempt.yaml:1:"}),
        attempt("100 000 braces", "schema: " + repeated("{a: ", 100'000),
                {"attempt.yaml:1:", "nested"}),
        attempt("100 000 list marks", repeated("- ", 100'000), {"attempt.yaml:1:", "nested"}),
        attempt("100 000 closing brackets", "schema: " + repeated("]", 100'000),
                {"attempt.yaml:1:"}),
        attempt("100 000 question marks", repeated("? ", 100'000), {"attempt.yaml:1:"}),
        attempt("a million keys", good_attempt + repeated("a: 1\n", 200'000),
                {"attempt.yaml:8:", "twice"}),
        attempt("a key of half a million letters", repeated("k", 500'000) + ": 1\n",
                {"attempt.yaml:1:", "YAML"}),
        attempt("half a MiB of list items", good_attempt + "place:\n" + repeated("- b\n", 1 << 17),
                {"attempt.yaml:8:", "place"}),
        attempt("half a MiB of brackets and braces", "id: " + repeated("[{", 1 << 18),
                {"attempt.yaml:1:"}),
        attempt("100 000 times the same file",
                replaced(good_attempt, "recording.pos", "[" + repeated("r, ", 100'000) + "r]"),
                {"attempt.yaml:5:"}),
        {.name = "1 GiB",
         .prepare =
             [](const fs::path& folder) {
                 write_plainly(folder / "attempt.yaml", std::string(1 << 20, 'a'), 1024);
             },
         .said = {"attempt.yaml", "longer than"}},
        {.name = "1 GiB of nothing",
         .prepare =
             [](const fs::path& folder) {
                 fs::resize_file(folder / "attempt.yaml", std::uintmax_t{1} << 30);
             },
         .said = {"attempt.yaml", "longer than"}},
        attempt("NUL bytes", good_attempt + std::string(10, '\0'), {"attempt.yaml", "zero"}),
        attempt("UTF-16", utf16(good_attempt), {"attempt.yaml", "UTF-16"}),
        changed("Latin-1", "name: yacht", "name: Z\xfcrich", {"attempt.yaml:3", "UTF-8"}),
        attempt("carriage returns alone", replaced(replaced(good_attempt, "\n", "\r"), "\n", "\r"),
                {"attempt.yaml:1"}),
        changed("a tab as indentation", "  - {id", "\t- {id", {"attempt.yaml:5:"}),
        changed("a key twice", "id: hostile\n", "id: hostile\nid: other\n",
                {"attempt.yaml:3:1", "twice"}),
        changed("an unknown key", "id: hostile\n", "id: hostile\nweather: 3\n",
                {"attempt.yaml:3:1", "weather"}),
        changed("an id with a slash", "id: hostile", "id: a/b", {"attempt.yaml:2:5", "a/b"}),
        changed("an id of dots", "id: hostile", "id: ..", {"attempt.yaml:2:5"}),
        changed("a receiver's id with a slash", "id: primary", "id: ../primary",
                {"attempt.yaml:5:"}),
        changed("a terminal's commands", "land-yacht", "\"\\e[2J\"", {"attempt.yaml:3:"}),
        changed("another document", "profiles: [nalsa]\n", "profiles: [nalsa]\n---\na: 1\n",
                {"attempt.yaml:7:", "document"}),
        changed("an attempt of the future", "attempt/1.0", "attempt/2.0", {"attempt.yaml:1:"}),
        changed("a tag", "id: hostile", "id: !!python/object:os.system x",
                {"attempt.yaml:2:", "tag"}),
        changed("no receivers", "  - {id: primary, recording: recording.pos}\n", "",
                {"attempt.yaml:", "receivers"}),
        attempt("another kind of document", "schema: profile/1.1\nid: a\n",
                {"attempt.yaml:1:", "attempt/1.0"}),
        attempt("a web page", "<!DOCTYPE html><html><body>", {"attempt.yaml"}),
        changed("1e400", "profiles", "record: {speed: 1e400, unit: km/h, source: s}\nprofiles",
                {"attempt.yaml:6:", "1e400"}),
        changed("0x10", "profiles", "record: {speed: 0x10, unit: km/h, source: s}\nprofiles",
                {"attempt.yaml:6:", "0x10"}),
        changed("1,5", "profiles", "record: {speed: \"1,5\", unit: km/h, source: s}\nprofiles",
                {"attempt.yaml:6:", "1,5"}),
        changed("nan", "profiles", "record: {speed: .nan, unit: km/h, source: s}\nprofiles",
                {"attempt.yaml:6:", "nan"}),
        changed("-inf", "profiles", "record: {speed: -.inf, unit: km/h, source: s}\nprofiles",
                {"attempt.yaml:6:", "-.inf"}),
        changed("a record of less than no speed", "profiles",
                "record: {speed: -1, unit: km/h, source: s}\nprofiles", {"attempt.yaml:6:"}),
        changed("month 13", "profiles", "date: 2022-13-01\nprofiles", {"attempt.yaml:6:"}),
        profile("a profile that is an alias bomb", alias_bomb(), {"rule.yaml:1:", "aliases"}),
        profile("a profile of 100 000 brackets", brackets, {"rule.yaml:1:", "nested"}),
        profile("an empty profile", "", {"rule.yaml", "empty"}),
        profile("a profile that is an attempt", good_attempt,
                {"rule.yaml:1:", "does not say that it follows profile/1.0"}),
        {.name = "a profile of 1 GiB",
         .prepare =
             [](const fs::path& folder) {
                 write_plainly(folder / "rule.yaml", "");
                 fs::resize_file(folder / "rule.yaml", std::uintmax_t{1} << 30);
                 write_plainly(folder / "attempt.yaml",
                               replaced(good_attempt, "[nalsa]", "[rule.yaml]"));
             },
         .said = {"rule.yaml", "longer than"}},
        changed("a profile outside", "[nalsa]", "[../rule.yaml]", {"../rule.yaml", "outside"}),
        changed("a profile by an absolute path", "[nalsa]", "[/etc/passwd]",
                {"/etc/passwd", "outside"}),
    };
}

TEST(Hostile, AttemptsAndProfiles) {
    for (const HostileCase& one : cases())
        expect_hostile_refused(one);
}

TEST(Hostile, EveryLineEndIsReadAlike) {
    for (const char* end : {"\n", "\r\n"}) {
        const TemporaryFolder folder;
        std::string text;
        for (const char c : good_attempt)
            text += c == '\n' ? std::string(end) : std::string{c};
        for (const bool whole : {true, false}) {
            write_plainly(folder.path() / "attempt.yaml",
                          whole ? text : text.substr(0, text.size() - std::string(end).size()));
            write_plainly(folder.path() / "recording.pos", good_recording(end));
            const ProcessResult run =
                certify(folder.path() / "attempt.yaml", folder.path() / "run", {"--no-render"});
            EXPECT_EQ(run.exit_status, 1) << run.errors;
        }
    }
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
