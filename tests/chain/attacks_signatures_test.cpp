// Who signed, with what, and when: what a claimant, a weak key or a clock can make of it. Each test
// says what came of it before.
#include "signatures_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

class AttacksOnSignatures : public SignedRuns {
  protected:
    nlohmann::json signatures(const std::vector<std::string>& keys) const {
        return layer(verify_json(keys), "signatures");
    }
    /// A roster of both keys that asks for signatures itself.
    std::string asking_roster(const std::string& line) const {
        return roster_of({lines_["measurer"], line, lines_["judge"]});
    }
    /// Signs by minisign itself, with what the signer states; a trusted comment is one's own.
    void sign_stating(const std::string& name, const std::string& role,
                      const std::string& time) const {
        const auto report = nlohmann::json::parse(read_file(run() / "report.json"))["predicate"];
        const std::string text = read_file(public_key(name));
        const std::string line =
            text.substr(text.find('\n') + 1, text.size() - text.find('\n') - 2);
        const ProcessResult result = run_process(
            {"minisign", "-S", "-s", key(name), "-m", (run() / "report.json").string(), "-t",
             fmt::format("runcert report={} attempt={} role={} key={} signed={}",
                         report["report_id"].get<std::string>(),
                         report["attempt"]["id"].get<std::string>(), role, line, time)});
        ASSERT_EQ(result.exit_status, 0) << result.errors;
    }
    /// Signs by ssh-keygen with a new key of that type and length.
    void sign_by_ssh(const std::string& type, const std::string& bits) const {
        ASSERT_EQ(run_process({"ssh-keygen", "-q", "-t", type, "-b", bits, "-N", "", "-f",
                               path("ssh").string()})
                      .exit_status,
                  0);
        ASSERT_EQ(run_process({"ssh-keygen", "-q", "-Y", "sign", "-n", "measurer@runcert", "-f",
                               path("ssh").string(), (run() / "report.json").string()})
                      .exit_status,
                  0);
    }
};

// Had held: of each role the most counts. No attempt does with less than its rule.
TEST_F(AttacksOnSignatures, Sign01AnAttemptLowersNothing) {
    fs::copy(examples / "salt_lake", path("attempt"), fs::copy_options::recursive);
    const fs::path attempt = path("attempt") / "attempt.yaml";
    write_file_atomically(
        path("attempt") / "ours.yaml",
        "schema: profile/1.0\nid: ours\nbody: ours\ntitle: ours\n"
        "window: {duration_s: 3, definition: displacement}\n"
        "margin: {kind: absolute, value: 1, unit: km/h}\n"
        "signatures: [{role: judge, count: 2}]\n"
        "clauses:\n  - {id: a, text: t, source: s, certainty: quoted, decided_by: attest}\n");
    std::string text = read_file(attempt);
    text.erase(text.find("profiles:"));
    text += "profiles: [ours.yaml]\n";
    for (const char* asks :
         {"[{role: judge}]", "[{role: judge, count: 1}]", "[{role: measurer}]"}) {
        write_file_atomically(attempt, text + "signatures: " + asks + "\n");
        fs::remove_all(run());
        const ProcessResult made = certify(attempt, run(), {"--no-render"});
        ASSERT_LT(made.exit_status, 2) << made.errors;
        must_sign("judge", "judge");
        const auto found = signatures({"--roster", roster()});
        EXPECT_TRUE(says(found["details"], "needed: 2 in the role judge; there: 1")) << found;
        EXPECT_EQ(found["passed"], false);
    }
    for (const char* asks : {"[{role: judge, count: 0}]", "[{role: judge, count: -1}]"}) {
        write_file_atomically(attempt, text + "signatures: " + asks + "\n");
        EXPECT_EQ(certify(attempt, path("none"), {"--no-render"}).exit_status, 2) << asks;
    }
}

