// Days that are wrong, in part or as a whole: what is wrong is said, and the good runs are made.
#include "batch_bad_days.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

struct BrokenAttempt {
    const char* id;
    std::string text;
    const char* words;  ///< of what is said of it
};

TEST_F(BadDays, BrokenAttemptsInTheMiddleDoNotStopTheOthers) {
    write("noise.pos", std::string("\x7f\x01 no positions \n here\n", 22));
    write("empty.pos", "");
    fs::create_directory(day() / "folder.pos");
    fs::create_symlink("loop.pos", day() / "loop.pos");
    const std::vector<BrokenAttempt> broken{
        {"b-yaml", "schema: attempt/1.0\nid: b-yaml\ncraft: [}\n", "b-yaml.yaml:3"},
        {"b-key", attempt("b-key") + "profils: [nalsa]\n", "profils"},
        {"b-class", "schema: attempt/1.0\nid: b-class\ncraft: {name: x, class: tank}\n", "tank"},
        {"b-missing", attempt("b-missing", "nowhere.pos"), "\"nowhere.pos\""},
        {"b-outside", attempt("b-outside", "../made/recordings/0001.pos"), "outside"},
        {"b-noise", attempt("b-noise", "noise.pos"), "noise.pos"},
        {"b-empty", attempt("b-empty", "empty.pos"), "empty.pos"},
        {"b-folder", attempt("b-folder", "folder.pos"), "folder.pos"},
        {"b-loop", attempt("b-loop", "loop.pos"), "loop.pos"},
        {"b-profile",
         attempt("b-profile") + "rules: [{profile: fisly, figure: margin.value, "
                                "value: 1}]\n",
         "fisly"}};
    write("a-good.yaml", attempt("a-good"));
    for (const BrokenAttempt& one : broken)
        write(fmt::format("{}.yaml", one.id), one.text);
    write("z-good.yaml", attempt("z-good"));
    const BatchSaid said = run();
    EXPECT_EQ(said.exit_status, 2);
    EXPECT_EQ(said.states.size(), broken.size() + 2);
    for (const char* good : {"a-good", "z-good"}) {
        EXPECT_EQ(said.states.at(good), "done") << said.problems.at(good);
        EXPECT_TRUE(fs::exists(out() / good / "report.json"));
    }
    const std::string results = read_file(out() / "day.yaml");
    for (const BrokenAttempt& one : broken) {
        ASSERT_TRUE(said.states.contains(one.id)) << one.id << said.text;
        EXPECT_EQ(said.states.at(one.id), "failed") << one.id;
        const std::string& problem = said.problems.at(one.id);
        EXPECT_TRUE(holds(problem, one.words)) << one.id << ": " << problem;
        EXPECT_TRUE(holds(problem, "what to do: ")) << problem;
        EXPECT_FALSE(holds(problem, ".runcert/work")) << problem;
        EXPECT_FALSE(fs::exists(out() / one.id / "report.json")) << one.id;
        EXPECT_TRUE(holds(results, one.id)) << one.id;
    }
    // What is mended is made, and nothing else.
    write("b-noise.yaml", attempt("b-noise"));
    const BatchSaid later = run();
    EXPECT_EQ(later.states.at("b-noise"), "done");
    EXPECT_EQ(later.steps_of("a-good"), "");
}

TEST_F(BadDays, OneIdForTwoAttemptsRefusesBoth) {
    write("a.yaml", attempt("same"));
    write("b.yaml", attempt("same"));
    write("c.yaml", attempt("other"));
    const BatchSaid said = run();
    EXPECT_EQ(said.exit_status, 2);
    EXPECT_EQ(said.states.at("other"), "done");
    EXPECT_EQ(said.states.at("same"), "failed");
    EXPECT_TRUE(holds(said.problems.at("same"), "a.yaml")) << said.problems.at("same");
    EXPECT_FALSE(fs::exists(out() / "same"));
}

TEST_F(BadDays, NamesMayHoldAnything) {
    const std::vector<std::string> names{"with space", "quo\"te'",   "new\nline", "\xc3\xbcml",
                                         "\xff\xfe",   "$(touch x)", "\x1b[31m",  "-dash"};
    const std::string hidden = "\x1b[31m";  // a text that no attempt may hold
    for (std::size_t i = 0; i < names.size(); ++i) {
        const bool utf8 = names[i] != "\xff\xfe" && names[i] != hidden;
        const std::string named = utf8 ? names[i] + ".pos" : "run.pos";
        if (utf8) fs::copy_file(recording(), day() / named);
        write(names[i] + ".yaml", attempt(fmt::format("id-{}", i), named));
    }
    const BatchSaid said = run();
    EXPECT_EQ(said.exit_status, 0) << said.errors << said.text;
    EXPECT_EQ(said.states.size(), names.size());
    EXPECT_EQ(run().steps_run, 0);
    const ProcessResult plain =
        runcert({"batch", day().string(), "--out", out().string(), "--no-render", "--explain"});
    EXPECT_EQ(plain.exit_status, 0);
    EXPECT_FALSE(holds(plain.output, "\x1b")) << plain.output;
    EXPECT_FALSE(fs::exists(day() / "x"));
    for (const char* file : {"day.yaml", "day.csv", "day.html"})
        EXPECT_FALSE(holds(read_file(out() / file), "\x1b")) << file;
}

