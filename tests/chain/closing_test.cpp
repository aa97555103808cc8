#include <functional>

#include "attestations_support.h"

// A run is complete only where its closing statement names all that lies there: what is added,
// deleted, dated back or put beside it, and by whom.

namespace runcert::chain::RUNCERT_FILE {
namespace {

class Closed : public Attestations {
  protected:
    /// A statement by that key, like the one in the file but for what is changed.
    std::string planted(const std::string& name, const std::string& like, auto&& change) const {
        Attestation said = read(like);
        said.key = public_key_line(public_key_of(secret_key(name)));
        said.after.clear();
        change(said);
        return plant(said, name);
    }
    std::string no_by_judge2(const std::string& time = "") const {
        return planted("judge2", envelope_of("judge"), [&](Attestation& said) {
            said.answers = {answer_to(due("judge").front())};
            said.answers.front().answer = answer_no;
            if (!time.empty()) said.time = time;
        });
    }
    std::string envelope_of(const std::string& role) const {
        for (const EnvelopeFile& file : envelope_files(run()))
            if (read("attestations/" + file.name).role == role) return "attestations/" + file.name;
        ADD_FAILURE() << role;
        return {};
    }
    void expect_beaten(const std::string& by = roster()) const {
        const auto all = verify_json({"--roster", by});
        EXPECT_EQ(standing(all), beaten(by)) << all["standing"].dump(1);
        EXPECT_EQ(all["exit_status"], 0) << all.dump(1);
    }
};

// The newest no was deleted, and the run was complete and VERIFIED.
TEST_F(Closed, ANoThatIsDeletedLeavesTheRunOpen) {
    answer_all();
    std::string no = must_attest("judge2", "judge", {due("judge").front()}, {"--no"});
    fs::remove(run() / no);
    expect_open("Not closed: board closes it");
    no = must_attest("judge2", "judge", {due("judge").front()}, {"--no"});
    close();
    EXPECT_TRUE(says(found()["standing"], "1 requirement answered no"));
    fs::remove(run() / no);
    expect_open(no + " is listed by the close, but is missing");
}

TEST_F(Closed, WhatTheCloseDoesNotListLeavesItOpenWhateverItsDate) {
    complete();
    expect_beaten();
    for (const char* time : {"", "2026-11-26T00:00:00Z", "2026-11-25T00:00:00Z"}) {
        const std::string no = no_by_judge2(time);
        EXPECT_TRUE(says(found()["standing"], "answered no")) << time;
        EXPECT_TRUE(says(found()["standing"], no + " lies here, but the close")) << time;
        fs::remove(run() / no);
    }
    // Nor does a yes, an answer taken back, or that of an official in a role that is not his.
    const std::string yes = must_attest("judge2", "judge", {due("judge").front()});
    expect_open(yes + " lies here, but the close");
    fs::remove(run() / yes);
    const std::string other =
        planted("judge2", envelope_of("judge"), [](Attestation& said) { said.role = "measurer"; });
    expect_open(other + " lies here");
    fs::remove(run() / other);
    must_sign("judge", "judge");
    expect_open("report.json.judge.minisig lies here");
    close();
    expect_beaten();
    // The same key signs again: another signature.
    must_sign("judge", "judge");
    EXPECT_FALSE(says(found()["standing"], "Record beaten") &&
                 read(envelope_of("board")).closes.empty());
    fs::remove(run() / "report.json.judge.minisig");
    expect_open("report.json.judge.minisig is listed by the close, but is missing");
}

TEST_F(Closed, OfTwoClosesOneMustNameTheOther) {
    complete();
    const std::string first = close();
    expect_beaten();
    // One that names all but the other.
    const std::string second =
        planted("board", first, [](Attestation& said) { said.time = "2026-11-28T00:00:01Z"; });
    expect_open("Several closing statements, of which none names the others");
    const std::string third = close();
    expect_beaten();
    for (const std::string& earlier : {first, second}) {
        const std::string bytes = read_file(run() / earlier);
        fs::remove(run() / earlier);
        EXPECT_NE(standing(found()), beaten()) << earlier;
        write_file_atomically(run() / earlier, bytes);
    }
    fs::remove(run() / third);
    EXPECT_NE(standing(found()), beaten());
}

TEST_F(Closed, ByWhomTheRosterSays) {
    answer_all();
    const auto judges_close = [&](const std::string& role) {
        return planted("judge", envelope_of("board"), [&](Attestation& said) {
            said.role = role;
            said.answers.clear();
            const std::vector<EvidenceFile> all = [&] {
                std::vector<EvidenceFile> files;
                for (const EnvelopeFile& file : envelope_files(run()))
                    files.push_back({"attestations/" + file.name, sha256_hex(file.text)});
                files.push_back(
                    {"report.json.minisig", sha256_hex(read_file(run() / "report.json.minisig"))});
                return files;
            }();
            said.closes = all;
        });
    };
    const std::string wrong = judges_close("judge"), false_role = judges_close("board");
    expect_open("Not closed: board closes it");
    EXPECT_TRUE(says(layer(found(), "attestations"), "board closes a run, not judge"));
    EXPECT_TRUE(says(layer(found(), "attestations"), "does not let this key sign as board"));
    fs::remove(run() / false_role);
    // A roster that says so has the judge close it, and no board.
    const std::string by =
        roster_of({lines_["measurer"], lines_["judge"], lines_["board"], "#runcert close judge"});
    EXPECT_EQ(standing(verify_json({"--roster", by})), beaten(by));
    close();
    EXPECT_NE(standing(verify_json({"--roster", by})), beaten(by));
    for (const char* line : {"#runcert close", "#runcert close the board", "#runcert close a,b",
                             "#runcert close judge\n#runcert close board", "#runcert closed judge"})
        EXPECT_EQ(verify({"--roster", roster_of({lines_["judge"], line})}).exit_status, 2) << line;
}

TEST_F(Closed, ByAKeyThatDoesNotCountAnyMoreOrFromAnotherTimeIsNotClosed) {
    complete();
    for (const char* validity : {"valid-before=\"20200101Z\"", "valid-after=\"20990101Z\""})
        EXPECT_FALSE(says(verify_json({"--roster", roster_of({lines_["measurer"], lines_["judge"],
                                                              line_with("board", validity)})}),
                          "Record beaten"));
    const std::string last = close();
    for (const EnvelopeFile& file : envelope_files(run()))
        if (read("attestations/" + file.name).is_closing())
            fs::remove(run() / "attestations" / file.name);
    static_cast<void>(last);
    expect_open("Not closed");
}

// An answer from before the recording had ended counted.
TEST_F(Closed, AnswersFromBeforeTheEndOfTheRecordingDoNotCount) {
    complete();
    const std::string board = envelope_of("board");
    const std::string yes = planted("judge2", envelope_of("judge"),
                                    [](Attestation& said) { said.time = "2001-01-01T00:00:00Z"; });
    EXPECT_TRUE(says(layer(found(), "attestations"), "dated before the end of the recording"));
    fs::remove(run() / yes);
    expect_beaten();
    for (const EnvelopeFile& file : envelope_files(run()))
        if (const std::string name = "attestations/" + file.name; read(name).is_closing()) {
            const std::string early = planted(
                "board", name, [](Attestation& said) { said.time = "2001-01-01T00:00:00Z"; });
            fs::remove(run() / name);
            EXPECT_NE(standing(found()), beaten()) << early;
        }
}

TEST_F(Closed, RecomputedByOtherRulesDoesNotCount) {
    complete();
    const std::string file = must_attest("board", "board", {}, {"--recomputed"});
    EXPECT_FALSE(says(layer(found(), "attestations"), "by other rules"));
    for (const int change : {0, 1, 2})
        planted("board", file, [&](Attestation& said) {
            if (change == 0) said.policies.front().sha256[0] ^= 1;
            if (change == 1) said.policies.pop_back();
            if (change == 2) said.policies.push_back({"profile.x.yaml", std::string(64, '0')});
        });
    const auto details = layer(found(), "attestations").dump();
    std::size_t said = 0;
    for (std::size_t at = details.find("by other rules"); at != std::string::npos;
         at = details.find("by other rules", at + 1))
        ++said;
    EXPECT_EQ(said, 3U) << details;
}

// 200 envelopes by an unknown key ended `verify` with 2; deleting one that an official's answer
// named made that answer void.
TEST_F(Closed, StrangersCountForNothingAndHinderNobody) {
    must_attest("stranger", "judge", {due("judge").front()}, {"--no"});
    const std::string theirs = "attestations/" + envelope_files(run()).front().name;
    complete();  // whose answers saw it
    expect_beaten();
    for (const auto& change : std::vector<std::function<void(Attestation&)>>{
             [](Attestation& said) { said.report_sha256[0] ^= 1; },
             [](Attestation& said) {
                 said.evidence = {{"x", std::string(64, '0')}};
             },
             [](Attestation& said) {
                 said.after = {{"RWx", std::string(64, '0')}};
             },
             [](Attestation& said) { said.time = "2999-01-01T00:00:00Z"; },
             [](Attestation& said) { said.time = "never"; },
             [](Attestation& said) { said.role = "a judge"; }})
        planted("stranger", theirs, change);
    for (int i = 0; i < 1100; ++i)
        planted("stranger", theirs, [&](Attestation& said) { said.statement = std::to_string(i); });
    must_sign("stranger", "judge");
    for (int i = 0; i < 300; ++i)
        fs::copy_file(run() / "report.json.judge.minisig",
                      run() / fmt::format("report.json.x{}.minisig", i));
    expect_beaten();
    EXPECT_TRUE(says(found()["standing"], "1,107 attestations by keys that are not on the roster"));
    must_attest("judge2", "judge", {due("judge").front()}, {"--roster", roster()});
    close();
    expect_beaten();
    fs::remove(run() / theirs);
    expect_beaten();
    EXPECT_EQ(layer(verify_json({"--pubkey", public_key("measurer")}), "attestations")["passed"],
              true);
}

TEST_F(Closed, IsRefusedWhereItCouldNotClose) {
    const auto refused = [&](const std::string& name, const std::string& role,
                             const std::vector<std::string>& more, const std::string& words) {
        const ProcessResult result = attest(name, role, {}, more);
        EXPECT_EQ(result.exit_status, 2) << words << result.output;
        EXPECT_NE(result.errors.find(words), std::string::npos) << result.errors;
    };
    refused("board", "board", {"--close", "--roster", roster()}, "othing to close");
    must_sign("measurer", "measurer");
    refused("board", "board", {"--close"}, "--roster");
    refused("judge", "judge", {"--close", "--roster", roster()}, "--role board");
    const std::string judge = due("judge").front();
    EXPECT_EQ(attest("board", "board", {judge}, {"--close", "--roster", roster()}).exit_status, 2);
    EXPECT_FALSE(fs::exists(run() / "attestations"));
    // Of what is open, it closes nothing, and says so.
    const ProcessResult early = attest("board", "board", {}, {"--close", "--roster", roster()});
    EXPECT_EQ(early.exit_status, 0) << early.errors;
    EXPECT_NE(early.output.find("still to be attested"), std::string::npos) << early.output;
    EXPECT_NE(early.output.find("closes  report.json.minisig"), std::string::npos) << early.output;
    EXPECT_TRUE(says(found()["standing"], "still to be attested"));
}

// Page one said "Record beaten" by a claimant's own roster of one key in three roles.
TEST_F(Closed, OneKeyInSeveralRolesIsSaidInTheHeadline) {
    const std::string own = roster_of({line_for("stranger", "measurer,judge,board")});
    for (const char* role : {"measurer", "judge", "board"})
        if (const auto clauses = due(role); !clauses.empty())
            must_attest("stranger", role, clauses);
    must_sign("stranger", "measurer");
    close("stranger", "board", own);
    const std::string headline = "; one key is board, judge and measurer. Standing: complete.";
    const auto all = verify_json({"--roster", own});
    EXPECT_NE(standing(all).find(headline), std::string::npos) << standing(all);
    EXPECT_TRUE(says(all["standing"], "board stranger, judge stranger")) << all["standing"];
    ASSERT_EQ(runcert({"attest", run().string(), "--render", "--roster", own}).exit_status, 0);
    const std::string page = read_file(run() / "report.html");
    EXPECT_NE(page.find("; one key is board, judge and measurer"), std::string::npos);
    EXPECT_NE(page.find("by the roster " + sha256_hex(read_file(own)).substr(0, 4)),
              std::string::npos);
}

// Co-signing without the roster took "Record beaten" off the pages while `verify` said VERIFIED.
TEST_F(Closed, PagesKeepTheirRoster) {
    complete();
    const auto render = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"attest", run().string(), "--render"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments);
    };
    ASSERT_EQ(render({"--roster", roster()}).exit_status, 0);
    fs::remove(run() / "certificate.pdf");
    fs::remove(run() / "report.pdf");  // takes long
    const std::string page = read_file(run() / "report.html");
    EXPECT_NE(page.find("Closed by board (board)"), std::string::npos);
    EXPECT_NE(page.find("Later answers show only where the body keeps them."), std::string::npos);
    const std::string clause = due("judge").front();
    const std::string other = roster_of({lines_["measurer"], lines_["judge"], lines_["board"]});
    for (const std::vector<std::string>& by : {std::vector<std::string>{}, {"--roster", other}})
        for (std::vector<std::string> command :
             {std::vector<std::string>{"sign", run().string(), "--key", key("judge"), "--role",
                                       "judge", "--no-recompute"},
              {"attest", run().string(), clause, "--role", "judge", "--key", key("judge2"),
               "--yes"},
              {"bundle", run().string(), "--out", path("run.zip").string()},
              {"attest", run().string(), "--render"}}) {
            const bool anew = command.back() == "--render" && !by.empty();
            if (anew) continue;
            command.insert(command.end(), by.begin(), by.end());
            const ProcessResult result = runcert(command);
            EXPECT_EQ(result.exit_status, 2) << command[0] << result.output;
            EXPECT_NE(result.errors.find("pages go by the roster with the SHA-256"),
                      std::string::npos)
                << result.errors;
            EXPECT_EQ(read_file(run() / "report.html"), page);
        }
    EXPECT_EQ(layer(found(), "pages")["passed"], true);
    // With it they go on to say what is: not closed any more.
    const ProcessResult signed_too =
        runcert({"sign", run().string(), "--key", key("judge"), "--role", "judge", "--no-recompute",
                 "--roster", roster()});
    EXPECT_EQ(signed_too.exit_status, 0) << signed_too.errors;
    EXPECT_EQ(read_file(run() / "report.html").find("Record beaten"), std::string::npos);
    EXPECT_EQ(layer(found(), "pages")["passed"], true);
    // Pages from before a signature or an answer that the close lacks are not taken.
    close();
    ASSERT_EQ(render({"--roster", roster()}).exit_status, 0);
    fs::remove(run() / "certificate.pdf");
    fs::remove(run() / "report.pdf");
    must_sign("judge2", "judge");
    EXPECT_TRUE(says(layer(found(), "pages"), "another standing"));
    EXPECT_EQ(found()["exit_status"], 1);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
