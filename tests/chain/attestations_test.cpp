#include <fmt/format.h>

#include "files/sha256.h"
#include "signatures_support.h"
#include "trust/attestation_files.h"
#include "trust/attestation_judgement.h"
#include "trust/envelope.h"

// Who answers for what a recording cannot show, and what of it counts.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// A run of the salt lake with keys for each role that its rule names, and a second judge.
class Attestations : public SignedRuns {
  protected:
    static void SetUpTestSuite() {
        SignedRuns::SetUpTestSuite();
        for (const char* name : {"board", "judge2"}) {
            const std::string role = std::string(name) == "board" ? "board" : "judge";
            const ProcessResult made =
                runcert({"keygen", "--out", (shared_->path() / name).string(), "--role", role,
                         "--no-password"});
            const std::size_t line = made.output.find("roster      ") + 12;
            lines_[name] = made.output.substr(line, made.output.find('\n', line) - line);
        }
        std::string all;
        for (const char* name : {"measurer", "judge", "judge2", "board"})
            all += lines_[name] + "\n";
        write_file_atomically(shared_->path() / "roster", all);
    }

    nlohmann::json report() const {
        return nlohmann::json::parse(read_file(run() / "report.json"))["predicate"];
    }
    /// The clauses that a role answers for.
    std::vector<std::string> due(const std::string& role) const {
        std::vector<std::string> clauses;
        const nlohmann::json all = report();
        for (const auto& one : all["profiles"][0]["requirements"])
            if (one["status"] == "attest" && one["answered_by"]["role"] == role)
                clauses.push_back(one["clause"]);
        return clauses;
    }
    ProcessResult attest(const std::string& name, const std::string& role,
                         const std::vector<std::string>& clauses,
                         const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{"attest", run().string()};
        arguments.insert(arguments.end(), clauses.begin(), clauses.end());
        arguments.insert(arguments.end(),
                         {"--role", role, "--key", key(name), "--yes", "--no-render"});
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments);
    }
    /// The name of the envelope, from the run folder on.
    std::string must_attest(const std::string& name, const std::string& role,
                            const std::vector<std::string>& clauses,
                            const std::vector<std::string>& more = {}) const {
        const ProcessResult result = attest(name, role, clauses, more);
        EXPECT_EQ(result.exit_status, 0) << result.output << result.errors;
        const std::size_t at = result.output.find("attestations/answer-");
        return at == std::string::npos
                   ? ""
                   : result.output.substr(at, result.output.find('\n', at) - at);
    }
    /// All that is due, answered yes, and the report signed.
    void complete() const {
        for (const char* role : {"measurer", "judge", "board"})
            if (const auto clauses = due(role); !clauses.empty()) must_attest(role, role, clauses);
        must_sign("measurer", "measurer");
    }
    /// A yes as `attest` would word it.
    Answer answer_to(const std::string& clause) const {
        for (const DueClause& one : due_clauses(read_report_facts(run())))
            if (one.clause == clause)
                return {one.profile, one.clause, one.text, one.shown, std::string(answer_yes)};
        ADD_FAILURE() << clause;
        return {};
    }
    /// An envelope put there by other means than `attest`.
    std::string plant(const Attestation& said, const std::string& name) const {
        return write_attestation(run(), said, {}, secret_key(name));
    }
    static SecretKey secret_key(const std::string& name) {
        return parse_secret_key(read_file(key(name)), std::nullopt, name);
    }
    Attestation read(const std::string& file) const {
        return read_statement(read_envelope(read_file(run() / file), file).payload, file);
    }
    nlohmann::json found() const { return verify_json({"--roster", roster()}); }
    static std::string standing(const nlohmann::json& found) {
        return found["standing"][0].get<std::string>();
    }
    void expect_fault(const std::string& words) const {
        const auto all = found();
        EXPECT_EQ(layer(all, "attestations")["passed"], false) << words;
        EXPECT_TRUE(says(layer(all, "attestations"), words)) << layer(all, "attestations").dump(1);
        EXPECT_EQ(all["exit_status"], 1);
        EXPECT_FALSE(says(all["standing"], "Record beaten")) << all["standing"];
    }
};

