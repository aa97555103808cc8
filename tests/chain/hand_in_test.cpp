#include "attestations_support.h"
#include "core/text.h"

// What brackets a recording in time and what comes to light between the signatures: receipts of
// what was handed in, the log of what was signed, and the life of a body's roster.

namespace runcert::chain::RUNCERT_FILE {
namespace {

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// A text with one byte changed.
std::string changed(std::string text, std::size_t at) {
    text[at] = text[at] == 'A' ? 'B' : 'A';
    return text;
}

class HandIn : public Attestations {
  protected:
    ProcessResult receive(const std::vector<std::string>& files, const std::string& name,
                          const std::string& out) const {
        std::vector<std::string> words{"receive"};
        words.insert(words.end(), files.begin(), files.end());
        words.insert(words.end(), {"--key", key(name), "--role", name, "--from", "the team",
                                   "--out", (folder() / out).string()});
        return runcert(words);
    }
    fs::path folder() const { return attempt().parent_path(); }
    std::string recording() const { return (folder() / "recording.pos").string(); }
    void name_receipt(const std::string& receipt) const {
        write_file_atomically(attempt(),
                              replaced(read_file(attempt()), "    format: rtklib-pos",
                                       "    format: rtklib-pos\n    receipt: " + receipt));
    }
    static std::string replaced(std::string text, const std::string& from, const std::string& to) {
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    }
    ProcessResult certify_again() const {
        fs::remove_all(run());
        return certify(attempt(), run(), {"--no-render", "--key", key("measurer"), "--quiet"});
    }
    nlohmann::json receipts(const std::string& by = roster()) const {
        return layer(verify_json({"--roster", by}), "receipts");
    }
};

TEST_F(HandIn, AReceiptIsInTheReportTheBundleAndTheVerification) {
    ASSERT_EQ(receive({recording()}, "judge", "receipt.json").exit_status, 0);
    name_receipt("{file: receipt.json}");
    ASSERT_EQ(certify_again().exit_status, 0);
    const std::string report = read_file(run() / "report.json");
    EXPECT_TRUE(holds(report, "by the team: judge signed so"));
    const nlohmann::json found = receipts();
    EXPECT_EQ(found["passed"], true);
    EXPECT_TRUE(holds(found["details"][0], "receipt.primary.json: judge (judge), 20")) << found;
    const ProcessResult packed = runcert(
        {"bundle", run().string(), "--roster", roster(), "--out", path("b.zip").string(), "--zip"});
    EXPECT_EQ(packed.exit_status, 0) << packed.errors;
    EXPECT_TRUE(holds(runcert({"verify", path("b.zip").string(), "--roster", roster()}).output,
                      "yes  receipts"));
    // Without it, nothing else of the outcome is another.
    const auto outcomes = [&] {
        std::string all;
        const nlohmann::json read = nlohmann::json::parse(read_file(run() / "report.json"));
        for (const auto& one : read["predicate"]["verdict"]["profiles"])
            all += one["reason"].get<std::string>() + one["speed_km_h"].dump();
        return all;
    };
    const std::string with = outcomes();
    write_file_atomically(
        attempt(), replaced(read_file(attempt()), "    receipt: {file: receipt.json}\n", ""));
    certify_again();
    EXPECT_EQ(outcomes(), with);
}

TEST_F(HandIn, AReceiptByAKeyThatTheRosterLacksIsSaidToBeOne) {
    ASSERT_EQ(receive({recording()}, "stranger", "receipt.json").exit_status, 0);
    name_receipt("{file: receipt.json}");
    certify_again();
    EXPECT_TRUE(holds(receipts()["details"][0], "its key is not on the roster"));
}

TEST_F(HandIn, AReceiptOfAnotherRecordingOrAChangedOneIsRefused) {
    const std::string other = (examples / "rejected/recording.pos").string();
    ASSERT_EQ(receive({other}, "judge", "receipt.json").exit_status, 0);
    name_receipt("{file: receipt.json}");
    const ProcessResult of_another = certify_again();
    EXPECT_EQ(of_another.exit_status, 2);
    EXPECT_TRUE(holds(of_another.errors, "does not name the recording")) << of_another.errors;
    EXPECT_TRUE(holds(of_another.errors, "receipt.primary.json")) << of_another.errors;

    fs::remove(folder() / "receipt.json");
    ASSERT_EQ(receive({other, recording()}, "judge", "receipt.json").exit_status, 0);
    EXPECT_EQ(certify_again().exit_status, 0);
    const std::string receipt = read_file(folder() / "receipt.json");
    for (const double part : {0.02, 0.3, 0.6, 0.95}) {
        write_file_atomically(
            folder() / "receipt.json",
            changed(receipt, static_cast<std::size_t>(part * static_cast<double>(receipt.size()))));
        const ProcessResult result = certify_again();
        EXPECT_EQ(result.exit_status, 2) << part;
        EXPECT_TRUE(holds(result.errors, "receipt")) << result.errors;
    }
    // In a run folder, with the report's hash of it mended.
    write_file_atomically(folder() / "receipt.json", receipt);
    certify_again();
    write_file_atomically(run() / "receipt.primary.json", changed(receipt, receipt.size() / 2));
    fix_hash("receipt.primary.json");
    EXPECT_EQ(receipts()["passed"], false);
}

TEST_F(HandIn, NoReceiptIsWrittenOfNothingOrOverAnother) {
    write_file_atomically(path("empty"), "");
    EXPECT_EQ(receive({path("empty").string()}, "judge", "r.json").exit_status, 2);
    EXPECT_EQ(receive({path("missing").string()}, "judge", "r.json").exit_status, 2);
    EXPECT_FALSE(fs::exists(folder() / "r.json"));
    ASSERT_EQ(receive({recording()}, "judge", "r.json").exit_status, 0);
    const std::string first = read_file(folder() / "r.json");
    EXPECT_EQ(receive({recording()}, "judge", "r.json").exit_status, 2);
    EXPECT_EQ(read_file(folder() / "r.json"), first);
}

class BodyLog : public Attestations {
  protected:
    std::string log() const { return path("body.log").string(); }
    ProcessResult sign_logged(const fs::path& run_dir, const std::string& name) const {
        return runcert({"sign", run_dir.string(), "--key", key(name), "--role", name, "--no-render",
                        "--no-recompute", "--log", log()});
    }
    ProcessResult show(std::vector<std::string> more = {}) const {
        more.insert(more.begin(), {"log", log()});
        return runcert(more);
    }
    nlohmann::json logged(const std::string& by = roster()) const {
        return layer(verify_json({"--roster", by}), "log");
    }
    /// Two reports of one attempt, and the recording of another craft's run.
    void sign_three() const {
        ASSERT_EQ(sign_logged(run(), "measurer").exit_status, 0);
        certify(attempt(true), path("second"), {"--no-render"});
        ASSERT_EQ(sign_logged(path("second"), "measurer").exit_status, 0);
        const fs::path other = path("stolen/attempt.yaml");
        fs::copy(examples / "salt_lake", path("stolen"), fs::copy_options::recursive);
        std::string text = read_file(other);
        for (const auto& [from, to] :
             {std::pair("id: salt-lake", "id: another"), {"simulated land yacht", "another yacht"}})
            text.replace(text.find(from), std::string_view(from).size(), to);
        write_file_atomically(other, text);
        certify(other, path("third"), {"--no-render"});
        ASSERT_EQ(sign_logged(path("third"), "judge").exit_status, 0);
    }
};

TEST_F(BodyLog, TwoReportsOfAnAttemptAndARecordingOfTwoCraftComeToLight) {
    ASSERT_EQ(sign_logged(run(), "measurer").exit_status, 0);
    EXPECT_EQ(show().exit_status, 0);
    fs::remove(log());
    sign_three();
    const ProcessResult found = show();
    EXPECT_EQ(found.exit_status, 1);
    EXPECT_TRUE(holds(found.output, "Entries 1 and 2 are two reports of the attempt salt-lake."))
        << found.output;
    EXPECT_TRUE(holds(found.output,
                      "Entries 1 and 3 have one recording, in the attempts salt-lake "
                      "(simulated land yacht) and another (another yacht)."))
        << found.output;
}

TEST_F(BodyLog, WhoHasAnEarlierHeadSeesWhatWasTakenOutOrChanged) {
    sign_three();
    const std::string head = path("head.json").string();
    ASSERT_EQ(show({"--head", head, "--key", key("board")}).exit_status, 1);
    const std::string whole = read_file(log());
    const auto first_end = whole.find('\n') + 1, second_end = whole.find('\n', first_end) + 1;
    const std::string first = whole.substr(0, first_end),
                      second = whole.substr(first_end, second_end - first_end),
                      third = whole.substr(second_end);
    EXPECT_TRUE(holds(show({"--since", head}).output, "yes      the first 3 entries"));
    ASSERT_EQ(sign_logged(run(), "judge").exit_status, 0);
    EXPECT_TRUE(holds(show({"--since", head}).output, "yes      the first 3 entries"));
    for (const std::string& forged :
         {first + third, second + first + third, first + second, first + second + first}) {
        write_file_atomically(log(), forged);
        const ProcessResult result = show({"--since", head});
        EXPECT_EQ(result.exit_status, 1);
        EXPECT_TRUE(holds(result.output, "NO       the first 3 entries")) << result.output;
    }
    // A head of others' making, or a changed one.
    const std::string text = read_file(head);
    write_file_atomically(head, changed(text, text.size() / 2));
    EXPECT_EQ(show({"--since", head}).exit_status, 2);
}

TEST_F(BodyLog, NothingIsTakenFromALogThatDoesNotParse) {
    sign_three();
    const std::string whole = read_file(log());
    const std::size_t in_second = whole.find('\n') + 3;
    for (const std::string& bad :
         {whole.substr(0, whole.size() - 1), std::string(whole).replace(in_second, 1, "Q"),
          std::string(whole).insert(in_second, " ")}) {
        write_file_atomically(log(), bad);
        const ProcessResult result = show();
        EXPECT_EQ(result.exit_status, 2);
        EXPECT_TRUE(holds(result.errors, "entry ")) << result.errors;
        EXPECT_EQ(result.output, "");
        const std::map<std::string, std::string> before = contents_of(run());
        EXPECT_EQ(sign_logged(run(), "judge").exit_status, 2);
        EXPECT_EQ(read_file(log()), bad);
        EXPECT_EQ(contents_of(run()), before);
    }
}

TEST_F(BodyLog, AReportProvesThatItIsInTheLog) {
    sign_three();
    ASSERT_EQ(show({"--prove", run().string(), "--key", key("board")}).exit_status, 1);
    nlohmann::json found = logged();
    EXPECT_EQ(found["passed"], true);
    EXPECT_TRUE(holds(found["finding"], "entry 1 of 3")) << found;
    const ProcessResult packed = runcert(
        {"bundle", run().string(), "--roster", roster(), "--out", path("b.zip").string(), "--zip"});
    EXPECT_EQ(packed.exit_status, 0) << packed.errors;
    EXPECT_TRUE(holds(runcert({"verify", path("b.zip").string(), "--roster", roster()}).output,
                      "yes  log"));
    // Of another report, changed, or by a key that nobody vouches for.
    const std::string proof = read_file(run() / "report.json.logged");
    fs::copy_file(run() / "report.json.logged", path("third") / "report.json.logged");
    EXPECT_TRUE(holds(runcert({"verify", path("third").string(), "--roster", roster()}).output,
                      "its entry is that of another report"));
    for (const std::string part : {"\"index\":0", "\"path\":[\"", "report_sha256"}) {
        const std::size_t at = proof.find(part) + part.size() - 1;
        write_file_atomically(run() / "report.json.logged",
                              std::string(proof).replace(at, 1, proof[at] == '1' ? "2" : "1"));
        EXPECT_EQ(logged()["passed"], false) << part;
    }
    ASSERT_EQ(show({"--prove", run().string(), "--key", key("stranger")}).exit_status, 1);
    found = logged();
    EXPECT_EQ(found["answer"], "not checkable here") << found;
    // Certified again with another report, the proof goes with what it proved.
    certify(attempt(true), run(), {"--no-render"});
    EXPECT_FALSE(fs::exists(run() / "report.json.logged"));
}

class RosterLife : public Attestations {
  protected:
    std::string write_roster(const std::string& name, const std::string& lines) const {
        std::string text;
        for (const char* one : {"measurer", "judge", "board", "judge2"})
            text += lines_[one] + "\n";
        write_file_atomically(path(name), text + lines);
        return path(name).string();
    }
    static std::string key_of(const std::string& name) {
        return lines_[name].substr(lines_[name].find("ssh-ed25519"), 80);
    }
    ProcessResult follow(const std::string& roster, const std::string& earlier) const {
        return runcert({"roster", roster, "--after", earlier});
    }
    void sign_roster(const std::string& roster, const std::string& name,
                     const std::string& role) const {
        const ProcessResult result =
            runcert({"roster", roster, "--key", key(name), "--role", role});
        ASSERT_EQ(result.exit_status, 0) << result.errors;
    }
};

TEST_F(RosterLife, IsRolledOverByAThresholdOfTheEarlierKeys) {
    const std::string first = write_roster("first", "#runcert successor board=1,judge=2\n");
    const std::string follows = "#runcert follows " + sha256_hex(read_file(first)) + "\n";
    // A new one without the second judge, with a stranger as the board.
    const std::string next = path("next").string();
    write_file_atomically(next, lines_["measurer"] + "\n" + lines_["judge"] + "\n" +
                                    line_for("stranger", "board") + "\n" + follows);
    EXPECT_EQ(follow(next, first).exit_status, 1);
    sign_roster(next, "stranger", "board");  // its own key does not count for it
    sign_roster(next, "judge", "judge");
    sign_roster(next, "judge", "board");  // in a role that the roster does not give it
    EXPECT_EQ(follow(next, first).exit_status, 1);
    sign_roster(next, "judge2", "judge");
    EXPECT_EQ(follow(next, first).exit_status, 1);
    sign_roster(next, "board", "board");
    const ProcessResult whole = follow(next, first);
    EXPECT_EQ(whole.exit_status, 0) << whole.output;
    EXPECT_TRUE(holds(whole.output, "It follows the earlier roster.")) << whole.output;
    // Another one with these signatures, or one that follows another, does not.
    const std::string text = read_file(next);
    write_file_atomically(next, text + "# one more line\n");
    EXPECT_EQ(follow(next, first).exit_status, 1);
    write_file_atomically(next, text);
    write_file_atomically(first, read_file(first) + "# one more line\n");
    EXPECT_EQ(follow(next, first).exit_status, 1);
}

TEST_F(RosterLife, ARevokedKeyCountsNoMore) {
    must_sign("measurer", "measurer");
    const std::string revoked =
        write_roster("revoked", "#runcert revoked 20260101Z \"the key was copied\" " +
                                    key_of("measurer") + "\n");
    const nlohmann::json found = verify_json({"--roster", revoked});
    EXPECT_EQ(found["exit_status"], 1);
    EXPECT_TRUE(says(signer(found, "report.json.minisig")["reason"], "the key was copied"))
        << found;
    // Before that time it did, of what is stamped then.
    const std::string later = write_roster(
        "later", "#runcert revoked 20990101Z \"retired\" " + key_of("measurer") + "\n");
    EXPECT_EQ(verify({"--roster", later}).exit_status, 0);
    EXPECT_TRUE(holds(runcert({"roster", revoked}).output, "REVOKED as of 2026-01-01T00:00:00Z"));
}

TEST_F(RosterLife, AnExpiredOneVouchesForNobody) {
    must_sign("measurer", "measurer");
    const std::string expired = write_roster("expired", "#runcert valid-until 20260101Z\n");
    const ProcessResult result = verify({"--roster", expired});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_TRUE(holds(result.errors, "was in force until 2026-01-01T00:00:00Z")) << result.errors;
    EXPECT_EQ(runcert({"sign", run().string(), "--key", key("judge"), "--role", "judge", "--roster",
                       expired, "--no-recompute"})
                  .exit_status,
              2);
    EXPECT_EQ(follow(write_roster("next", ""), expired).exit_status, 2);
    EXPECT_EQ(
        verify({"--roster", write_roster("now", "#runcert valid-until 20990101Z\n")}).exit_status,
        0);
}

TEST_F(RosterLife, ItsRecordGoesBeforeTheAttempts) {
    complete();
    const auto standing = [&](const std::string& line) {
        const std::string by = write_roster("by", line);
        return verify_json({"--roster", by})["standing"].dump();
    };
    const std::string same = "#runcert record nalsa land-yacht 222.43 km/h \"the body's list\"\n";
    EXPECT_TRUE(holds(standing(same), "Record beaten")) << standing(same);
    EXPECT_TRUE(holds(standing("#runcert record nalsa land-yacht 61.7861 m/s \"list\"\n"),
                      "Record beaten"));
    EXPECT_TRUE(
        holds(standing("#runcert record nalsa ice-yacht 230 km/h \"list\"\n"), "Record beaten"));
    const std::string higher =
        standing("#runcert record nalsa land-yacht 230 km/h \"a list of May\"\n");
    EXPECT_FALSE(holds(higher, "Record beaten")) << higher;
    EXPECT_TRUE(holds(higher, "another record stands by the roster, 230 km/h (a list of May)"))
        << higher;
}

TEST_F(RosterLife, ALineThatIsNotUnderstoodIsRefused) {
    for (const std::string& line :
         {std::string("#runcert valid-until soon"), std::string("#runcert valid-until"),
          std::string("#runcert successor board=0"), std::string("#runcert follows 0123"),
          "#runcert revoked 20260101Z " + key_of("judge"),
          "#runcert revoked 20260101Z \"why\" " + key_of("stranger"),
          std::string("#runcert record nalsa land-yacht 200 \"list\""),
          std::string("#runcert record nalsa land-yacht fast km/h \"list\""),
          std::string("#runcert record nalsa land-yacht 200 km/h \"list\" more"),
          std::string("#runcert records")}) {
        const ProcessResult result = runcert({"roster", write_roster("bad", line + "\n")});
        EXPECT_EQ(result.exit_status, 2) << line;
        EXPECT_NE(result.errors, "") << line;
    }
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
