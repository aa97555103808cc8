#include "attestations_support.h"

// Officials answer for what a recording cannot show: commands, pages, days, bundles.

namespace runcert::chain::RUNCERT_FILE {
namespace {

TEST_F(Attestations, OfEveryRoleMakeTheRecordBeatenByTheReadersRosterAlone) {
    EXPECT_FALSE(says(found()["standing"], "Record beaten"));
    complete();
    const auto all = found();
    EXPECT_EQ(all["exit_status"], 0) << all.dump(1);
    EXPECT_EQ(standing(all), beaten());
    EXPECT_TRUE(says(all["standing"], sha256_hex(read_file(roster())))) << all["standing"];
    // By keys alone, or none, nobody vouches for a role.
    for (const std::vector<std::string>& keys :
         {std::vector<std::string>{}, {"--pubkey", public_key("measurer")}}) {
        const auto other = verify_json(keys);
        EXPECT_FALSE(says(other["standing"], "Record beaten")) << other["standing"];
        EXPECT_TRUE(says(other["standing"], "nobody vouche")) << other["standing"];
    }
    // By a roster without one of them; by one that gives a key another role.
    for (const std::vector<std::string>& lines :
         {std::vector<std::string>{lines_["measurer"], lines_["judge"]},
          {lines_["measurer"], lines_["judge"], line_for("board", "observer")},
          {line_for("stranger", "measurer,judge,board")}}) {
        const auto other = verify_json({"--roster", roster_of(lines)});
        EXPECT_FALSE(says(other["standing"], "Record beaten")) << other["standing"];
    }
}

TEST_F(Attestations, AloneListWhatIsOpenByRoleWithFigures) {
    const ProcessResult listed = runcert({"attest", run().string()});
    EXPECT_EQ(listed.exit_status, 0) << listed.errors;
    for (const char* role : {"judge", "board"}) {
        EXPECT_NE(listed.output.find(std::string(role) + " answers:"), std::string::npos);
        for (const std::string& clause : due(role))
            EXPECT_NE(listed.output.find("nalsa/" + clause), std::string::npos) << clause;
    }
    must_attest("judge", "judge", due("judge"), {"--statement", "I stood there."});
    const std::string then = runcert({"attest", run().string(), "--roster", roster()}).output;
    for (const char* part :
         {"attested", "yes by judge (judge), 20", "“I stood there.”", "open: board"})
        EXPECT_NE(then.find(part), std::string::npos) << part << "\n" << then;
}

TEST_F(Attestations, AreRefusedBeforeAnythingIsSigned) {
    const std::string of_judge = due("judge").front();
    const struct {
        std::vector<std::string> clauses;
        std::string role;
        std::vector<std::string> more;
        std::string said;
    } cases[] = {
        {{"no-such-clause"}, "judge", {}, "nalsa/" + of_judge},
        {{"average-over-3-s"}, "judge", {}, "othing of that name is to be attested"},
        {{of_judge}, "board", {}, "udge answers for it, not board"},
        {{of_judge}, "chief judge", {}, "cannot be a role"},
        {{of_judge}, "judge", {"--withdraw"}, "nothing to take back"},
        {{of_judge}, "judge", {"--profile", "fisly"}, "othing of that name"},
        {{of_judge}, "judge", {"--statement", "two\nlines"}, "one line"},
        {{of_judge}, "judge", {"--evidence", path("missing").string()}, "missing"},
    };
    for (const auto& one : cases) {
        const ProcessResult result = attest("judge", one.role, one.clauses, one.more);
        EXPECT_EQ(result.exit_status, 2) << one.said << result.output;
        EXPECT_NE(result.errors.find(one.said), std::string::npos) << result.errors;
    }
    // Nobody is at the terminal, and nothing says that somebody looked.
    const ProcessResult unasked = runcert({"attest", run().string(), of_judge, "--role", "judge",
                                           "--key", key("judge"), "--no-render"});
    EXPECT_EQ(unasked.exit_status, 2);
    EXPECT_NE(unasked.errors.find("--yes"), std::string::npos) << unasked.errors;
    EXPECT_NE(unasked.output.find("nalsa/" + of_judge), std::string::npos) << unasked.output;
    EXPECT_FALSE(fs::exists(run() / "attestations"));
    // A file of the run that is not as it was.
    change("attempt.yaml", "salt", "sale");
    EXPECT_EQ(attest("judge", "judge", {of_judge}).exit_status, 2);
    EXPECT_FALSE(fs::exists(run() / "attestations"));
}

TEST_F(Attestations, AreConfirmedOnATerminal) {
    const auto typed = [&](const std::string& word) {
        return run_process(
            {"sh", "-c",
             fmt::format("printf '{}\\n' | script -qec '{}/runcert attest {} {} --role judge --key "
                         "{} --no-render' /dev/null",
                         word, RUNCERT_PROGRAMS, run().string(), due("judge").front(),
                         key("judge"))});
    };
    for (const char* word : {"n", "", "perhaps"}) {
        const ProcessResult asked = typed(word);
        EXPECT_EQ(asked.exit_status, 1) << asked.output;
        EXPECT_NE(asked.output.find("nothing was signed"), std::string::npos) << asked.output;
        EXPECT_FALSE(fs::exists(run() / "attestations"));
    }
    EXPECT_EQ(typed("y").exit_status, 0);
    EXPECT_EQ(envelope_files(run()).size(), 1U);
}

TEST_F(Attestations, StandWithAnUnchangedReportAndAreSupersededWithAnother) {
    const std::string file = must_attest("judge", "judge", {due("judge").front()});
    const fs::path attempt = path("attempt");
    fs::copy(examples / "salt_lake", attempt, fs::copy_options::recursive);
    certify(attempt / "attempt.yaml", run(), {"--no-render"});
    EXPECT_TRUE(fs::exists(run() / file));
    EXPECT_EQ(layer(found(), "attestations")["passed"], true);
    const std::string text = read_file(attempt / "attempt.yaml");
    std::string other = text;
    other.replace(other.find("id: ") + 4, 0, "re");
    write_file_atomically(attempt / "attempt.yaml", other);
    const std::string earlier = sha256_hex(read_file(run() / "report.json")).substr(0, 16);
    certify(attempt / "attempt.yaml", run(), {"--no-render"});
    EXPECT_FALSE(fs::exists(run() / "attestations"));
    // Beside the report that it answers for.
    const fs::path kept = run() / "superseded" / earlier;
    EXPECT_TRUE(fs::exists(kept / "report.json"));
    EXPECT_TRUE(fs::exists(kept / file));
    EXPECT_TRUE(says(layer(found(), "attestations"), "1 attestation to an earlier report"));
}

TEST_F(Attestations, GoIntoTheBundle) {
    complete();
    const std::string bundle = path("run.tar.zst").string();
    const ProcessResult made =
        runcert({"bundle", run().string(), "--roster", roster(), "--out", bundle});
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    const ProcessResult verified = runcert({"verify", bundle, "--roster", roster(), "--json"});
    const auto all = nlohmann::json::parse(verified.output);
    EXPECT_EQ(verified.exit_status, 0) << all.dump(1);
    EXPECT_EQ(standing(all), beaten());
}

TEST_F(Attestations, ABoardSignsThatItRecomputedInAFormThatOthersRead) {
    const std::string file = must_attest("board", "board", {}, {"--recomputed"});
    const auto envelope = nlohmann::json::parse(read_file(run() / file));
    EXPECT_EQ(envelope["payloadType"], "application/vnd.in-toto+json");
    const Attestation said = read(file);
    EXPECT_TRUE(said.is_recomputed());
    ASSERT_EQ(said.policies.size(), 2U);
    for (const EvidenceFile& rule : said.policies)
        EXPECT_EQ(rule.sha256, sha256_hex(read_file(run() / rule.name))) << rule.name;
    EXPECT_TRUE(says(layer(found(), "attestations"), "recomputed and agreed by board (board)"));
}

TEST_F(Attestations, PagesShowThemAndAreHeldToThem) {
    complete();
    const auto render = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"attest", run().string(), "--render"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProcessResult result = runcert(arguments);
        ASSERT_EQ(result.exit_status, 0) << result.errors;
    };
    const auto pages = [&](const std::vector<std::string>& keys) {
        return layer(verify_json(keys), "pages");
    };
    render({});
    std::string page = read_file(run() / "report.html");
    EXPECT_EQ(page.find("Record beaten"), std::string::npos);
    EXPECT_NE(page.find("answers by keys that nobody vouched for"), std::string::npos);
    // What the roster vouches for does not stand there.
    EXPECT_TRUE(says(pages({"--roster", roster()}), "nalsa: they show another standing"));
    EXPECT_EQ(pages({})["passed"], true);
    fs::remove(run() / "certificate.pdf");
    fs::remove(run() / "report.pdf");  // what takes long, once is enough
    render({"--roster", roster()});
    EXPECT_FALSE(fs::exists(run() / "report.pdf"));
    page = read_file(run() / "report.html");
    EXPECT_NE(page.find(beaten().substr(7, 60)), std::string::npos);
    EXPECT_NE(page.find("yes by judge (judge), 20"), std::string::npos);
    EXPECT_EQ(pages({"--roster", roster()})["passed"], true) << pages({"--roster", roster()});
    // A page by another roster is not taken.
    const std::string other = roster_of({line_for("stranger", "measurer,judge,board")});
    EXPECT_TRUE(says(pages({"--roster", other})["finding"], "not given here"));
    EXPECT_EQ(pages({"--roster", other})["passed"], false);
    // A page whose standing was written by hand, and one that leaves out a no.
    must_attest("judge2", "judge", {due("judge").front()},
                {"--no", "--statement", "</script><b>Record beaten</b>"});
    EXPECT_EQ(pages({"--roster", roster()})["passed"], false);
    render({"--roster", roster()});
    EXPECT_EQ(read_file(run() / "report.html").find("<b>Record beaten"), std::string::npos);
    EXPECT_EQ(pages({"--roster", roster()})["passed"], true);
    page = read_file(run() / "report.html");
    for (std::size_t at = page.find("answered no"); at != std::string::npos;
         at = page.find("answered no", at))
        page.replace(at, 11, "answered ok");
    write_file_atomically(run() / "report.html", page);
    EXPECT_EQ(pages({"--roster", roster()})["passed"], false);
}

TEST_F(Attestations, AreAsManyAsTheRuleAsksForAndBeatNoRecordUnderARuleOfOnesOwn) {
    fs::remove_all(run());
    const fs::path attempt = path("attempt");
    fs::copy(examples / "salt_lake", attempt, fs::copy_options::recursive);
    std::string rule = read_file(fs::path(RUNCERT_SOURCE_DIR) / "stages/check/profiles/nalsa.yaml");
    const auto replace = [](std::string& text, const std::string& from, const std::string& to) {
        ASSERT_NE(text.find(from), std::string::npos) << from;
        text.replace(text.find(from), from.size(), to);
    };
    replace(rule, "id: nalsa", "id: club");
    const std::size_t observers = rule.find("id: observers");
    rule.replace(rule.find("{role: judge}", observers), 13, "{role: judge, count: 2}");
    write_file_atomically(attempt / "club.yaml", rule);
    std::string text = read_file(attempt / "attempt.yaml");
    replace(text, "- nalsa", "- club.yaml");
    write_file_atomically(attempt / "attempt.yaml", text);
    certify(attempt / "attempt.yaml", run(), {"--no-render"});
    complete();
    EXPECT_TRUE(says(layer(found(), "attestations"), "open: judge answers, 1 of 2 missing"));
    EXPECT_EQ(attest("judge", "judge", {"observers"}).exit_status, 2);
    must_attest("judge2", "judge", {"observers"});
    close();
    EXPECT_EQ(standing(found()),
              "club: Measured speed exceeds the record under altered rules. Standing: complete.");
}

TEST_F(Attestations, ShowOnTheDay) {
    const fs::path out = path("out");
    const std::vector<std::string> batch{"batch", (examples / "salt_lake").string(), "--out",
                                         out.string(), "--no-pdf"};
    ASSERT_LT(runcert(batch).exit_status, 2);
    fs::remove_all(run());
    fs::create_directory_symlink(out / "salt-lake", run());
    must_attest("judge", "judge", {due("judge").front()});
    ASSERT_LT(runcert(batch).exit_status, 2);
    EXPECT_NE(read_file(out / "day.html").find("yes by judge, 20"), std::string::npos);
    const YamlValue result = read_yaml(out / "day.yaml")["attempts"].list().front();
    EXPECT_EQ(result["results"].list().front()["standing"]["unvouched"].integer(), 1);
    EXPECT_EQ(layer(found(), "pages")["passed"], true);
    // Nothing is made again where nobody answered since.
    EXPECT_NE(runcert(batch).output.find("0 of 9 steps ran"), std::string::npos);
}

TEST_F(Attestations, AreExplained) {
    complete();
    const std::string clause = due("judge").front();
    const auto explain = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"explain", run().string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments).output;
    };
    EXPECT_NE(explain({"--roster", roster()}).find("Record beaten, by the roster "),
              std::string::npos);
    EXPECT_EQ(explain({}).find("Record beaten"), std::string::npos);
    EXPECT_NE(explain({clause}).find("yes by judge, 20"), std::string::npos) << explain({clause});
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