TEST_F(Attestations, OfEveryRoleMakeTheRecordBeatenByTheReadersRosterAlone) {
    EXPECT_FALSE(says(found()["standing"], "Record beaten"));
    complete();
    const auto all = found();
    EXPECT_EQ(all["exit_status"], 0) << all.dump(1);
    EXPECT_EQ(standing(all), "nalsa: Record beaten. Standing: complete.");
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

TEST_F(Attestations, ARosterThatLiesInTheRunVouchesForNothing) {
    complete();
    fs::create_directory(run() / "keys");
    fs::copy_file(roster(), run() / "keys" / "roster");
    const fs::path link = path("my-roster");
    fs::create_symlink(run() / "keys" / "roster", link);
    for (const fs::path& given : {run() / "keys" / "roster", link}) {
        const auto all = verify_json({"--roster", given.string()});
        EXPECT_FALSE(says(all["standing"], "Record beaten")) << all["standing"];
        EXPECT_TRUE(says(all["standing"], "nobody vouche")) << all["standing"];
        const ProcessResult listed =
            runcert({"attest", run().string(), "--roster", given.string()});
        EXPECT_EQ(listed.exit_status, 2);
        EXPECT_NE(listed.errors.find("vouches for nothing"), std::string::npos) << listed.errors;
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

TEST_F(Attestations, InAWrongRoleDoNotCount) {
    complete();
    const std::string clause = due("board").front();
    // The board's answer goes, the measurer's comes in its place: in his role, and in the board's.
    for (const char* role : {"measurer", "board"}) {
        for (const EnvelopeFile& file : envelope_files(run()))
            if (read("attestations/" + file.name).role == "board")
                fs::remove(run() / "attestations" / file.name);
        Attestation said = read("attestations/" + envelope_files(run()).front().name);
        said.after.clear();
        said.role = role;
        said.key = public_key_line(public_key_of(secret_key("measurer")));
        said.answers = {answer_to(clause)};
        const std::string planted = plant(said, "measurer");
        const auto all = found();
        EXPECT_FALSE(says(all["standing"], "Record beaten")) << role;
        const auto attestations = layer(all, "attestations");
        EXPECT_TRUE(says(attestations, std::string(role) == "board"
                                           ? "the roster does not let this key sign as board"
                                           : "board answers for it, not measurer"))
            << attestations.dump(1);
        fs::remove(run() / planted);
    }
}

TEST_F(Attestations, OfAnotherRunAreSeen) {
    const fs::path there = other_run();
    // An answer to the other report, which the same judge gave.
    const auto other = nlohmann::json::parse(read_file(there / "report.json"))["predicate"];
    std::string clause;
    for (const auto& one : other["profiles"][0]["requirements"])
        if (one["status"] == "attest" && one["answered_by"]["role"] == "judge")
            clause = one["clause"];
    const ProcessResult result =
        runcert({"attest", there.string(), clause, "--profile",
                 other["profiles"][0]["profile"].get<std::string>(), "--role", "judge", "--key",
                 key("judge"), "--yes", "--no-render"});
    ASSERT_EQ(result.exit_status, 0) << result.errors;
    fs::create_directory(run() / "attestations");
    for (const EnvelopeFile& file : envelope_files(there))
        fs::copy_file(there / "attestations" / file.name, run() / "attestations" / file.name);
    expect_fault("signed for another report");
    fs::remove_all(there / "attestations");
}

TEST_F(Attestations, ANoIsANoAndIsTakenBackByItsSignerAlone) {
    complete();
    const std::string clause = due("judge").front();
    must_attest("judge2", "judge", {clause}, {"--no"});
    auto all = found();
    EXPECT_EQ(all["exit_status"], 0) << all.dump(1);
    EXPECT_EQ(standing(all),
              "nalsa: Measured speed exceeds the record; 1 requirement answered no. Standing: 1 "
              "requirement answered no.");
    EXPECT_TRUE(says(layer(all, "attestations"), "contradicted: answered yes and no"));
    // Another judge cannot take it back, and the first says yes already.
    EXPECT_EQ(attest("board", "judge", {clause}, {"--withdraw"}).exit_status, 2);
    EXPECT_EQ(attest("judge2", "judge", {clause}).exit_status, 2);
    must_attest("judge2", "judge", {clause}, {"--withdraw"});
    all = found();
    EXPECT_EQ(standing(all), "nalsa: Record beaten. Standing: complete.");
    EXPECT_TRUE(says(layer(all, "attestations"), "taken back by its signer")) << all.dump(1);
    // A no by somebody whom the roster does not know hinders nobody.
    must_attest("stranger", "judge", {clause}, {"--no"});
    EXPECT_EQ(standing(found()), "nalsa: Record beaten. Standing: complete.");
    EXPECT_TRUE(says(layer(found(), "attestations"), "not on the roster"));
}

TEST_F(Attestations, TakenBackStayTakenBackHoweverTheyAreWrapped) {
    complete();
    const std::string clause = due("judge").front();
    const std::string yes = must_attest("judge2", "judge", {clause});
    const std::string bytes = read_file(run() / yes);
    must_attest("judge2", "judge", {clause}, {"--withdraw"});
    must_attest("judge", "judge", {clause}, {"--withdraw"});
    EXPECT_NE(standing(found()).find("awaiting 1 attestation"), std::string::npos);
    // The same signed statement under another name, and with other blanks.
    write_file_atomically(run() / "attestations/answer-0123456789abcdef.json", bytes);
    expect_fault("another name than its statement");
    fs::remove(run() / "attestations/answer-0123456789abcdef.json");
    write_file_atomically(run() / yes, " " + bytes);
    expect_fault("no envelope as runcert writes one");
}

TEST_F(Attestations, DeletedAreSeen) {
    complete();
    const std::string clause = due("judge").front();
    const std::string no = must_attest("judge2", "judge", {clause}, {"--no"});
    const std::string last =
        must_attest("judge2", "judge", {due("judge").back()}, {"--statement", "later"});
    const std::string bytes = read_file(run() / no);
    // The no goes: the later answer knows of it.
    fs::remove(run() / no);
    expect_fault("now deleted");
    write_file_atomically(run() / no, bytes);
    EXPECT_EQ(found()["exit_status"], 0);
    // All answers of a role go: the report says how many are due.
    for (const EnvelopeFile& file : envelope_files(run()))
        fs::remove(run() / "attestations" / file.name);
    const auto all = found();
    EXPECT_EQ(all["exit_status"], 0) << all.dump(1);
    EXPECT_EQ(layer(all, "attestations")["passed"], nullptr);
    EXPECT_NE(standing(all).find("still to be attested"), std::string::npos) << standing(all);
}

TEST_F(Attestations, EvidenceGoesAlongAndIsHeldToItsHash) {
    write_file_atomically(path("list of observers.txt"), "Jane Roe\n");
    write_file_atomically(path("scan.pdf"), "%PDF signed by hand\n");
    const std::string file = must_attest("judge", "judge", {due("judge").front()},
                                         {"--evidence", path("list of observers.txt").string(),
                                          "--paper", path("scan.pdf").string()});
    const Attestation said = read(file);
    ASSERT_EQ(said.evidence.size(), 1U);
    ASSERT_TRUE(said.on_paper);
    auto all = layer(found(), "attestations");
    EXPECT_EQ(all["passed"], true) << all.dump(1);
    EXPECT_TRUE(says(all, "yes on paper, entered by judge (judge)")) << all.dump(1);
    EXPECT_TRUE(says(all, "evidence: list-of-observers.txt")) << all.dump(1);
    for (const EvidenceFile& one : {said.evidence.front(), *said.on_paper}) {
        const fs::path evidence = run() / "attestations" / evidence_name(one);
        const std::string bytes = read_file(evidence);
        write_file_atomically(evidence, bytes + "more");
        expect_fault("is changed");
        fs::remove(evidence);
        expect_fault("is missing");
        write_file_atomically(evidence, bytes);
        EXPECT_EQ(layer(found(), "attestations")["passed"], true);
    }
    write_file_atomically(run() / "attestations/evidence-0123456789abcdef-x.txt", "mine");
    EXPECT_TRUE(says(layer(found(), "files"), "neither an attestation nor evidence"));
}

TEST_F(Attestations, AreRefusedWhereAByteIsAnother) {
    const std::string file = must_attest("judge", "judge", {due("judge").front()});
    const std::string bytes = read_file(run() / file);
    for (std::size_t at = 0; at < bytes.size(); at += 97) {
        std::string changed = bytes;
        changed[at] = changed[at] == 'A' ? 'B' : 'A';
        write_file_atomically(run() / file, changed);
        expect_fault("attestations/answer-");
    }
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
    certify(attempt / "attempt.yaml", run(), {"--no-render"});
    EXPECT_FALSE(fs::exists(run() / "attestations"));
    EXPECT_TRUE(fs::exists(run() / "superseded" / fs::path(file).filename()));
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
    EXPECT_EQ(standing(all), "nalsa: Record beaten. Standing: complete.");
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
        if (!more.empty()) fs::remove(run() / "report.pdf");  // what takes long, once is enough
    };
    const auto pages = [&](const std::vector<std::string>& keys) {
        return layer(verify_json(keys), "pages");
    };
    render({});
    std::string page = read_file(run() / "report.html");
    EXPECT_EQ(page.find("Record beaten"), std::string::npos);
    EXPECT_NE(page.find("answers by keys that nobody vouched for"), std::string::npos);
    EXPECT_EQ(pages({"--roster", roster()})["passed"], true) << pages({"--roster", roster()});
    render({"--roster", roster()});
    page = read_file(run() / "report.html");
    EXPECT_NE(page.find("</span> Record beaten</p>"), std::string::npos);
    EXPECT_NE(page.find("yes by judge (judge), 20"), std::string::npos);
    EXPECT_EQ(pages({"--roster", roster()})["passed"], true) << pages({"--roster", roster()});
    // A page by another roster is not taken.
    const std::string other = roster_of({line_for("stranger", "measurer,judge,board")});
    EXPECT_TRUE(says(pages({"--roster", other})["finding"], "not given here"));
    EXPECT_EQ(pages({"--roster", other})["passed"], false);
    // A page whose standing was written by hand, and one that leaves out a no.
    must_attest("judge2", "judge", {due("judge").front()}, {"--no"});
    EXPECT_EQ(pages({"--roster", roster()})["passed"], false);
    render({"--roster", roster()});
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
    EXPECT_EQ(standing(found()),
              "club: Measured speed exceeds the record under altered rules. Standing: complete.");
}

TEST_F(Attestations, ShowOnTheDay) {
    const fs::path out = path("out");
    const std::vector<std::string> batch{"batch", (examples / "salt_lake").string(), "--out",
                                         out.string()};
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
    EXPECT_NE(explain({"--roster", roster()}).find("Record beaten."), std::string::npos);
    EXPECT_EQ(explain({}).find("Record beaten."), std::string::npos);
    EXPECT_NE(explain({clause}).find("yes by judge, 20"), std::string::npos) << explain({clause});
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