// Got through: a roster could not ask, so that an attempt that asks for nobody needed one signature
// of anybody's.
TEST_F(AttacksOnSignatures, Sign02ARosterAsksForSignaturesWhateverTheAttemptDoes) {
    must_sign("measurer", "measurer");
    const std::string asking = asking_roster("#runcert signatures measurer,judge=1");
    auto found = signatures({"--roster", asking});
    EXPECT_EQ(found["passed"], false) << found;
    EXPECT_TRUE(says(found["finding"], "1 of judge")) << found;
    must_sign("judge", "judge");
    EXPECT_EQ(signatures({"--roster", asking})["passed"], true);
    // Other comments are comments, and ssh-keygen takes this one for such.
    EXPECT_EQ(
        signatures({"--roster", asking_roster("# the body keeps this for runcert")})["passed"],
        true);
    sign_by_ssh("ed25519", "256");
    const std::string listed =
        roster_of({"#runcert signatures measurer", "measurer " + read_file(path("ssh.pub"))});
    EXPECT_EQ(signer(verify_json({"--roster", listed}), "report.json.sig")["valid"], true);
}

// Got through, as Sign02: neither lowers what the other asks for.
TEST_F(AttacksOnSignatures, Sign03OfRosterAndAttemptTheMostCounts) {
    certify_asking_for("{role: judge, count: 2}, {role: measurer}");
    must_sign("measurer", "measurer");
    must_sign("judge", "judge");
    auto found = signatures({"--roster", asking_roster("#runcert signatures judge")});
    EXPECT_TRUE(says(found["details"], "needed: 2 in the role judge; there: 1")) << found;
    found = signatures({"--roster", asking_roster("#runcert signatures measurer=2")});
    EXPECT_TRUE(says(found["finding"], "1 of judge and 1 of measurer")) << found;
}

// A line that asks for something and is not understood would ask for nothing.
TEST_F(AttacksOnSignatures, Sign04WhatARosterAsksForIsUnderstoodOrRefused) {
    must_sign("measurer", "measurer");
    for (const char* line : {"#runcert", "#runcert signatures", "#runcert signature judge",
                             "#runcert signatures judge=0", "#runcert signatures judge=-1",
                             "#runcert signatures judge=100", "#runcert signatures judge,judge=2",
                             "#runcert signatures judge measurer", "#runcert signatures j@dge",
                             "#runcert signatures judge,", "#runcertsignatures judge"}) {
        const ProcessResult result = verify({"--roster", asking_roster(line)});
        EXPECT_EQ(result.exit_status, 2) << line << result.output;
        EXPECT_NE(result.errors.find("roster, line 2"), std::string::npos) << result.errors;
    }
}

// Got through: a key that was given counted in whatever role its owner wrote.
TEST_F(AttacksOnSignatures, Sign05AKeyGivenForARoleCountsInThatOneAlone) {
    certify_asking_for("{role: judge}");
    must_sign("measurer", "judge");
    EXPECT_EQ(signatures({"--pubkey", public_key("measurer")})["passed"], true);
    const auto found = verify_json({"--pubkey", "measurer=" + public_key("measurer")});
    EXPECT_EQ(layer(found, "signatures")["passed"], false);
    EXPECT_TRUE(says(signer(found, "report.json.minisig")["reason"],
                     "this key was given for the role measurer alone"))
        << found.dump(1);
    EXPECT_EQ(signatures({"--pubkey", "judge=" + public_key("measurer")})["passed"], true);
    EXPECT_EQ(signatures({"--pubkey", "measurer=" + public_key("judge"), "--pubkey",
                          "judge=" + public_key("measurer")})["passed"],
              true);
    // What stands before is a pattern for nobody, and no role names a file.
    for (const std::string& given :
         {"j*dge=" + public_key("measurer"), std::string("judge=nowhere.pub"),
          "=" + public_key("measurer")})
        EXPECT_EQ(verify({"--pubkey", given}).exit_status, 2) << given;
}

// Got through: a signature that states no role counted for a key of any.
TEST_F(AttacksOnSignatures, Sign06ASignatureThatStatesNoRoleIsNotThatOfAKeyGivenForOne) {
    ASSERT_EQ(run_process({"minisign", "-S", "-s", key("judge"), "-m",
                           (run() / "report.json").string(), "-t", "fine"})
                  .exit_status,
              0);
    EXPECT_EQ(signatures({"--pubkey", public_key("judge")})["passed"], true);
    EXPECT_EQ(signatures({"--pubkey", "judge=" + public_key("judge")})["passed"], false);
}

