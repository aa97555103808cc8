#include "draws.h"
#include "signatures_support.h"

// Who signed, in which role, and whether it counts.

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Signatures = SignedRuns;

TEST_F(Signatures, OfTwoSignersAreKeptApartAndBothCount) {
    must_sign("measurer", "measurer");
    must_sign("judge", "judge");
    must_sign("stranger", "judge");
    EXPECT_TRUE(fs::exists(run() / "report.json.judge.2.minisig"));
    const auto found = verify_json({"--roster", roster()});
    EXPECT_EQ(found["exit_status"], 0) << found.dump(1);
    EXPECT_EQ(signer(found, "report.json.minisig")["role"], "measurer");
    EXPECT_EQ(signer(found, "report.json.minisig")["who"], "measurer");
    EXPECT_EQ(signer(found, "report.json.minisig")["valid"], true);
    EXPECT_EQ(signer(found, "report.json.judge.minisig")["valid"], true);
    const auto stranger = signer(found, "report.json.judge.2.minisig");
    EXPECT_EQ(stranger["valid"], false);
    EXPECT_TRUE(says(stranger["reason"], "not on the roster")) << stranger;
}

TEST_F(Signatures, AKeyThatSignsAgainReplacesItsOwn) {
    must_sign("measurer", "measurer");
    write_file_atomically(run() / "report.json.minisig.tsr", "of the earlier signature");
    must_sign("measurer", "measurer");
    EXPECT_FALSE(fs::exists(run() / "report.json.measurer.minisig"));
    EXPECT_FALSE(fs::exists(run() / "report.json.minisig.tsr"));
    must_sign("measurer", "observer");
    EXPECT_TRUE(fs::exists(run() / "report.json.observer.minisig"));
}

TEST_F(Signatures, MinisignAcceptsEach) {
    must_sign("measurer", "measurer");
    must_sign("judge", "judge");
    const auto minisign = [&](const std::string& file, const std::string& name) {
        return run_process({"minisign", "-Vm", (run() / "report.json").string(), "-x",
                            (run() / file).string(), "-p", public_key(name)})
            .exit_status;
    };
    EXPECT_EQ(minisign("report.json.minisig", "measurer"), 0);
    EXPECT_EQ(minisign("report.json.judge.minisig", "judge"), 0);
    EXPECT_NE(minisign("report.json.judge.minisig", "measurer"), 0);
    // The key that the trusted comment states is what minisign -P takes.
    const std::string text = read_file(run() / "report.json.judge.minisig");
    const std::size_t at = text.find(" key=") + 5;
    const std::string stated = text.substr(at, text.find(' ', at) - at);
    EXPECT_EQ(run_process({"minisign", "-Vm", (run() / "report.json").string(), "-x",
                           (run() / "report.json.judge.minisig").string(), "-P", stated})
                  .exit_status,
              0);
}

TEST_F(Signatures, ThatTheReportNeedsAreCountedByRole) {
    certify_asking_for(R"({"role": "measurer", "count": 1}, {"role": "judge", "count": 2})");
    must_sign("measurer", "measurer");
    auto found = layer(verify_json({"--roster", roster()}), "signatures");
    EXPECT_EQ(found["passed"], false);
    EXPECT_TRUE(says(found["finding"], "2 of judge")) << found;
    EXPECT_TRUE(says(found["details"], "needed: 1 in the role measurer; there: 1")) << found;
    must_sign("judge", "judge");
    must_sign("stranger", "judge");
    found = layer(verify_json({"--roster", roster()}), "signatures");
    EXPECT_EQ(found["passed"], false);
    EXPECT_TRUE(says(found["finding"], "1 of judge")) << found;
    EXPECT_TRUE(says(found["details"], "not on the roster")) << found;
    const std::string line = line_for("stranger", "judge");
    const std::string all = roster_of({lines_["measurer"], lines_["judge"], line});
    EXPECT_EQ(layer(verify_json({"--roster", all}), "signatures")["passed"], true);
}

TEST_F(Signatures, RequiredInAWayThatMakesNoSenseAreRefused) {
    const std::string report = read_file(run() / "report.json");
    for (const char* entry :
         {R"({"role": "judge", "count": 0})", R"({"role": "judge", "count": -1})",
          R"({"role": "judge", "count": "1"})", R"({"role": "chief judge"})", R"({"count": 1})",
          "7"}) {
        require_signatures(entry);
        const ProcessResult result = verify({"--roster", roster()});
        EXPECT_EQ(result.exit_status, 2) << entry << result.output;
        EXPECT_NE(result.errors.find("report.json"), std::string::npos) << result.errors;
        EXPECT_EQ(result.errors.find("fault of the program"), std::string::npos) << result.errors;
        write_file_atomically(run() / "report.json", report);
    }
}

