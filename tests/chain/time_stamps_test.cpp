#include <chrono>

#include "signatures_support.h"
#include "store/utc_second.h"
#include "trust/time_stamp.h"
#include "trust/verification.h"

// Time stamps, by an authority that openssl is.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// A certificate authority and a time stamp authority under it.
class TimeStamps : public SignedRuns {
  protected:
    void SetUp() override {
        SignedRuns::SetUp();
        make_authority("ca");
        must_sign("measurer", "measurer");
    }
    /// NAME.pem is its root; NAME.tsa.pem the certificate that signs stamps.
    void make_authority(const std::string& name) const {
        const auto file = [&](const std::string& end) { return path(name + end).string(); };
        write_file_atomically(file(".ext"), "extendedKeyUsage=critical,timeStamping\n");
        write_file_atomically(file(".serial"), "1000\n");
        write_file_atomically(file(".cnf"),
                              fmt::format("[tsa]\ndefault_tsa=authority\n[authority]\nserial={}\n"
                                          "signer_digest=sha256\ndefault_policy=1.2.3.4\n"
                                          "digests=sha512\n",
                                          file(".serial")));
        must({"openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256",
              "-nodes", "-keyout", file(".key"), "-out", file(".pem"), "-subj", "/CN=root of test",
              "-days", "30"});
        must({"openssl", "req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes",
              "-keyout", file(".tsa.key"), "-out", file(".csr"), "-subj", "/CN=stamps of test"});
        must({"openssl", "x509", "-req", "-in", file(".csr"), "-CA", file(".pem"), "-CAkey",
              file(".key"), "-CAcreateserial", "-days", "20", "-extfile", file(".ext"), "-out",
              file(".tsa.pem")});
    }
    static void must(const std::vector<std::string>& command) {
        const ProcessResult result = run_process(command);
        ASSERT_EQ(result.exit_status, 0) << result.errors;
    }
    /// What the authority answers to the query of a signature.
    std::string reply(const std::string& authority, const std::string& signature) const {
        const std::string answer = path(authority + ".reply").string();
        must({"openssl", "ts", "-reply", "-config", path(authority + ".cnf").string(), "-section",
              "authority", "-queryfile", (run() / (signature + ".tsq")).string(), "-signer",
              path(authority + ".tsa.pem").string(), "-inkey",
              path(authority + ".tsa.key").string(), "-out", answer});
        return answer;
    }
    ProcessResult timestamp(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{"timestamp", run().string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments);
    }
    void must_stamp(const std::string& signature) const {
        ASSERT_EQ(timestamp().exit_status, 0);
        const ProcessResult taken = timestamp({"--reply", reply("ca", signature), "--ca", ca()});
        ASSERT_EQ(taken.exit_status, 0) << taken.errors;
        ASSERT_TRUE(fs::exists(run() / (signature + ".tsr")));
    }
    std::string ca() const { return path("ca.pem").string(); }
    static std::string valid_before(UtcSecond time) {
        return fmt::format("valid-before=\"{}\"", compact_text(time));
    }
    /// The present, moved.
    static UtcSecond in(std::chrono::seconds later) {
        return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()) + later;
    }
};

TEST_F(TimeStamps, LetASignatureOfAnExpiredKeyCount) {
    const std::string expiring =
        roster_of({line_with("measurer", valid_before(in(std::chrono::hours(1))))});
    const std::string next_year = iso_text(in(std::chrono::days(365)));
    const std::vector<std::string> later{"--roster", expiring, "--at", next_year};
    EXPECT_TRUE(says(verify_json(later)["signers"], "only a time stamp"));
    must_stamp("report.json.minisig");
    // Unchecked, it does not count.
    auto found = verify_json(later);
    EXPECT_EQ(layer(found, "time stamps")["passed"], nullptr);
    EXPECT_TRUE(says(layer(found, "time stamps"), "unchecked"));
    EXPECT_EQ(found["exit_status"], 1);
    std::vector<std::string> checked = later;
    checked.insert(checked.end(), {"--tsa-ca", ca()});
    found = verify_json(checked);
    EXPECT_EQ(found["exit_status"], 0) << found.dump(1);
    EXPECT_EQ(layer(found, "time stamps")["passed"], true);
    EXPECT_EQ(signer(found, "report.json.minisig")["time_source"], "time stamp");
    // The time is the one that openssl itself reads.
    const ProcessResult shown = run_process(
        {"openssl", "ts", "-reply", "-in", (run() / "report.json.minisig.tsr").string(), "-text"});
    const std::string time = signer(found, "report.json.minisig")["time"];
    EXPECT_NE(shown.output.find(fmt::format(" {} {} GMT", time.substr(11, 8), time.substr(0, 4))),
              std::string::npos)
        << time << shown.output;
}