TEST_F(BadDays, ResultsInsideOfTheDayAreNotPartOfIt) {
    write("a.yaml", attempt("a"));
    const fs::path inside = day() / "results";
    for (const int steps : {8, 0}) {
        const BatchSaid said = batch_json(day(), inside, {"--no-render"});
        EXPECT_EQ(said.exit_status, 0) << said.errors;
        EXPECT_EQ(said.steps_run, steps);
        EXPECT_EQ(said.states.size(), 1u) << said.text;
    }
    EXPECT_TRUE(holds(refusal({day().string(), "--out", day().string()}), "--out"));
    // Results are no day: their runs are not certified again.
    const std::string words = refusal({inside.string(), "--out", out().string()});
    EXPECT_TRUE(holds(words, "No attempt was found") || holds(words, "day_results")) << words;
}

TEST_F(BadDays, AFolderThatCannotBeWrittenIsNamed) {
    write("a.yaml", attempt("a"));
    write_file_atomically(path("file"), "a file\n");
    EXPECT_TRUE(holds(refusal({day().string(), "--out", path("file").string()}), "file"));
    EXPECT_EQ(read_file(path("file")), "a file\n");
    const fs::path locked = path("locked");
    fs::create_directories(locked);
    const ProcessResult result =
        run_process({"unshare", "-m", "sh", "-c",
                     "mount --bind \"$1\" \"$1\" && mount -o remount,ro,bind \"$1\" || exit 77; "
                     "exec \"$2\" batch \"$3\" --out \"$1/out\" --no-render",
                     "sh", locked.string(), RUNCERT_PROGRAMS "/runcert", day().string()});
    if (result.exit_status == 77 || holds(result.errors, "unshare"))
        GTEST_SKIP() << "a read-only folder cannot be made here: " << result.errors;
    EXPECT_EQ(result.exit_status, 2) << result.output;
    EXPECT_TRUE(holds(result.errors, locked.string())) << result.errors;
    EXPECT_TRUE(holds(result.errors, "Read-only file system")) << result.errors;
}

TEST_F(BadDays, LoopsOfLinksEnd) {
    write("a.yaml", attempt("a"));
    fs::create_directories(day() / "sub");
    fs::create_directory_symlink("..", day() / "sub/up");
    fs::create_directory_symlink("self", day() / "self");
    const BatchSaid said = run();
    EXPECT_EQ(said.states.size(), 1u) << said.text;
    EXPECT_EQ(said.states.at("a"), "done");
    EXPECT_TRUE(holds(said.notes, "searched already")) << said.notes;
}

TEST_F(BadDays, NoDayIsSaid) {
    EXPECT_TRUE(holds(refusal({day().string(), "--out", out().string()}), "No attempt was found"));
    EXPECT_TRUE(holds(refusal({path("nowhere").string(), "--out", out().string()}), "nowhere"));
    EXPECT_FALSE(fs::exists(out()));
}

TEST_F(BadDays, AHostileDayFileIsRefused) {
    std::string bomb = "schema: day/1.0\na0: &a0 [x, x]\n";
    for (int i = 1; i < 40; ++i)
        bomb += fmt::format("a{0}: &a{0} [*a{1}, *a{1}]\n", i, i - 1);
    const std::vector<std::string> texts{
        bomb,
        "schema: day/1.0\nattempts: " + std::string(100000, '[') + "\n",
        std::string("schema: day/1.0\nattempts: [\0]\n", 30),
        "schema: day/1.0\nattempts: [{recording: /etc/passwd}]\n",
        "schema: day/1.0\nattempts: [{recording: \"../*\"}]\n",
        "schema: day/1.0\nattempts: []\n",
        "schema: day/1.0\nattempts: {a: &x {b: *x}}\n",
        "schema: day/9.0\nattempts: [{recording: run.pos}]\n",
        "schema: day/1.0\nschema: day/1.0\nattempts: [{recording: run.pos}]\n"};
    for (const std::string& text : texts) {
        write("day.yaml", text);
        const ProcessResult result =
            run_process({RUNCERT_PROGRAMS "/runcert", "batch", day().string(), "--out",
                         out().string(), "--no-render"},
                        {.time_limit = std::chrono::minutes(5)});
        EXPECT_EQ(result.end, ProcessEnd::by_itself) << text.substr(0, 60);
        EXPECT_EQ(result.exit_status, 2) << text.substr(0, 60) << result.output;
        EXPECT_TRUE(holds(result.errors + result.output, "day.yaml")) << result.errors;
        EXPECT_TRUE(holds(result.errors + result.output, "what to do: ")) << result.errors;
    }
}

TEST_F(BadDays, WrongSharesAndMissingClustersAreSaid) {
    write("a.yaml", attempt("a"));
    for (const char* share : {"1", "2/2", "-1/2", "a/b", "0/0", "0/2/3", ""})
        EXPECT_TRUE(
            holds(refusal({day().string(), "--out", out().string(), "--share", share}), "share"))
            << share;
    // A task that remembers where nobody else looks would be made again by the next.
    EXPECT_TRUE(holds(refusal({day().string(), "--out", out().string(), "--share", "0/1"},
                              {{"XDG_STATE_HOME", "/proc/none"}}),
                      "XDG_STATE_HOME"));
    const std::string words =
        refusal({day().string(), "--out", out().string(), "--engine", "slurm"},
                {{"PATH", path("made").string()}});
    EXPECT_TRUE(holds(words, "slurm")) << words;
    EXPECT_TRUE(holds(words, "Install")) << words;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