TEST_F(Signatures, AKeyCountsForOneRole) {
    certify_asking_for(R"({"role": "measurer", "count": 1}, {"role": "judge", "count": 1})");
    must_sign("measurer", "measurer");
    must_sign("measurer", "judge");
    const std::string both = line_for("measurer", "measurer,judge");
    auto found = verify_json({"--roster", roster_of({both})});
    EXPECT_EQ(signer(found, "report.json.minisig")["valid"], true);
    EXPECT_EQ(signer(found, "report.json.judge.minisig")["valid"], true);
    EXPECT_EQ(layer(found, "signatures")["passed"], false) << found.dump(1);
    // Whichever role the first key was counted for, the second one fills the other.
    must_sign("judge", "measurer");
    found = verify_json({"--roster", roster_of({both, line_for("judge", "*")})});
    EXPECT_EQ(layer(found, "signatures")["passed"], true) << found.dump(1);
}

TEST_F(Signatures, ARoleThatTheRosterDoesNotGiveIsNotCounted) {
    must_sign("measurer", "judge");
    const auto found = verify_json({"--roster", roster()});
    EXPECT_EQ(found["exit_status"], 1);
    EXPECT_TRUE(says(found["signers"], "does not let this key sign as judge")) << found.dump(1);
}

TEST_F(Signatures, ByAKeyOutsideOfItsValidityAreRefusedInThoseWords) {
    must_sign("measurer", "measurer");
    const std::string expired = roster_of({line_with("measurer", "valid-before=\"20260101Z\"")});
    auto one = signer(verify_json({"--roster", expired}), "report.json.minisig");
    EXPECT_EQ(one["valid"], false);
    EXPECT_TRUE(says(one["reason"], "was valid until 2026-01-01T00:00:00Z")) << one;
    EXPECT_TRUE(says(one["reason"], "only a time stamp from before its end")) << one;
    // At a time when it was valid, what the signer states is still outside.
    one = signer(verify_json({"--roster", expired, "--at", "2025-12-31T00:00:00Z"}),
                 "report.json.minisig");
    EXPECT_EQ(one["valid"], false);
    EXPECT_TRUE(says(one["reason"], "the time that its signer states")) << one;
    EXPECT_EQ(one["time_source"], "given");
    const std::string later = roster_of({line_with("measurer", "valid-after=\"20990101Z\"")});
    one = signer(verify_json({"--roster", later}), "report.json.minisig");
    EXPECT_EQ(one["valid"], false);
    EXPECT_TRUE(says(one["reason"], "valid from 2099-01-01T00:00:00Z only")) << one;
}

TEST_F(Signatures, OfAnotherReportAreRefusedAsReplayed) {
    must_sign("measurer", "measurer");
    fs::remove_all(path("b"));
    fs::copy(other_run(), path("b"));
    fs::copy_file(run() / "report.json.minisig", path("b") / "report.json.minisig");
    for (const std::vector<std::string>& keys :
         {std::vector<std::string>{"--roster", roster()}, {"--pubkey", public_key("measurer")}}) {
        std::vector<std::string> arguments{"verify", path("b").string()};
        arguments.insert(arguments.end(), keys.begin(), keys.end());
        const ProcessResult result = runcert(arguments);
        EXPECT_EQ(result.exit_status, 1);
        EXPECT_NE(result.output.find("replayed"), std::string::npos) << result.output;
        EXPECT_NE(result.output.find("attempt salt-lake"), std::string::npos) << result.output;
    }
}

TEST_F(Signatures, AreRefusedWhereAByteOfThemIsAnother) {
    must_sign("measurer", "measurer");
    const fs::path file = run() / "report.json.minisig";
    const std::string text = read_file(file);
    // Every part of it, the shortest of which (algorithm and key id, in base 64) has 13 letters.
    const auto step = static_cast<std::size_t>(draws({.daily = 12, .study = 5}));
    bool by_roster = false;
    for (std::size_t at = text.find('\n') + 1; at + 1 < text.size(); at += step) {
        std::string changed = text;
        changed[at] = static_cast<char>(changed[at] ^ 2);
        write_file_atomically(file, changed);
        by_roster = !by_roster;
        const ProcessResult result = by_roster ? verify({"--roster", roster()})
                                               : verify({"--pubkey", public_key("measurer")});
        EXPECT_EQ(result.exit_status, 1) << at << result.output << result.errors;
        EXPECT_NE(result.output.find("report.json.minisig"), std::string::npos) << at;
    }
}

