// A day's folder that others wrote into: what is ranked and signed was computed by this user's
// batches.
#include "batch_support.h"
#include "core/text.h"
#include "store/sha256.h"
#include "store/user_state.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

class Attacks : public Batches {
  protected:
    static constexpr const char* forged_speed = "987.65";

    std::string measured_speed() const {
        return read_yaml(out() / "one/6-verdict.yaml")["profiles"]
            .list()
            .front()["shown"]["speed"]
            .text();
    }
    /// Another speed in the verdict and the report of a run.
    void forge_files() const {
        const std::string speed = measured_speed();
        for (const char* name : {"6-verdict.yaml", "report.json"}) {
            std::string text = read_file(out() / "one" / name);
            ASSERT_TRUE(holds(text, speed)) << name;
            for (std::size_t at = text.find(speed); at != std::string::npos; at = text.find(speed))
                text.replace(at, speed.size(), forged_speed);
            write_file_atomically(out() / "one" / name, text);
        }
    }
    /// What the forger's own computer remembers of the run that he forged.
    void forge_record(const fs::path& folder) const {
        const std::string text = recalled("run " + sha256_hex(first_made("one").at("report.json")));
        std::string forged = text;
        for (const char* name : {"6-verdict.yaml", "report.json"})
            replace_all(forged, sha256_hex(first_made("one").at(name)),
                        digest_file(out() / "one" / name).sha256);
        ASSERT_NE(forged, text);
        use_state(folder);
        remember("run " + digest_file(out() / "one/report.json").sha256, forged);
        use_state(path("state"));
    }
    void expect_nothing_forged(const BatchSaid& said) const {
        EXPECT_EQ(said.exit_status, 0) << said.errors << said.text;
        EXPECT_TRUE(said.steps_of("one").starts_with("claim import enu screen smooth window check"))
            << said.steps_of("one");
        for (const auto& [name, bytes] : contents_of(out()))
            EXPECT_FALSE(holds(bytes, forged_speed) && !holds(name, "/superseded/")) << name;
        EXPECT_EQ(read_file(out() / "one/report.json"), first_made("one").at("report.json"));
    }
};

// He can write whatever he likes into the day's folder, and nothing into the user's state.
TEST_F(Attacks, BatchKeepsNoRunThatWasForged) {
    forge_files();
    forge_record(out() / ".runcert/state");
    const BatchSaid said = again();
    expect_nothing_forged(said);
    EXPECT_EQ(said.steps_of("two"), "");
    EXPECT_EQ(again().steps_run, 0);
}

TEST_F(Attacks, BatchSignsNoRunThatWasForged) {
    forge_files();
    forge_record(out() / ".runcert/state");
    const BatchSaid said = again({"--no-render", "--key", key("measurer").string()});
    expect_nothing_forged(said);
    EXPECT_EQ(said.steps_of("two"), "sign");
    EXPECT_TRUE(holds(said.text, measured_speed())) << "what is signed is said";
    for (const char* id : {"one", "two"}) {
        const ProcessResult verified = runcert({"verify", (out() / id).string(), "--recompute",
                                                "--pubkey", path("measurer.pub").string()});
        EXPECT_EQ(verified.exit_status, 0) << verified.output << verified.errors;
    }
}

// In a state folder where others can write nothing is believed.
TEST_F(Attacks, BatchKeepsNoRunThatAnOpenStateFolderVouchesFor) {
    forge_files();
    const fs::path open_state = path("open");
    forge_record(open_state);
    fs::permissions(open_state / "runcert/made", fs::perms::all);
    setenv("XDG_STATE_HOME", open_state.c_str(), 1);
    const BatchSaid said = again();
    use_state(path("state"));
    expect_nothing_forged(said);
    EXPECT_TRUE(holds(said.notes, "Others can write in")) << said.notes;
}

TEST_F(Attacks, BatchMakesTheDayAgainThatWasForged) {
    for (const char* name : {"day.csv", "day.html", "day.yaml"}) {
        const std::string genuine = read_file(out() / name);
        write_file_atomically(out() / name, "rank,forged\n1,987.65\n");
        EXPECT_EQ(again().steps_run, 0);
        EXPECT_EQ(read_file(out() / name), genuine);
    }
}

TEST_F(Attacks, BatchKeepsNoRunOfAnotherUser) {
    use_state(path("another user"));
    const BatchSaid said = again();
    use_state(path("state"));
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    EXPECT_EQ(said.steps_run, 16);
    for (const char* id : {"one", "two"})
        EXPECT_EQ(made(id), first_made(id));
}

TEST_F(Attacks, BatchTakesNoFileOfAStagingFolderThatItDidNotWrite) {
    const fs::path staged = out() / ".runcert-one-1/run";
    fs::create_directories(staged / "superseded");
    const std::string secret = key("measurer").string();
    for (const char* name : {"report.json.judge.minisig", "1-phase.ecsv", "4-trajectory.ecsv"})
        write_file_atomically(staged / name, "planted");
    fs::remove(out() / "one/4-trajectory.ecsv");
    const BatchSaid said = again({"--no-render", "--key", secret});
    EXPECT_EQ(said.exit_status, 0) << said.errors << said.text;
    auto files = made("one");
    files.erase("report.json.minisig");
    EXPECT_EQ(files, first_made("one"));
}

TEST_F(Attacks, BatchSignsNoFolderThatHoldsMoreThanTheRun) {
    write_file_atomically(out() / "one/7-more.ecsv", "more");
    const std::vector<std::string> with_key{"--no-render", "--key", key("measurer").string()};
    const BatchSaid refused = again(with_key);
    EXPECT_EQ(refused.exit_status, 2);
    EXPECT_TRUE(holds(refused.problems.at("one"), "7-more.ecsv")) << refused.text;
    EXPECT_EQ(refused.states.at("two"), "done");
    EXPECT_FALSE(fs::exists(out() / "one/report.json.minisig"));
    fs::remove(out() / "one/7-more.ecsv");
    EXPECT_EQ(again(with_key).steps_of("one"), "sign");
}

// A run that is not known is computed again; the signature of the same report stays, and what
// stamps it.
TEST_F(Attacks, BatchReplacesNoSignatureOfTheSameReport) {
    const std::vector<std::string> with_key{"--no-render", "--key", key("measurer").string()};
    EXPECT_EQ(again(with_key).exit_status, 0);
    write_file_atomically(out() / "one/report.json.minisig.tsr", "a stamp");
    const auto signed_run = made("one");
    remember("run " + sha256_hex(signed_run.at("report.json")), "");
    const BatchSaid said = again(with_key);
    EXPECT_EQ(said.exit_status, 0) << said.errors << said.text;
    EXPECT_TRUE(holds(said.steps_of("one"), "sign"));
    EXPECT_EQ(made("one"), signed_run);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