// Got through: keys of nobody knows whom were listed as those of a roster are.
TEST_F(AttacksOnSignatures, Sign07ThatNoRosterVouchedIsSaid) {
    must_sign("measurer", "measurer");
    for (const std::string given : {"", "measurer="})
        EXPECT_TRUE(says(signatures({"--pubkey", given + public_key("measurer")})["details"],
                         "no roster vouches for whose they are"));
    EXPECT_FALSE(says(signatures({"--roster", roster()})["details"], "no roster vouches"));
}

// Got through unsaid. It is what was signed once, and holds.
TEST_F(AttacksOnSignatures, Sign08AWeakKeysSignatureHoldsAndThatIsSaid) {
    for (const auto& [bits, weak] : {std::pair("1024", true), {"2048", true}, {"3072", false}}) {
        for (const char* name : {"ssh", "ssh.pub"})
            fs::remove(path(name));
        fs::remove(run() / "report.json.sig");
        sign_by_ssh("rsa", bits);
        const auto found = verify_json({"--pubkey", "measurer=" + path("ssh.pub").string()});
        EXPECT_EQ(found["exit_status"], 0) << found.dump(1);
        EXPECT_EQ(says(layer(found, "signatures")["details"],
                       fmt::format("its key is RSA of {} bits, weaker", bits)),
                  weak)
            << found.dump(1);
        EXPECT_EQ(signer(found, "report.json.sig")["notes"].size(), weak ? 1U : 0U);
    }
}

// Got through unsaid: nobody signs what is not measured yet. The clock may be wrong, so that it
// counts; the recording is of 2026-03-14.
TEST_F(AttacksOnSignatures, Sign09ASignatureFromBeforeTheRecordingIsSaid) {
    for (const auto& [time, early] : {std::pair("2020-01-01T00:00:00Z", true),
                                      {"2026-03-13T23:00:00Z", true},
                                      {"2026-03-15T00:00:00Z", false}}) {
        sign_stating("measurer", "measurer", time);
        const auto found = verify_json({"--roster", roster()});
        EXPECT_EQ(signer(found, "report.json.minisig")["valid"], true) << found.dump(1);
        EXPECT_EQ(says(layer(found, "signatures")["details"], "BEFORE THE END OF THE RECORDING"),
                  early)
            << found.dump(1);
    }
}

// Had held: what is yet to come is refused, and what is no time.
TEST_F(AttacksOnSignatures, Sign10ASignatureOfTheFutureDoesNotCount) {
    for (const char* time : {"2126-01-01T00:00:00Z", "tomorrow", "2026-02-30T00:00:00Z"}) {
        sign_stating("measurer", "measurer", time);
        const auto found = verify_json({"--roster", roster()});
        EXPECT_EQ(signer(found, "report.json.minisig")["valid"], false) << time;
    }
}

// Had held: no key that runcert signs with is weaker than Ed25519.
TEST_F(AttacksOnSignatures, Sign11OtherKeysAreRefusedForSigning) {
    for (const std::vector<std::string>& make :
         {std::vector<std::string>{"openssl", "genrsa", "-out", path("k").string(), "1024"},
          {"openssl", "ecparam", "-name", "secp224r1", "-genkey", "-noout", "-out",
           path("k").string()}}) {
        ASSERT_EQ(run_process(make).exit_status, 0);
        fs::permissions(path("k"), fs::perms::owner_read | fs::perms::owner_write);
        EXPECT_EQ(runcert({"sign", run().string(), "--key", path("k").string(), "--role", "judge"})
                      .exit_status,
                  2);
        EXPECT_EQ(certify(examples / "salt_lake" / "attempt.yaml", path("new"),
                          {"--key", path("k").string()})
                      .exit_status,
                  2);
        EXPECT_FALSE(fs::exists(path("new")));
    }
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