TEST_F(TimeStamps, FromAfterTheKeysEndDoNotHelp) {
    must_stamp("report.json.minisig");
    const std::string expired =
        roster_of({line_with("measurer", valid_before(in(-std::chrono::hours(1))))});
    const auto found = verify_json({"--roster", expired, "--tsa-ca", ca()});
    EXPECT_EQ(found["exit_status"], 1);
    EXPECT_TRUE(says(signer(found, "report.json.minisig")["reason"], "the time of its time stamp"))
        << found.dump(1);
}

TEST_F(TimeStamps, OfAnotherAuthorityAreRefused) {
    make_authority("other");
    must_stamp("report.json.minisig");
    const auto found = verify_json({"--roster", roster(), "--tsa-ca", path("other.pem").string()});
    EXPECT_EQ(found["exit_status"], 1);
    EXPECT_EQ(layer(found, "time stamps")["passed"], false);
    EXPECT_TRUE(says(layer(found, "time stamps"), "does not hold")) << found.dump(1);
    EXPECT_EQ(
        verify({"--roster", roster(), "--tsa-ca", path("other.pem").string(), "--tsa-ca", ca()})
            .exit_status,
        0);
    const ProcessResult none = verify({"--roster", roster(), "--tsa-ca", public_key("measurer")});
    EXPECT_EQ(none.exit_status, 2);
    EXPECT_NE(none.errors.find("no certificate"), std::string::npos) << none.errors;
    fs::remove(run() / "report.json.minisig.tsr");
    ASSERT_EQ(timestamp().exit_status, 0);
    const ProcessResult refused =
        timestamp({"--reply", reply("other", "report.json.minisig"), "--ca", ca()});
    EXPECT_EQ(refused.exit_status, 2);
    EXPECT_NE(refused.errors.find("does not hold"), std::string::npos) << refused.errors;
    EXPECT_FALSE(fs::exists(run() / "report.json.minisig.tsr"));
}

TEST_F(TimeStamps, AreOfOneSignatureAlone) {
    must_sign("judge", "judge");
    must_stamp("report.json.minisig");
    fs::rename(run() / "report.json.minisig.tsr", run() / "report.json.judge.minisig.tsr");
    auto found = verify_json({"--roster", roster(), "--tsa-ca", ca()});
    EXPECT_EQ(layer(found, "time stamps")["passed"], false);
    EXPECT_TRUE(says(layer(found, "time stamps"), "imprint mismatch")) << found.dump(1);
    fs::rename(run() / "report.json.judge.minisig.tsr", run() / "report.json.x.minisig.tsr");
    found = verify_json({"--roster", roster(), "--tsa-ca", ca()});
    EXPECT_EQ(found["exit_status"], 1);
    EXPECT_TRUE(says(layer(found, "time stamps"), "is not there")) << found.dump(1);
}

TEST_F(TimeStamps, AReplyFindsItsQuery) {
    must_sign("judge", "judge");
    const ProcessResult asked = timestamp();
    ASSERT_EQ(asked.exit_status, 0) << asked.errors;
    EXPECT_NE(asked.output.find(fmt::format("--data-binary '@{}'",
                                            (run() / "report.json.judge.minisig.tsq").string())),
              std::string::npos)
        << asked.output;
    const ProcessResult shown = run_process(
        {"openssl", "ts", "-query", "-in", (run() / "report.json.minisig.tsq").string(), "-text"});
    EXPECT_NE(shown.output.find("Hash Algorithm: sha512"), std::string::npos) << shown.output;
    EXPECT_NE(shown.output.find("Certificate required: yes"), std::string::npos) << shown.output;
    EXPECT_EQ(shown.output.find("Nonce: unspecified"), std::string::npos) << shown.output;
    // A query that is under way stays as it is.
    const std::string query = read_file(run() / "report.json.minisig.tsq");
    ASSERT_EQ(timestamp().exit_status, 0);
    EXPECT_EQ(read_file(run() / "report.json.minisig.tsq"), query);
    const ProcessResult taken = timestamp({"--reply", reply("ca", "report.json.judge.minisig")});
    EXPECT_EQ(taken.exit_status, 0) << taken.errors;
    EXPECT_NE(taken.output.find("was not checked"), std::string::npos) << taken.output;
    EXPECT_TRUE(fs::exists(run() / "report.json.judge.minisig.tsr"));
    EXPECT_FALSE(fs::exists(run() / "report.json.minisig.tsr"));
}

