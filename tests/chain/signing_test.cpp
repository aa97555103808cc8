#include <nlohmann/json.hpp>

#include "signatures_support.h"

// What `runcert sign` refuses.

namespace runcert::chain::RUNCERT_FILE {
namespace {

class Signing : public SignedRuns {
  protected:
    /// Refused with these words, and nothing signed.
    void expect_refused(const ProcessResult& result, const std::vector<std::string>& said) const {
        EXPECT_EQ(result.exit_status, 2) << result.output;
        for (const std::string& part : said)
            EXPECT_NE(result.errors.find(part), std::string::npos) << part << "\n" << result.errors;
        EXPECT_FALSE(fs::exists(run() / "report.json.minisig"));
    }
    /// A copy of a file that only its owner can read.
    std::string copied_key(const std::string& name, const std::string& text, fs::perms mode) const {
        write_file_atomically(path(name), text);
        fs::permissions(path(name), mode);
        return path(name).string();
    }
    ProcessResult sign_with(const std::string& key_file,
                            const std::string& role = "measurer") const {
        return runcert({"sign", run().string(), "--key", key_file, "--role", role, "--no-render",
                        "--no-recompute"});
    }
    static constexpr fs::perms owner = fs::perms::owner_read | fs::perms::owner_write;
};

TEST_F(Signing, RefusesAFolderThatIsNotWhole) {
    fs::rename(run() / "2-enu.ecsv", path("away"));
    expect_refused(sign("measurer", "measurer"), {"2-enu.ecsv: missing"});
    fs::rename(path("away"), run() / "2-enu.ecsv");
    write_file_atomically(run() / "notes.txt", "extra");
    expect_refused(sign("measurer", "measurer"), {"notes.txt", "move it away"});
    fs::remove(run() / "notes.txt");
    const std::string table = read_file(run() / "3-screened.ecsv");
    write_file_atomically(run() / "3-screened.ecsv", table + "\n");
    expect_refused(sign("measurer", "measurer"), {"3-screened.ecsv: changed"});
    write_file_atomically(run() / "3-screened.ecsv", table);
    EXPECT_EQ(sign("measurer", "measurer").exit_status, 0);
}

TEST_F(Signing, RefusesAReportOfAnotherVersion) {
    const std::string report = read_file(run() / "report.json");
    const std::string version =
        nlohmann::json::parse(report)["predicate"]["schema"]["version"];  // as of this program
    const std::string field = "\"version\": \"" + version + "\"";
    for (const char* other : {"9.0", "1.1", "0.9"}) {
        const std::string said = fmt::format("The report is of version \"{}\"", other);
        change("report.json", field, fmt::format("\"version\": \"{}\"", other));
        expect_refused(sign("measurer", "measurer"), {said, "Certify the recording again"});
        const ProcessResult result = verify({"--roster", roster()});
        EXPECT_EQ(result.exit_status, 2) << result.output;
        EXPECT_NE(result.errors.find(said), std::string::npos);
        write_file_atomically(run() / "report.json", report);
    }
    change("report.json", "measurement-report:1.0", "measurement-report:2.0");
    expect_refused(sign("measurer", "measurer"), {"The report is of version \"2.0\""});
}

TEST_F(Signing, RefusesAFolderWithoutAReport) {
    fs::remove(run() / "report.json");
    expect_refused(sign("measurer", "measurer"), {"no report in this folder"});
    EXPECT_EQ(verify({}).exit_status, 2);
    EXPECT_EQ(runcert({"verify", path("nowhere").string()}).exit_status, 2);
    write_file_atomically(run() / "report.json", "{\"a\": 1");
    expect_refused(sign("measurer", "measurer"), {"report.json", "Not a report"});
    write_file_atomically(run() / "report.json", "{\"a\": 1, \"b\": {\"c\": 1, \"c\": 2}}");
    expect_refused(sign("measurer", "measurer"), {"The key \"c\" stands twice"});
}

TEST_F(Signing, RefusesAReportThatWouldSpeakForItsSigner) {
    const std::string report = read_file(run() / "report.json");
    const std::string id = nlohmann::json::parse(report)["predicate"]["report_id"];
    change("report.json", fmt::format("\"report_id\": \"{}\"", id),
           fmt::format("\"report_id\": \"{} role=judge\"", id));
    expect_refused(sign("measurer", "measurer"), {"cannot be the id of a report"});
    write_file_atomically(run() / "report.json", report);
    change("report.json", "\"id\": \"salt-lake\"", "\"id\": \"salt\\nlake\"");
    expect_refused(sign("measurer", "measurer"), {"cannot be the id of an attempt"});
    write_file_atomically(run() / "report.json",
                          std::string(1000000, '[') + std::string(1000000, ']'));
    expect_refused(sign("measurer", "measurer"), {"nested deeper"});
}

TEST_F(Signing, CertifyRefusesARoleThatCannotSignBeforeItMeasures) {
    fs::copy(examples / "salt_lake", path("attempt"), fs::copy_options::recursive);
    std::string text = read_file(path("attempt") / "attempt.yaml");
    text.insert(text.find("role: measurer") + 6, "chief ");
    write_file_atomically(path("attempt") / "attempt.yaml", text);
    const ProcessResult result =
        certify(path("attempt") / "attempt.yaml", path("new"), {"--key", key("measurer")});
    EXPECT_EQ(result.exit_status, 2) << result.output;
    EXPECT_NE(result.errors.find("\"chief measurer\" cannot be a role"), std::string::npos)
        << result.errors;
    EXPECT_FALSE(fs::exists(path("new")));
}

TEST_F(Signing, RefusesAKeyThatOthersCanRead) {
    const std::string text = read_file(key("measurer"));
    for (const fs::perms more : {fs::perms::group_read, fs::perms::others_read}) {
        const std::string open = copied_key("open.key", text, owner | more);
        expect_refused(sign_with(open), {"Others than its owner", "chmod 600 " + open});
        const ProcessResult result =
            certify(examples / "salt_lake" / "attempt.yaml", path("new"), {"--key", open});
        EXPECT_EQ(result.exit_status, 2);
        EXPECT_NE(result.errors.find("chmod 600"), std::string::npos) << result.errors;
        EXPECT_FALSE(fs::exists(path("new")));
    }
    EXPECT_EQ(sign_with(copied_key("open.key", text, owner)).exit_status, 0);
}

TEST_F(Signing, SaysWhatAnotherKeyIs) {
    expect_refused(sign_with(public_key("measurer")), {"This is a public key"});
    ASSERT_EQ(
        run_process({"ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", path("ssh").string()})
            .exit_status,
        0);
    expect_refused(sign_with(path("ssh").string()),
                   {"an OpenSSH private key", "ssh-keygen -Y sign -n ROLE@runcert"});
    expect_refused(sign_with(path("ssh.pub").string()), {"a public key of OpenSSH"});
    ASSERT_EQ(
        run_process({"openssl", "genpkey", "-algorithm", "ed25519", "-out", path("pem").string()})
            .exit_status,
        0);
    expect_refused(sign_with(path("pem").string()), {"a private key in PEM form"});
    expect_refused(sign_with(path("missing").string()), {"missing"});
    expect_refused(sign_with(copied_key("x", "hello\n", owner)), {"not a secret key file"});
}

TEST_F(Signing, NeedsTheRightPassword) {
    write_file_atomically(path("passwords"), "läuft schnell\nläuft schnell\n");
    ASSERT_EQ(run_process({RUNCERT_PROGRAMS "/runcert", "keygen", "--out", path("k").string()},
                          {.standard_input = path("passwords")})
                  .exit_status,
              0);
    const std::vector<std::string> command{
        RUNCERT_PROGRAMS "/runcert", "sign",   run().string(), "--key",
        path("k.key").string(),      "--role", "measurer",     "--no-render"};
    write_file_atomically(path("wrong"), "lief schnell\n");
    const ProcessResult wrong = run_process(command, {.standard_input = path("wrong")});
    expect_refused(wrong, {"password is wrong"});
    EXPECT_EQ((wrong.output + wrong.errors).find("lief schnell"), std::string::npos);
    expect_refused(run_process(command), {"no password to read"});
    const ProcessResult right = run_process(command, {.standard_input = path("passwords")});
    EXPECT_EQ(right.exit_status, 0) << right.errors;
    EXPECT_EQ((right.output + right.errors).find("schnell"), std::string::npos);
    EXPECT_EQ(verify({"--pubkey", path("k.pub").string()}).exit_status, 0);
}

TEST_F(Signing, RefusesWhatCannotBeARole) {
    for (const char* role : {"chief judge", "a@b", "", "Prüfer", "../../x"})
        expect_refused(sign_with(key("measurer"), role), {"cannot be a role"});
}

TEST_F(Signing, MakesThePagesAgain) {
    const ProcessResult result =
        runcert({"sign", run().string(), "--key", key("measurer"), "--role", "measurer"});
    ASSERT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_TRUE(fs::exists(run() / "report.pdf"));
    const std::string page = read_file(run() / "report.html");
    const std::size_t shown = page.find("<main");
    EXPECT_EQ(page.substr(shown, page.find("</main>") - shown).find("UNSIGNED"), std::string::npos);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
