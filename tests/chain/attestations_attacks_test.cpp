#include <functional>

#include "attestations_support.h"

// Answers that do not count, and folders of answers that are not as they were signed.

namespace runcert::chain::RUNCERT_FILE {
namespace {

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
        EXPECT_EQ(runcert({"explain", run().string(), "--roster", given.string()}).exit_status, 2);
        EXPECT_NE(listed.errors.find("vouches for nothing"), std::string::npos) << listed.errors;
    }
}

TEST_F(Attestations, ByAKeyThatIsNotValidNowDoNotCount) {
    complete();
    for (const char* validity :
         {"valid-before=\"20200101Z\"", "valid-after=\"20990101Z\"", "namespaces=\"x@runcert\""}) {
        std::string line = line_with("judge", validity);
        if (std::string(validity).starts_with("name"))
            line = "judge " + std::string(validity) +
                   lines_["judge"].substr(lines_["judge"].find(" ssh-"));
        const auto all =
            verify_json({"--roster", roster_of({lines_["measurer"], line, lines_["board"]})});
        EXPECT_FALSE(says(all["standing"], "Record beaten")) << validity << all["standing"];
        EXPECT_TRUE(says(layer(all, "attestations"), "not counted: the ")) << validity;
    }
}

TEST_F(Attestations, OfAnotherHandThanTheStatementNamesAreRefused) {
    complete();
    const std::string clause = due("board").front();
    for (const EnvelopeFile& file : envelope_files(run()))
        if (read("attestations/" + file.name).role == "board")
            fs::remove(run() / "attestations" / file.name);
    const Attestation real = read("attestations/" + envelope_files(run()).front().name);
    const auto planted = [&](const std::function<void(Attestation&)>& change,
                             const std::string& signer) {
        Attestation said = real;
        said.after.clear();
        said.role = "board";
        said.key = public_key_line(public_key_of(secret_key("board")));
        said.answers.clear();
        for (const std::string& each : due("board"))
            said.answers.push_back(answer_to(each));
        change(said);
        return plant(said, signer);
    };
    const struct {
        std::function<void(Attestation&)> change;
        std::string signer, words;
    } cases[] = {
        // The board's key is named, a stranger signed.
        {[](Attestation&) {}, "stranger", "was not signed by the key that it names"},
        {[](Attestation& said) { said.report_sha256[0] ^= 1; }, "board", "for another report"},
        {[](Attestation& said) { said.report_id = "0123456789abcdef"; }, "board", "another report"},
        {[](Attestation& said) { said.attempt_id = "other"; }, "board", "for another report"},
        {[](Attestation& said) { said.time = "yesterday"; }, "board",
         "time that its signer states"},
        {[](Attestation& said) { said.role = "the board"; }, "board", "no role"},
        {[](Attestation& said) { said.key = "RWnonsense"; }, "board", "attestations/answer-"},
        {[](Attestation& said) {
             said.evidence = {{"../../../etc/passwd", std::string(64, '0')}};
         },
         "board", "is missing"},
        {[](Attestation& said) {
             said.after = {{said.key, std::string(64, '0')}};
         },
         "board", "now deleted"},
    };
    for (const auto& one : cases) {
        SCOPED_TRACE(one.words);
        const std::string file = planted(one.change, one.signer);
        expect_fault(one.words);
        fs::remove(run() / file);
    }
    const struct {
        std::function<void(Attestation&)> change;
        std::string words;
    } uncounted[] = {
        {[](Attestation& said) { said.answers.front().shown = "0.001 m"; },
         "other words or figures"},
        {[](Attestation& said) { said.answers.front().text = "All is well."; }, "other words"},
        {[](Attestation& said) { said.answers.front().clause = "average-over-3-s"; },
         "still to be attested"},
        {[](Attestation& said) { said.answers.front().profile = "fisly"; }, "still to be attested"},
        {[](Attestation& said) { said.time = "2999-01-01T00:00:00Z"; }, "yet to come"},
    };
    for (const auto& one : uncounted) {
        SCOPED_TRACE(one.words);
        const std::string file = planted(one.change, "board");
        const auto all = found();
        EXPECT_FALSE(says(all["standing"][0], "Record beaten")) << all["standing"];
        EXPECT_TRUE(says(all, one.words)) << layer(all, "attestations").dump(1);
        fs::remove(run() / file);
    }
    planted([](Attestation&) {}, "board");
    close();
    EXPECT_EQ(standing(found()), beaten());
}