TEST_F(TimeStamps, RepliesToNothingAreRefused) {
    ASSERT_EQ(timestamp().exit_status, 0);
    const std::string answer = reply("ca", "report.json.minisig");
    const auto refused = [&](const std::string& file, const std::string& said) {
        const ProcessResult result = timestamp({"--reply", file});
        EXPECT_EQ(result.exit_status, 2);
        EXPECT_NE(result.errors.find(said), std::string::npos) << result.errors;
        EXPECT_FALSE(fs::exists(run() / "report.json.minisig.tsr"));
    };
    refused(key("measurer"), "not a reply of a time stamp authority");
    refused(path("nowhere").string(), "nowhere");
    // The signature was made again after the query.
    const std::string query = read_file(run() / "report.json.minisig.tsq");
    must_sign("measurer", "measurer");
    refused(answer, "answers none of the queries");
    write_file_atomically(run() / "report.json.minisig.tsq", query);
    change("report.json.minisig", "untrusted comment: ", "untrusted comment: x");
    refused(answer, "changed after its query was made");
    // What the authority says where it refuses: the digest is not one of its own.
    write_file_atomically(path("ca.cnf"), read_file(path("ca.cnf")) + "digests=sha256\n");
    refused(reply("ca", "report.json.minisig"), "The authority gave no time stamp");
}

TEST_F(TimeStamps, AnyChangedByteOfAStampIsFound) {
    must_stamp("report.json.minisig");
    const fs::path file = run() / "report.json.minisig.tsr";
    const TimeStamp whole = read_time_stamp_reply(file);
    const std::string bytes = read_file(file);
    std::size_t refused = 0;
    std::size_t tried = 0;
    for (std::size_t at = 0; at < bytes.size(); at += 41) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ 1);
        write_file_atomically(file, changed);
        const TimeStampCheck check = check_time_stamp(run() / "report.json.minisig", file, {ca()});
        ++tried;
        refused += check.valid ? 0U : 1U;
        // Not every byte of a reply is signed, but none of them can move the time.
        if (check.valid) {
            EXPECT_EQ(check.time, whole.time) << at;
        }
    }
    EXPECT_GT(refused, tried * 3 / 4);
    // What stands behind it openssl would not look at.
    write_file_atomically(file, bytes + "\n");
    EXPECT_FALSE(check_time_stamp(run() / "report.json.minisig", file, {ca()}).valid);
}

TEST_F(TimeStamps, WithoutTheProgramsThatCheckItIsSaidWhatToInstall) {
    must_stamp("report.json.minisig");
    const Environment without{{"RUNCERT_EXTERNAL_PATH", "/nonexistent"}};
    std::string by = roster();
    const auto verified = [&] {
        return runcert({"verify", run().string(), "--roster", by, "--tsa-ca", ca()}, without);
    };
    // The signature stands without its stamp, which the last line says was not checked.
    const ProcessResult unstamped = verified();
    EXPECT_EQ(unstamped.exit_status, 0) << unstamped.errors;
    EXPECT_TRUE(says(unstamped.output, "openssl is not installed here (package openssl)"));
    EXPECT_TRUE(says(unstamped.output, "; time stamps not checked here"));
    must({"ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", path("k").string()});
    must({"ssh-keygen", "-q", "-Y", "sign", "-n", "judge@runcert", "-f", path("k").string(),
          (run() / "report.json").string()});
    // One by a key that is not on the roster hinders nobody; one that could count must be checked.
    EXPECT_EQ(verified().exit_status, 0);
    by = roster_of({lines_["measurer"], "judge " + read_file(path("k.pub"))});
    const ProcessResult unsigned_here = verified();
    EXPECT_EQ(unsigned_here.exit_status, 2) << unsigned_here.output;
    EXPECT_TRUE(says(unsigned_here.errors, "Install the package openssh-client"));
}

