#include <fstream>
#include <nlohmann/json.hpp>

#include "signatures_support.h"
#include "trust/signature.h"
#include "trust/verification.h"

// Signatures, keys and pages that are made to say more than they do.

namespace runcert::chain::RUNCERT_FILE {
namespace {

class ForgedSignature : public SignedRuns {
  protected:
    /// Signs with a trusted comment of these words behind what every one begins with.
    void sign_with(const std::string& words) const {
        const std::string report = read_file(run() / "report.json");
        const auto predicate = nlohmann::json::parse(report)["predicate"];
        const SecretKey secret = parse_secret_key(read_file(key("measurer")), std::nullopt, "key");
        const std::string comment = fmt::format("runcert report={} attempt={} key={} {}",
                                                predicate["report_id"].get<std::string>(),
                                                predicate["attempt"]["id"].get<std::string>(),
                                                public_key_line(public_key_of(secret)), words);
        write_file_atomically(run() / "report.json.minisig",
                              runcert::sign(report, secret, comment));
    }
};

TEST_F(ForgedSignature, WithTwoRolesIsRefused) {
    sign_with("role=measurer signed=2026-01-01T00:00:00Z");
    EXPECT_EQ(verify({"--roster", roster()}).exit_status, 0);
    sign_with("role=measurer signed=2026-01-01T00:00:00Z role=judge");
    const auto found = verify_json({"--roster", roster()});
    EXPECT_EQ(found["exit_status"], 1);
    EXPECT_TRUE(says(found["signers"], "states \\\"role=\\\" twice")) << found.dump(1);
}

TEST_F(ForgedSignature, FromTheFutureDoesNotCount) {
    sign_with("role=measurer signed=2999-01-01T00:00:00Z");
    const auto found = verify_json({"--roster", roster()});
    EXPECT_EQ(found["exit_status"], 1);
    EXPECT_TRUE(says(found["signers"], "which is yet to come")) << found.dump(1);
}

TEST_F(ForgedSignature, OfOneKeyInTwoRolesIsOfOneSigner) {
    must_sign("measurer", "measurer");
    must_sign("measurer", "judge");
    const std::string both = roster_of({line_for("measurer", "measurer,judge")});
    const auto found = verify_json({"--roster", both});
    EXPECT_EQ(found["exit_status"], 0);
    EXPECT_EQ(layer(found, "signatures")["finding"], "report.json was signed by 1 signer");
}

TEST_F(ForgedSignature, OfTwoKeysOfOneHolderIsPointedOut) {
    must_sign("measurer", "measurer");
    must_sign("judge", "judge");
    EXPECT_FALSE(says(verify_json({"--roster", roster()})["layers"], "is that one person"));
    std::string line = lines_["judge"];
    line.replace(line.rfind(" judge"), 6, " measurer");
    const auto found = verify_json({"--roster", roster_of({lines_["measurer"], line})});
    EXPECT_TRUE(says(found["layers"], "2 keys that count are called \\\"measurer\\\"")) << found;
}

TEST_F(ForgedSignature, JudgedAsOfAnotherTimeIsSaid) {
    must_sign("measurer", "measurer");
    EXPECT_EQ(verify({"--roster", roster()}).output.find("--at"), std::string::npos);
    const std::string text = verify({"--roster", roster(), "--at", "2020-02-03T04:05:06Z"}).output;
    EXPECT_NE(text.find("judged as of 2020-02-03T04:05:06Z (--at), not as of the present"),
              std::string::npos)
        << text;
}

TEST_F(ForgedSignature, ByASecondKeyInTheFileOfAKeyIsRefused) {
    const auto make = [&](const std::string& name) {
        EXPECT_EQ(run_process({"ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", name, "-f",
                               path(name).string()})
                      .exit_status,
                  0);
        return read_file(path(name + ".pub"));
    };
    const std::string owner = make("owner");
    write_file_atomically(path("both.pub"), owner + "* " + make("stranger"));
    ASSERT_EQ(run_process({"ssh-keygen", "-q", "-Y", "sign", "-n", "judge@runcert", "-f",
                           path("stranger").string(), (run() / "report.json").string()})
                  .exit_status,
              0);
    EXPECT_EQ(verify({"--pubkey", path("owner.pub").string()}).exit_status, 1);
    const ProcessResult result = verify({"--pubkey", path("both.pub").string()});
    EXPECT_EQ(result.exit_status, 2) << result.output;
    EXPECT_NE(result.errors.find("A public key is one line"), std::string::npos) << result.errors;
}

TEST_F(ForgedSignature, AmongHundredsStopsNothing) {
    must_sign("measurer", "measurer");
    const std::string signature = read_file(run() / "report.json.minisig");
    for (int i = 0; i < 201; ++i)
        std::ofstream(run() / fmt::format("report.json.{}.minisig", i)) << signature;
    const ProcessResult result = verify({"--roster", roster()});
    EXPECT_EQ(result.exit_status, 0) << result.output << result.errors;
}

TEST_F(ForgedSignature, KeysFolderHoldsKeysAlone) {
    must_sign("measurer", "measurer");
    fs::create_directory(run() / "keys");
    write_file_atomically(run() / "keys" / "roster", read_file(roster()));
    // Keys come with a bundle, whose SHA256SUMS names them.
    EXPECT_TRUE(says(layer(verify_json({"--roster", roster()}), "files"), "keys: not part"));
    write_file_atomically(run() / "SHA256SUMS", "");
    EXPECT_EQ(layer(verify_json({"--roster", roster()}), "files")["passed"], true);
    write_file_atomically(run() / "keys" / "confession.txt", "x");
    const auto found = verify_json({"--roster", roster()});
    EXPECT_TRUE(says(layer(found, "files"), "keys/confession.txt")) << found.dump(1);
}

TEST_F(ForgedSignature, MayComeAfterThePageButAPageMayShowNothingElse) {
    const ProcessResult rendered =
        runcert({"sign", run().string(), "--key", key("measurer"), "--role", "measurer"});
    ASSERT_EQ(rendered.exit_status, 0) << rendered.errors;
    fs::remove(run() / "certificate.pdf");
    fs::remove(run() / "report.pdf");  // the same, and longer to render
    // A signature that comes later is not on the page, which is no forgery.
    must_sign("judge", "judge");
    const std::vector<std::string> again{"--roster", roster()};
    auto found = verify_json(again);
    EXPECT_EQ(found["exit_status"], 0) << found.dump(1);
    EXPECT_TRUE(says(layer(found, "pages"), "report.html: identical")) << found.dump(1);
    change("report.html", "</head>", "<style>main { display: none }</style></head>");
    found = verify_json(again);
    EXPECT_EQ(found["exit_status"], 1);
    EXPECT_TRUE(says(layer(found, "pages"), "do not go by what it shows")) << found.dump(1);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
