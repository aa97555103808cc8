#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "core/random.h"
#include "make_day_support.h"

// A folder as a day: which attempts are found in it, and what is said of the rest.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using test::DayTest;
using test::Ids;
using test::ids_of;
using test::notes_say;
using test::said_of;

struct AttemptFolder : DayTest {};

TEST_F(AttemptFolder, AttemptsAtAnyDepthInTheOrderOfTheirPaths) {
    put_attempt("b.yaml", "second");
    put_attempt("a/z/attempt.yaml", "first");
    put_attempt("c/run.YML", "fourth");
    put_attempt("b/attempt.yaml", "third");
    put("a/r.pos");
    put("a/spec.yaml", "schema: simulation/1.0\n");
    put("a/notes.yml", "- [not closed\n");
    put("a/attempt.txt", "schema: attempt/1.0\nid: no\n");
    const Day day = read();
    // As bytes: '.' comes before '/'.
    EXPECT_EQ(ids_of(day), (Ids{"first", "second", "third", "fourth"}));
    EXPECT_EQ(day.attempts[0].source, "a/z/attempt.yaml");
    EXPECT_EQ(day.attempts[0].file, this->day() / "a/z/attempt.yaml");
    EXPECT_EQ(day.attempts[0].folder, this->day() / "a/z");
    EXPECT_EQ(day.attempts[0].text, test::slurp(day.attempts[0].file));
    EXPECT_EQ(day.name, "day");
    EXPECT_TRUE(day.notes.empty());
}

TEST_F(AttemptFolder, AnAttemptSaysSoInAnyYamlOfItsSchema) {
    put("a.yaml", "\xef\xbb\xbfschema: attempt/1.0\r\nid: bom   # remark\r\n");
    put("b.yaml", "\"schema\": \"attempt/1.0\"\nid: 'quoted'\n");
    put("c.yaml",
        "{schema: attempt/1.0, id: flow, craft: {name: b, class: car}, receivers: [{id: p, "
        "recording: r}], profiles: [nalsa]}\n");
    put("d.yaml",
        "schema: attempt/1.0\nid: \"es\\x63aped\"\ncraft: {name: b, class: car}\nreceivers: [{id: "
        "p, recording: r}]\nprofiles: [nalsa]\n");
    put("e.yaml", "note: 'about schema: attempt/1.0'\nschema: other/1.0\n");
    put("f.yaml", "# schema: attempt/1.0\n- schema: attempt/1.0\n");
    const Day day = read();
    EXPECT_EQ(ids_of(day), (Ids{"bom", "quoted", "flow", "escaped"}));
}

TEST_F(AttemptFolder, ABrokenAttemptIsRefusedAndTheOthersListed) {
    put_attempt("a/attempt.yaml", "good");
    put("b c/attempt.yaml", "schema: attempt/1.0\nid: [\n");
    put("d/attempt.yaml", "nothing of the kind\n");
    put_attempt("e/run.yaml", "not an id");
    put("f/attempt.yaml", std::string((1U << 20U) + 1, '#'));
    fs::create_symlink("nowhere", day() / "g.yaml");
    fs::create_directory(day() / "h");
    fs::create_symlink("nowhere", day() / "h/attempt.yaml");
    const Day day = read();
    EXPECT_EQ(ids_of(day),
              (Ids{"good", "!b-c-attempt", "!d-attempt", "!e-run", "!f-attempt", "!h-attempt"}));
    EXPECT_NE(said_of(day.attempts[1]).find("b c/attempt.yaml:"), std::string::npos);
    EXPECT_NE(said_of(day.attempts[3]).find("cannot be an id"), std::string::npos)
        << said_of(day.attempts[3]);
    EXPECT_TRUE(notes_say(day, "g.yaml"));
}

TEST_F(AttemptFolder, PassesOverHiddenFilesRunFoldersAndTheResults) {
    put_attempt("a.yaml", "a");
    put_attempt(".hidden/attempt.yaml", "no");
    put_attempt("._a.yaml", "no");
    for (const char* run : {"runs/one", "runs/two"}) {
        put_attempt(std::string(run) + "/attempt.yaml", "no");
        put(std::string(run) + "/1-observations.ecsv");
        put_attempt(std::string(run) + "/deeper/attempt.yaml", "no");
    }
    put_attempt("results/late/attempt.yaml", "no");
    const Day day = read_day({this->day()}, this->day() / "results");
    EXPECT_EQ(ids_of(day), Ids{"a"});
    EXPECT_EQ(day.notes.size(), 2U);
    EXPECT_TRUE(notes_say(day, "\"results\" of the results was not searched"));
    EXPECT_TRUE(notes_say(day, "2 run folders"));
    // By another name the results are found too.
    fs::create_directory_symlink(this->day(), out());
    EXPECT_EQ(ids_of(read_day({this->day()}, out() / "results")), Ids{"a"});
    const auto said = test::failure_of([&] { (void)read_day({this->day()}, out()); });
    EXPECT_TRUE(said.contains("the results' folder is the day's own")) << said.problem;
}

