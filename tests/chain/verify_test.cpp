#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "chain_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// A signed run of an example, made once.
class Verify : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder();
        ASSERT_EQ(
            runcert({"keygen", "--out", (folder_->path() / "measurer").string(), "--no-password"})
                .exit_status,
            0);
        const ProcessResult result =
            certify(examples / "salt_lake" / "attempt.yaml", run(),
                    {"--no-render", "--key", (folder_->path() / "measurer.key").string()});
        ASSERT_EQ(result.exit_status, 0) << result.errors;
    }
    static void TearDownTestSuite() {
        delete folder_;
        folder_ = nullptr;
    }
    static fs::path run() { return folder_->path() / "run"; }
    static std::string public_key() { return (folder_->path() / "measurer.pub").string(); }
    static ProcessResult verify(std::vector<std::string> more = {}) {
        std::vector<std::string> arguments{"verify", run().string(), "--pubkey", public_key()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments);
    }

    static TemporaryFolder* folder_;
};
TemporaryFolder* Verify::folder_ = nullptr;

TEST_F(Verify, AWholeRunIsVerified) {
    const ProcessResult result = verify();
    EXPECT_EQ(result.exit_status, 0) << result.output << result.errors;
    // Whoever has the key could have written the figures.
    EXPECT_NE(result.output.find("\nSIGNED, NOT RECOMPUTED\n"), std::string::npos);
    EXPECT_NE(result.output.find("report.json.minisig: measurer"), std::string::npos)
        << result.output;
}

TEST_F(Verify, RecomputationIsIdentical) {
    const ProcessResult result = verify({"--recompute"});
    EXPECT_EQ(result.exit_status, 0) << result.output << result.errors;
    EXPECT_NE(result.output.find("identical"), std::string::npos) << result.output;
    EXPECT_NE(result.output.find("\nVERIFIED\n"), std::string::npos) << result.output;
}

TEST_F(Verify, MinisignAgrees) {
    if (run_process({"sh", "-c", "command -v minisign"}).exit_status != 0)
        GTEST_SKIP() << "minisign is not installed";
    const std::vector<std::string> command{"minisign", "-Vm", (run() / "report.json").string(),
                                           "-p", public_key()};
    EXPECT_EQ(run_process(command).exit_status, 0);
    const std::string original = read_file(run() / "report.json");
    write_file_atomically(run() / "report.json", original + " ");
    EXPECT_NE(run_process(command).exit_status, 0);
    write_file_atomically(run() / "report.json", original);
}

TEST_F(Verify, AnyChangedByteIsFoundAndItsFileNamed) {
    for (const auto& [name, bytes] : contents_of(run())) {
        if (name == "run.yaml" || name == "report.json.minisig") continue;
        for (const std::size_t at : {std::size_t{0}, bytes.size() / 2, bytes.size() - 1}) {
            std::string changed = bytes;
            changed[at] = static_cast<char>(changed[at] ^ 1);
            write_file_atomically(run() / name, changed);
            const ProcessResult result = verify();
            EXPECT_NE(result.exit_status, 0) << name << " byte " << at;
            EXPECT_NE((result.output + result.errors).find(name), std::string::npos)
                << name << result.output << result.errors;
            write_file_atomically(run() / name, bytes);
        }
    }
    EXPECT_EQ(verify().exit_status, 0);
}

TEST_F(Verify, AMissingFileIsNamed) {
    fs::rename(run() / "2-enu.ecsv", run() / "away");
    const ProcessResult result = verify();
    fs::rename(run() / "away", run() / "2-enu.ecsv");
    EXPECT_EQ(result.exit_status, 1);
    EXPECT_NE(result.output.find("2-enu.ecsv: missing"), std::string::npos) << result.output;
}

TEST_F(Verify, AChangedTrustedCommentOrAnotherKeyIsRefused) {
    const std::string signature = read_file(run() / "report.json.minisig");
    std::string changed = signature;
    changed.replace(changed.find("role=measurer"), 13, "role=presider");
    write_file_atomically(run() / "report.json.minisig", changed);
    EXPECT_EQ(verify().exit_status, 1);
    write_file_atomically(run() / "report.json.minisig", signature);
    runcert({"keygen", "--out", (folder_->path() / "other").string(), "--no-password"});
    EXPECT_EQ(
        runcert({"verify", run().string(), "--pubkey", (folder_->path() / "other.pub").string()})
            .exit_status,
        1);
}

TEST_F(Verify, AnUnsignedRunIsNotVerified) {
    const TemporaryFolder folder;
    certify(examples / "rejected" / "attempt.yaml", folder.path() / "run", {"--no-render"});
    const ProcessResult result = runcert({"verify", (folder.path() / "run").string()});
    EXPECT_EQ(result.exit_status, 1);
    EXPECT_NE(result.output.find("UNSIGNED"), std::string::npos);
}