TEST_F(TimeStamps, OverAHashThatTwoFilesCanShareAreRefused) {
    write_file_atomically(path("ca.cnf"), read_file(path("ca.cnf")) + "digests=sha1,sha256\n");
    for (const auto& [hash, holds] : {std::pair("-sha1", false), {"-sha256", true}}) {
        must({"openssl", "ts", "-query", "-data", (run() / "report.json.minisig").string(), hash,
              "-cert", "-out", (run() / "report.json.minisig.tsq").string()});
        fs::copy_file(reply("ca", "report.json.minisig"), run() / "report.json.minisig.tsr",
                      fs::copy_options::overwrite_existing);
        const auto stamps =
            layer(verify_json({"--roster", roster(), "--tsa-ca", ca()}), "time stamps");
        EXPECT_EQ(stamps["passed"], holds) << stamps;
        EXPECT_EQ(says(stamps, "which another file can share"), !holds) << stamps;
    }
}

TEST_F(TimeStamps, FromTheFutureDoNotHold) {
    must_stamp("report.json.minisig");
    const ReportFacts report = read_report_facts(run());
    const auto stamps_at = [&](UtcSecond present) {
        return verify_signatures(run(), report,
                                 {.roster = parse_roster(read_file(roster()), "roster"),
                                  .present = present,
                                  .at = in({}),
                                  .time_stamp_cas = {ca()}})
            .time_stamps;
    };
    EXPECT_TRUE(stamps_at(in({})).is(LayerAnswer::verified));
    const VerificationStep early = stamps_at(in(-std::chrono::hours(1)));
    EXPECT_TRUE(early.is(LayerAnswer::not_verified));
    EXPECT_NE(early.details.front().find("yet to come"), std::string::npos);
}

TEST_F(TimeStamps, OfAnUnsignedRunCannotBeMade) {
    fs::remove(run() / "report.json.minisig");
    const ProcessResult result = timestamp();
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_NE(result.errors.find("not signed"), std::string::npos) << result.errors;
}

TEST_F(TimeStamps, OfAReceiptShowWhenItsRecordingWasThere) {
    const fs::path folder = attempt().parent_path();
    const std::string receipt = (folder / "receipt.json").string();
    ASSERT_EQ(runcert({"receive", (folder / "recording.pos").string(), "--key", key("judge"),
                       "--role", "judge", "--out", receipt})
                  .exit_status,
              0);
    ASSERT_EQ(runcert({"timestamp", receipt}).exit_status, 0);
    fs::copy_file(receipt + ".tsq", run() / "receipt.json.tsq");
    const std::string answer = reply("ca", "receipt.json");
    make_authority("other");
    EXPECT_EQ(runcert({"timestamp", receipt, "--reply", answer, "--ca", path("other.pem").string()})
                  .exit_status,
              2);
    ASSERT_EQ(runcert({"timestamp", receipt, "--reply", answer, "--ca", ca()}).exit_status, 0);
    std::string text = read_file(attempt());
    const std::string format = "    format: rtklib-pos";
    text.insert(text.find(format),
                "    receipt: {file: receipt.json, time_stamp: receipt.json.tsr}\n");
    write_file_atomically(attempt(), text);
    fs::remove_all(run());
    certify(attempt(), run(), {"--no-render", "--key", key("measurer")});
    const std::vector<std::string> unchecked{"--roster", roster()};
    std::vector<std::string> checked = unchecked;
    checked.insert(checked.end(), {"--tsa-ca", ca()});
    EXPECT_TRUE(says(layer(verify_json(checked), "receipts"), "; time-stamped 20"));
    EXPECT_TRUE(says(layer(verify_json(unchecked), "receipts"), "is checked with --tsa-ca"));
    checked.back() = path("other.pem").string();
    EXPECT_EQ(layer(verify_json(checked), "receipts")["passed"], false);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
