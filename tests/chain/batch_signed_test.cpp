// Signatures and pages of a day's runs: they stay while the report is the same.
#include "batch_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

std::vector<std::string> signatures_in(const fs::path& run) {
    std::vector<std::string> names;
    for (const auto& [name, bytes] : contents_of(run))
        if (name.starts_with("report.json.")) names.push_back(name);
    return names;
}

TEST_F(Batches, ARunIsSignedOnceForEachReport) {
    const std::string secret = key("measurer").string();
    const std::vector<std::string> with_key{"--no-render", "--key", secret};
    BatchSaid said = again(with_key);
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    EXPECT_EQ(said.steps_of("one"), "sign");
    ASSERT_EQ(signatures_in(out() / "one").size(), 1u);
    const auto signed_run = made("one");
    EXPECT_EQ(again(with_key).steps_run, 0);
    const ProcessResult verified =
        runcert({"verify", (out() / "one").string(), "--pubkey", path("measurer.pub").string()});
    EXPECT_EQ(verified.exit_status, 0) << verified.output << verified.errors;
    EXPECT_NE(verified.output.find("SIGNED, NOT RECOMPUTED"), std::string::npos) << verified.output;

    edit(day() / "day.yaml", "speed: 202.9", "speed: 202.8");
    said = again(with_key);
    EXPECT_EQ(said.steps_of("one"), "claim check report sign");
    EXPECT_EQ(said.steps_of("two"), "");
    EXPECT_EQ(signatures_in(out() / "one").size(), 1u);
    EXPECT_NE(made("one"), signed_run);
    EXPECT_EQ(
        runcert({"verify", (out() / "one").string(), "--pubkey", path("measurer.pub").string()})
            .exit_status,
        0);
}

TEST_F(Batches, ASignatureFromElsewhereStaysWhileTheReportDoes) {
    const std::vector<std::string> pages{"--no-pdf"};
    BatchSaid said = again(pages);
    EXPECT_EQ(said.steps_of("one"), "render");
    const std::string unsigned_page = read_file(out() / "one/report.html");
    const ProcessResult done = runcert(
        {"sign", (out() / "one").string(), "--key", key("judge").string(), "--role", "judge"});
    ASSERT_EQ(done.exit_status, 0) << done.errors;
    const auto signatures = signatures_in(out() / "one");
    ASSERT_FALSE(signatures.empty());

    said = again(pages);
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    EXPECT_EQ(signatures_in(out() / "one"), signatures);
    EXPECT_NE(read_file(out() / "one/report.html"), unsigned_page);
    EXPECT_EQ(said.steps_of("one"), "render");
    EXPECT_EQ(again(pages).steps_run, 0);
    const ProcessResult verified =
        runcert({"verify", (out() / "one").string(), "--pubkey", path("judge.pub").string()});
    EXPECT_EQ(verified.exit_status, 0) << verified.output << verified.errors;

    edit(day() / "day.yaml", "speed: 202.9", "speed: 202.8");
    said = again(pages);
    EXPECT_EQ(said.steps_of("one"), "claim check report render");
    EXPECT_TRUE(signatures_in(out() / "one").empty());
    const ProcessResult later = runcert({"verify", (out() / "one").string()});
    EXPECT_NE(later.output.find("UNSIGNED"), std::string::npos) << later.output << later.errors;
}

TEST_F(Batches, PagesComeAndGoWithWhatIsAskedFor) {
    const std::vector<std::string> only{"--only", "one"};
    BatchSaid said = again(only);
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    EXPECT_EQ(said.steps_of("one"), "render");
    const auto full = made("one");
    ASSERT_TRUE(full.contains("report.pdf"));
    EXPECT_EQ(again(only).steps_run, 0);

    const BatchSaid without = again({"--only", "one", "--no-pdf"});
    EXPECT_EQ(without.exit_status, 0) << without.errors;
    EXPECT_EQ(
        without.ran.at("one").at("render"),
        "parameters: pages.1 \"certificate.pdf\" -> nothing, pages.2 \"report.pdf\" -> nothing");
    EXPECT_EQ(again(only).exit_status, 0);
    EXPECT_EQ(made("one"), full);
    EXPECT_EQ(again({"--only", "one", "--no-render"}).steps_run, 0);
    EXPECT_EQ(again(only).steps_run, 0);

    // Pages of another report never stay beside it.
    edit(day() / "day.yaml", "speed: 202.9", "speed: 202.8");
    EXPECT_EQ(again({"--only", "one", "--no-render"}).steps_of("one"), "claim check report");
    EXPECT_FALSE(fs::exists(out() / "one/report.pdf"));
    EXPECT_FALSE(fs::exists(out() / "one/report.html"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