TEST_F(Verify, ConsistentlyForgedFilesAreFoundByRecomputation) {
    // Somebody without the key changes a figure in the last stage's file and in the report: the
    // hashes hold, the signature and the recomputation do not.
    const TemporaryFolder folder;
    certify(examples / "rejected" / "attempt.yaml", folder.path() / "run", {"--no-render"});
    const fs::path verdict = folder.path() / "run" / "6-verdict.yaml";
    const fs::path report = folder.path() / "run" / "report.json";
    const std::string hash =
        nlohmann::json::parse(read_file(report))["subject"].back()["digest"]["sha256"];
    std::string text = read_file(verdict);
    const std::size_t at = text.find("outcome: not_certifiable");
    ASSERT_NE(at, std::string::npos);
    text.replace(at, 24, "outcome: beaten");
    write_file_atomically(verdict, text);
    const std::string new_hash = run_process({"sha256sum", verdict.string()}).output.substr(0, 64);
    std::string forged = read_file(report);
    for (std::size_t i = forged.find(hash); i != std::string::npos; i = forged.find(hash))
        forged.replace(i, 64, new_hash);
    write_file_atomically(report, forged);
    const ProcessResult stopped =
        runcert({"verify", (folder.path() / "run").string(), "--recompute"});
    EXPECT_EQ(stopped.exit_status, 1);
    EXPECT_NE(stopped.output.find("?    recompute     not done"), std::string::npos)
        << stopped.output;
    const ProcessResult result =
        runcert({"verify", (folder.path() / "run").string(), "--recompute", "--keep-going"});
    EXPECT_EQ(result.exit_status, 1);
    EXPECT_NE(result.output.find("yes  files"), std::string::npos) << result.output;
    EXPECT_NE(result.output.find("NO   recompute"), std::string::npos) << result.output;
    EXPECT_NE(result.output.find("6-verdict.yaml"), std::string::npos) << result.output;
}

TEST_F(Verify, AStageRefusesAnInputThatIsNotTheOneItsHeaderNames) {
    const TemporaryFolder folder;
    const fs::path attempt = examples / "salt_lake" / "attempt.yaml";
    const fs::path out = folder.path() / "run";
    certify(attempt, out, {"--no-render"});
    std::string text = read_file(out / "3-screened.ecsv");
    text.replace(text.rfind("True"), 4, "True");
    const std::size_t digit = text.rfind("0.");
    text[digit + 2] = text[digit + 2] == '0' ? '1' : '0';
    write_file_atomically(out / "3-screened.ecsv", text);
    const ProcessResult result = run_process({RUNCERT_PROGRAMS "/runcert-window", "--attempt",
                                              attempt.string(), "--run-dir", out.string()});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_NE(result.errors.find("is not the one that 4-trajectory.ecsv was made from"),
              std::string::npos)
        << result.errors;
}

// Stages before read one table alone, which nothing else that they read was made from.
TEST_F(Verify, EachStageRefusesEachInputThatAnotherWasMadeFrom) {
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "run";
    certify(examples / "salt_lake" / "attempt.yaml", out, {"--no-render"});
    const auto before = contents_of(out);
    const std::string tables[] = {"1-observations.ecsv", "2-enu.ecsv", "3-screened.ecsv",
                                  "4-trajectory.ecsv"};
    const std::map<std::string, std::vector<std::string>> inputs{
        {"runcert-window", {tables[2]}},
        {"runcert-check", {tables[0], tables[2], tables[3]}},
        {"runcert-report",
         {tables[0], tables[1], tables[2], tables[3], "5-windows.yaml", "recording.primary.pos"}}};
    for (const auto& [stage, files] : inputs)
        for (const std::string& file : files) {
            SCOPED_TRACE(stage + " " + file);
            std::string text = before.at(file);
            if (file.ends_with(".ecsv")) {
                const std::size_t digit = text.find_last_of("0123456789");
                text[digit] = text[digit] == '0' ? '1' : '0';
            } else {
                text += file.ends_with(".pos") ? "% later\n" : "# later\n";
            }
            write_file_atomically(out / file, text);
            std::vector<std::string> command{RUNCERT_PROGRAMS "/" + stage, "--attempt",
                                             (out / "attempt.yaml").string(), "--run-dir",
                                             out.string()};
            if (stage == "runcert-report") command.emplace_back("--no-render");
            const ProcessResult result = run_process(command);
            EXPECT_EQ(result.exit_status, 2) << result.output;
            EXPECT_NE(result.errors.find("is not the one that"), std::string::npos)
                << result.errors;
            EXPECT_NE(result.errors.find(file), std::string::npos) << result.errors;
            write_file_atomically(out / file, before.at(file));
        }
    EXPECT_EQ(contents_of(out), before);
}

TEST_F(Verify, TheReportRefusesARecordingThatIsNotTheOneImported) {
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "run";
    certify(examples / "salt_lake" / "attempt.yaml", out, {"--no-render"});
    const fs::path recording = out / "recording.primary.pos";
    write_file_atomically(recording, read_file(recording) + "% added later\n");
    const ProcessResult result =
        run_process({RUNCERT_PROGRAMS "/runcert-report", "--attempt",
                     (out / "attempt.yaml").string(), "--run-dir", out.string(), "--no-render"});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_NE(result.errors.find("recording.primary.pos"), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find("is not the one that"), std::string::npos) << result.errors;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