TEST_F(Attestations, AreNotLookedForBehindALink) {
    complete();
    fs::rename(run() / "attestations", path("elsewhere"));
    fs::create_directory_symlink(path("elsewhere"), run() / "attestations");
    const auto all = found();
    EXPECT_EQ(all["exit_status"], 1);
    EXPECT_TRUE(says(layer(all, "files"), "a symbolic link"));
    EXPECT_FALSE(says(all["standing"], "Record beaten")) << all["standing"];
    EXPECT_EQ(attest("judge", "judge", {due("judge").front()}).exit_status, 2);
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
    for (const auto& one : other["verdict"]["profiles"][0]["requirements"])
        if (one["status"] == "attest" && one["answered_by"]["role"] == "judge")
            clause = one["clause"];
    const ProcessResult result =
        runcert({"attest", there.string(), clause, "--profile",
                 other["verdict"]["profiles"][0]["profile"].get<std::string>(), "--role", "judge",
                 "--key", key("judge"), "--yes", "--no-render"});
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
    expect_open("lies here, but the close does not list it");
    close();
    all = found();
    EXPECT_EQ(standing(all), beaten());
    EXPECT_TRUE(says(layer(all, "attestations"), "taken back by its signer")) << all.dump(1);
    // A no by somebody whom the roster does not know hinders nobody.
    must_attest("stranger", "judge", {clause}, {"--no"});
    EXPECT_EQ(standing(found()), beaten());
    EXPECT_TRUE(says(found()["standing"], "not on the roster"));
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
    write_file_atomically(path("scan.pdf"), "%PDF-1.7 signed by hand\n");
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

TEST_F(Attestations, OnPaperNeedAScanAndNeverTakeASecretKeyAlong) {  // got through, all
    const std::string clause = due("judge").front();
    write_file_atomically(path("notes.txt"), "signed, really\n");
    write_file_atomically(path("empty.pdf"), "");
    write_file_atomically(path("page.pdf"), "<html>%PDF-1.7\n");
    write_file_atomically(path("ssh"), "-----BEGIN OPENSSH PRIVATE KEY-----\nb3\n");
    write_file_atomically(path("key.pdf"), "%PDF-1.7\n" + read_file(key("judge2")));
    const std::vector<std::pair<std::vector<std::string>, std::string>> refused{
        {{"--paper", path("notes.txt").string()}, "no PDF and no picture"},
        {{"--paper", path("empty.pdf").string()}, "no PDF and no picture"},
        {{"--paper", path("page.pdf").string()}, "no PDF and no picture"},
        {{"--paper", (run() / "report.json").string()}, "no PDF and no picture"},
        {{"--paper", path("key.pdf").string()}, "secret key"},
        {{"--evidence", key("judge")}, "secret key"},
        {{"--evidence", path("ssh").string()}, "secret key"}};
    for (const auto& [more, said] : refused) {
        const ProcessResult result = attest("judge", "judge", {clause}, more);
        EXPECT_EQ(result.exit_status, 2) << more[1];
        EXPECT_NE(result.errors.find(said), std::string::npos) << more[1] << result.errors;
    }
    EXPECT_FALSE(fs::exists(run() / "attestations"));
    using namespace std::string_literals;
    for (const std::string& magic : {"%PDF-1.7\n"s, "\x89PNG\r\n\x1a\n"s, "\xFF\xD8\xFF\xE0"s,
                                     "II*\0\1"s, "MM\0*\1"s, "\0\0\0\x18"s + "ftypheic"}) {
        write_file_atomically(path("scan"), magic);
        must_attest("judge", "judge", {clause}, {"--paper", path("scan").string()});
        must_attest("judge", "judge", {clause}, {"--withdraw"});
    }
}

TEST_F(Attestations, ThatOnlyLookLikeSupersededOnesAreNotCounted) {  // were counted
    const fs::path folder = run() / "superseded" / "0123456789abcdef" / "attestations";
    fs::create_directories(folder);
    write_file_atomically(folder / "answer-0123456789abcdef.json", "no envelope\n");
    fs::create_symlink("/etc/passwd", folder / "answer-0123456789abcde0.json");
    fs::create_directories(folder / "answer-0123456789abcde1.json");
    fs::create_symlink("..", folder / "up");
    const auto layers = layer(found(), "attestations");
    EXPECT_FALSE(says(layers, "to an earlier report")) << layers.dump(1);
    EXPECT_TRUE(says(layers, "no answer, and not counted")) << layers.dump(1);
    EXPECT_TRUE(says(layers, "answer-0123456789abcde0.json is a link")) << layers.dump(1);
    EXPECT_TRUE(says(layers, "answer-0123456789abcdef.json is no envelope")) << layers.dump(1);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