TEST_F(Signatures, InMinisignsLegacyFormAreRefused) {
    must_sign("measurer", "measurer");
    ASSERT_EQ(run_process({"minisign", "-S", "-l", "-s", key("measurer"), "-m",
                           (run() / "report.json").string()})
                  .exit_status,
              0);
    const ProcessResult result = verify({"--pubkey", public_key("measurer")});
    EXPECT_EQ(result.exit_status, 1);
    EXPECT_NE(result.output.find("legacy format"), std::string::npos) << result.output;
}

TEST_F(Signatures, WithoutAKeyToCompareWithNothingIsVerified) {
    EXPECT_NE(verify({}).output.find("UNSIGNED"), std::string::npos);
    must_sign("measurer", "measurer");
    const ProcessResult result = verify({});
    EXPECT_EQ(result.exit_status, 1);
    EXPECT_NE(result.output.find("no key was given"), std::string::npos) << result.output;
    EXPECT_NE(result.output.find("\nNOT VERIFIED: "), std::string::npos) << result.output;
    EXPECT_EQ(verify({"--roster", roster(), "--pubkey", public_key("judge")}).exit_status, 2);
    EXPECT_EQ(verify({"--roster", roster(), "--at", "yesterday"}).exit_status, 2);
}

TEST_F(Signatures, BySshKeygenCountByTheSameRoster) {
    for (const char* type : {"ed25519", "ecdsa"}) {
        const fs::path secret = path(type);
        ASSERT_EQ(run_process({"ssh-keygen", "-q", "-t", type, "-N", "", "-C", "A. Person", "-f",
                               secret.string()})
                      .exit_status,
                  0);
        const auto sign_as = [&](const std::string& name_space) {
            fs::remove(run() / "report.json.sig");
            return run_process({"ssh-keygen", "-q", "-Y", "sign", "-n", name_space, "-f",
                                secret.string(), (run() / "report.json").string()})
                .exit_status;
        };
        ASSERT_EQ(sign_as("measurer@runcert"), 0);
        const std::string public_text = read_file(secret.string() + ".pub");
        const std::string listed =
            roster_of({"measurer namespaces=\"measurer@runcert\" " + public_text});
        auto found = verify_json({"--roster", listed});
        EXPECT_EQ(found["exit_status"], 0) << found.dump(1);
        EXPECT_EQ(signer(found, "report.json.sig")["role"], "measurer");
        EXPECT_EQ(signer(found, "report.json.sig")["who"], "A. Person");
        EXPECT_EQ(verify({"--pubkey", secret.string() + ".pub"}).exit_status, 0);
        const ProcessResult theirs =
            run_process({"ssh-keygen", "-Y", "verify", "-f", listed, "-I", "measurer", "-n",
                         "measurer@runcert", "-s", (run() / "report.json.sig").string()},
                        {.standard_input = run() / "report.json"});
        EXPECT_EQ(theirs.exit_status, 0) << theirs.output << theirs.errors;
        found = verify_json({"--roster", roster()});
        EXPECT_TRUE(says(signer(found, "report.json.sig")["reason"], "not on the roster"));
        ASSERT_EQ(sign_as("file"), 0);
        found = verify_json({"--roster", listed});
        EXPECT_TRUE(says(signer(found, "report.json.sig")["reason"], "made for \\\"file\\\""))
            << found.dump(1);
        ASSERT_EQ(sign_as("judge@runcert"), 0);
        EXPECT_EQ(verify_json({"--roster", listed})["exit_status"], 1);
        ASSERT_EQ(sign_as("measurer@runcert"), 0);
        const std::string report = read_file(run() / "report.json");
        write_file_atomically(run() / "report.json", report + "\n");
        found = verify_json({"--roster", listed});
        EXPECT_TRUE(says(signer(found, "report.json.sig")["reason"], "not a signature of this"))
            << found.dump(1);
        write_file_atomically(run() / "report.json", report);
    }
}

TEST_F(Signatures, AnOptionThatMayBeRepeatedTakesOneValueEachTime) {
    must_sign("measurer", "measurer");
    EXPECT_EQ(runcert({"verify", "--pubkey", public_key("judge"), "--pubkey",
                       public_key("measurer"), run().string()})
                  .exit_status,
              0);
}