TEST_F(AttemptFolder, LinksAreFollowedAndLoopsSaid) {
    put_attempt("real/attempt.yaml", "one");
    fs::create_directory_symlink("..", day() / "real/up");
    fs::create_directory_symlink("real", day() / "again");
    put_attempt("../elsewhere/attempt.yaml", "two");
    fs::create_directory_symlink("../elsewhere", day() / "link");
    fs::create_directory_symlink("link", day() / "../elsewhere/itself");
    fs::create_directory_symlink("myself", day() / "myself");  // leads nowhere
    const Day day = read();
    EXPECT_EQ(ids_of(day), (Ids{"two", "one"}));
    EXPECT_EQ(day.attempts[0].source, "link/attempt.yaml");
    EXPECT_EQ(day.attempts[1].source, "real/attempt.yaml");
    EXPECT_TRUE(notes_say(day, "\"again\" leads to \"real\""));
    EXPECT_TRUE(notes_say(day, "\"real/up\" leads to \".\""));
}

TEST_F(AttemptFolder, AFolderThatCannotBeReadIsSaid) {
    if (geteuid() == 0) GTEST_SKIP() << "root can read every folder";
    put_attempt("a/attempt.yaml", "a");
    put_attempt("locked/attempt.yaml", "b");
    put_attempt("secret.yaml", "c");
    fs::permissions(day() / "locked", fs::perms::none);
    fs::permissions(day() / "secret.yaml", fs::perms::none);
    const Day day = read();
    fs::permissions(this->day() / "locked", fs::perms::owner_all);
    EXPECT_EQ(ids_of(day), Ids{"a"});
    EXPECT_TRUE(notes_say(day, "\"locked\" cannot be read"));
    EXPECT_TRUE(notes_say(day, "\"secret.yaml\" may be an attempt and cannot be read"));
}

TEST_F(AttemptFolder, NamesOfAnyKind) {
    const std::vector<std::string> names{"a b",
                                         "a'b",
                                         "a\"b",
                                         "a\nb",
                                         "\xc3\x89mile",
                                         "\xff\xfe!",
                                         "-dash",
                                         "$(x)",
                                         "a\\b",
                                         "\xe2\x80\xae"
                                         "exe",
                                         "*?",
                                         "a: b #",
                                         "[a]",
                                         "\x1b[2J"};
    for (std::size_t i = 0; i < names.size(); ++i)
        put_attempt(names[i] + "/attempt.yaml", fmt::format("id-{}", i));
    const Day day = read();
    ASSERT_EQ(day.attempts.size(), names.size());
    for (const GivenAttempt& attempt : day.attempts) {
        EXPECT_EQ(said_of(attempt), "");
        const std::size_t i = std::stoul(attempt.id.substr(3));
        EXPECT_EQ(attempt.folder, this->day() / names.at(i));
        EXPECT_EQ(test::slurp(attempt.file), attempt.text);
        for (const char c : attempt.source)
            EXPECT_FALSE(static_cast<unsigned char>(c) < ' ') << attempt.id;
    }
}

/// What a folder lists first depends on the file system and on the order of making.
TEST_F(AttemptFolder, TheOrderOfMakingDoesNotMatter) {
    RandomGenerator random(4);
    std::vector<int> order(60);
    for (int i = 0; i < 60; ++i)
        order[static_cast<std::size_t>(i)] = i;
    std::vector<std::string> listed[2];
    for (auto& list : listed) {
        for (std::size_t i = order.size(); i > 1; --i)
            std::swap(order[i - 1], order[random.next() % i]);
        fs::remove_all(day());
        for (const int i : order) {
            const std::string n = std::to_string(i);
            put_attempt(n + "/attempt.yaml", "id-" + n);
            if (i % 7 == 0) fs::create_directory_symlink(n, day() / ("link-" + n));
        }
        const Day day = read();
        for (const GivenAttempt& attempt : day.attempts)
            list.push_back(attempt.source + attempt.text);
        list.insert(list.end(), day.notes.begin(), day.notes.end());
    }
    EXPECT_EQ(listed[0].size(), 69U);
    EXPECT_EQ(listed[0], listed[1]);
}

TEST_F(AttemptFolder, ADayFileInItIsTheDay) {
    put_attempt("other.yaml", "other");
    put("r.pos");
    put_day("  - {recording: r.pos}\n");
    EXPECT_EQ(ids_of(read()), Ids{"r"});
    EXPECT_TRUE(notes_say(read(), "not searched"));
    // One of another schema is none; one that cannot be read is no reason to take another day.
    put("day.yaml", "schema: results/1.0\n");
    EXPECT_EQ(ids_of(read()), Ids{"other"});
    put("day.yaml", "attempts: [\n");
    EXPECT_TRUE(test::failure_of([&] { (void)read(); }).contains("day.yaml:"));
    // Further down it is not this day.
    fs::remove(day() / "day.yaml");
    put("deeper/day.yaml", "schema: day/1.0\nattempts: [{recording: a}]\n");
    EXPECT_EQ(ids_of(read()), Ids{"other"});
    EXPECT_TRUE(notes_say(read(), "\"deeper/day.yaml\" is a day of its own"));
}

TEST_F(AttemptFolder, NoAttemptIsAFailureThatSaysWhatWasLookedFor) {
    put("a/r.pos");
    put_attempt("run/attempt.yaml", "no");
    put("run/1-observations.ecsv");
    const auto said = test::failure_of([&] { (void)read(); });
    EXPECT_TRUE(said.contains("no attempt was found")) << said.problem;
    EXPECT_TRUE(said.contains("*.yaml"));
    EXPECT_TRUE(said.contains("1 run folder"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