TEST_F(Signatures, AMalformedRosterIsRefusedAtItsLine) {
    must_sign("measurer", "measurer");
    const ProcessResult result = verify({"--roster", roster_of({lines_["judge"], "measurer x y"})});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_NE(result.errors.find("roster, line 2"), std::string::npos) << result.errors;
}

TEST_F(Signatures, OfAnUnchangedReportStand) {
    must_sign("measurer", "measurer");
    must_sign("judge", "judge");
    write_file_atomically(run() / "report.json.judge.minisig.tsq", "query");
    const auto before = contents_of(run());
    certify(examples / "salt_lake" / "attempt.yaml", run(), {"--no-render"});
    auto after = contents_of(run());
    for (const auto& [name, bytes] : before)
        if (name.starts_with("report.json")) {
            EXPECT_EQ(after[name], bytes) << name;
        }
    EXPECT_FALSE(fs::exists(run() / "superseded"));
}

TEST_F(Signatures, OfAnotherReportAreKeptApartAndVoid) {
    must_sign("measurer", "measurer");
    must_sign("judge", "judge");
    write_file_atomically(run() / "report.json.judge.minisig.tsq", "query");
    const auto before = contents_of(run());
    const fs::path other = folder_.path() / "other";
    fs::copy(examples / "salt_lake", other, fs::copy_options::recursive);
    write_file_atomically(other / "attempt.yaml",
                          read_file(other / "attempt.yaml") + "attempts_made: 2\n");
    for (int again = 0; again < 2; ++again)
        ASSERT_LT(certify(other / "attempt.yaml", run(), {"--no-render"}).exit_status, 2);
    auto after = contents_of(run());
    for (const char* name :
         {"report.json.minisig", "report.json.judge.minisig", "report.json.judge.minisig.tsq"}) {
        EXPECT_FALSE(after.contains(name)) << name;
        EXPECT_EQ(read_file(superseded(before.at("report.json"), name)), before.at(name)) << name;
    }
    const ProcessResult verified = verify({"--pubkey", public_key("judge")});
    EXPECT_NE(verified.output.find("yes  files"), std::string::npos) << verified.output;
    EXPECT_NE(verified.output.find("UNSIGNED"), std::string::npos) << verified.output;
    fs::remove_all(other);
}

TEST_F(Signatures, ThatAreMadeAgainLeaveTheEarlierOneAndItsStamp) {
    must_sign("measurer", "measurer");
    write_file_atomically(run() / "report.json.minisig.tsr", "stamp");
    const std::string first = read_file(run() / "report.json.minisig");
    must_sign("measurer", "measurer");
    const std::string report = read_file(run() / "report.json");
    EXPECT_EQ(read_file(superseded(report, "report.json.minisig")), first);
    EXPECT_EQ(read_file(superseded(report, "report.json.minisig.tsr")), "stamp");
    EXPECT_FALSE(fs::exists(run() / "report.json.minisig.tsr"));
}

TEST_F(Signatures, SayWhereNothingWasRecomputed) {
    must_sign("measurer", "measurer");
    const ProcessResult verified = verify({"--pubkey", public_key("measurer")});
    EXPECT_NE(verified.output.find("signed without recomputing"), std::string::npos)
        << verified.output;
    const ProcessResult again = runcert(
        {"sign", run().string(), "--key", key("measurer"), "--role", "measurer", "--no-render"});
    ASSERT_EQ(again.exit_status, 0) << again.errors;
    EXPECT_NE(again.output.find("signing rule “nalsa”, revision 1: 232."), std::string::npos)
        << again.output;
    EXPECT_EQ(verify({"--pubkey", public_key("measurer")}).output.find("without recomputing"),
              std::string::npos);
}

// A verdict edited by hand with every hash put right: nobody signs it unseen.
TEST_F(Signatures, AreNotMadeOfFiguresThatDoNotFollow) {
    const fs::path trajectory = run() / "4-trajectory.ecsv";
    std::string text = read_file(trajectory);
    text[text.rfind("0.")] = '9';
    write_file_atomically(trajectory, text);
    const ProcessResult result = runcert(
        {"sign", run().string(), "--key", key("measurer"), "--role", "measurer", "--no-render"});
    EXPECT_EQ(result.exit_status, 2) << result.output;
    EXPECT_FALSE(fs::exists(run() / "report.json.minisig"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
