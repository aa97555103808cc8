// A day's folder that others wrote into: what is ranked and signed was computed by this user's
// batches.
#include "batch_support.h"
#include "make/run_record.h"
#include "store/record_key.h"
#include "store/sha256.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// Who seals a forged record.
enum class Seal { as_it_was, of_the_forger, checksum_alone };

class Attacks : public Batches {
  protected:
    const std::string state_ = std::getenv("XDG_STATE_HOME");
    static constexpr const char* forged_speed = "987.65";

    fs::path record() const { return out() / ".runcert/records/one.json"; }
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
    /// The record that says that this is what the steps wrote.
    void forge_record(Seal seal) const {
        Json json = Json::parse(read_file(record()));
        std::string text = json.dump();
        for (const char* name : {"6-verdict.yaml", "report.json"}) {
            const std::string old = sha256_hex(first_made("one").at(name));
            const std::string now = digest_file(out() / "one" / name).sha256;
            ASSERT_TRUE(holds(text, old)) << name;
            for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old))
                text.replace(at, old.size(), now);
        }
        json = Json::parse(text);
        const std::string written = json.at("seal");
        json.erase("seal");
        const std::string body = json.dump(1) + "\n";
        if (seal == Seal::as_it_was) json["seal"] = written;
        if (seal == Seal::of_the_forger) json["seal"] = RecordKey().seal(body);
        if (seal == Seal::checksum_alone) json["sha256"] = sha256_hex(body);
        write_file_atomically(record(), json.dump(1) + "\n");
    }
    void expect_nothing_forged(const BatchSaid& said) const {
        EXPECT_EQ(said.exit_status, 0) << said.errors << said.text;
        EXPECT_TRUE(said.steps_of("one").starts_with("claim import enu screen smooth window check"))
            << said.steps_of("one");
        EXPECT_TRUE(holds(said.text, "1 run was recomputed")) << said.text;
        for (const auto& [name, bytes] : contents_of(out()))
            EXPECT_FALSE(holds(bytes, forged_speed) && !holds(name, "/superseded/")) << name;
        EXPECT_EQ(read_file(out() / "one/report.json"), first_made("one").at("report.json"));
    }
};

TEST_F(Attacks, BatchKeepsNoRunByAForgedRecord) {
    for (const Seal seal : {Seal::as_it_was, Seal::of_the_forger, Seal::checksum_alone}) {
        SCOPED_TRACE(static_cast<int>(seal));
        forge_files();
        forge_record(seal);
        const BatchSaid said = again();
        expect_nothing_forged(said);
        EXPECT_EQ(said.steps_of("two"), "") << "its record is this user's";
        EXPECT_EQ(again().steps_run, 0);
    }
}

TEST_F(Attacks, BatchSignsNoRunByAForgedRecord) {
    forge_files();
    forge_record(Seal::of_the_forger);
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

TEST_F(Attacks, BatchMakesTheDayAgainThatAForgedRecordVouchesFor) {
    const fs::path day_file = out() / "day.csv";
    const std::string genuine = read_file(day_file);
    const std::string before = digest_file(day_file).sha256;
    write_file_atomically(day_file, "rank,forged\n1,987.65\n");
    const fs::path results = out() / ".runcert/results-record.json";
    std::string text = read_file(results);
    ASSERT_TRUE(holds(text, before));
    text.replace(text.find(before), before.size(), digest_file(day_file).sha256);
    write_file_atomically(results, text);
    EXPECT_EQ(again().steps_run, 0);
    EXPECT_EQ(read_file(day_file), genuine);
}

TEST_F(Attacks, BatchKeepsNoRunOfAnotherUser) {
    setenv("XDG_STATE_HOME", path("another user").c_str(), 1);
    const BatchSaid said = again();
    setenv("XDG_STATE_HOME", state_.c_str(), 1);
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    EXPECT_EQ(said.steps_run, 16);
    EXPECT_TRUE(holds(said.text, "2 runs were recomputed")) << said.text;
    for (const char* id : {"one", "two"})
        EXPECT_EQ(made(id), first_made(id));
}

TEST_F(Attacks, BatchTakesNoFileOfAWorkFolderThatItDidNotWrite) {
    const fs::path work = out() / ".runcert/work/one";
    fs::create_directories(work / "superseded");
    const std::string secret = key("measurer").string();
    for (const char* name : {"report.json.judge.minisig", "1-phase.ecsv", "4-trajectory.ecsv"})
        write_file_atomically(work / name, "planted");
    fs::remove(out() / "one/4-trajectory.ecsv");
    const BatchSaid said = again({"--no-render", "--key", secret});
    EXPECT_EQ(said.exit_status, 0) << said.errors << said.text;
    auto files = made("one");
    files.erase("report.json.minisig");
    EXPECT_EQ(files, first_made("one"));
}

TEST_F(Attacks, BatchReadsNoRecordWithoutEnd) {
    fs::resize_file(record(), std::uintmax_t{1} << 40);
    const BatchSaid said = again();
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    EXPECT_TRUE(holds(said.text, "1 run was recomputed")) << said.text;
    EXPECT_EQ(made("one"), first_made("one"));
}

// Crashed the batch: it was written out to look for its seal.
TEST_F(Attacks, BatchReadsNoRecordThatIsNestedWithoutEnd) {
    write_file_atomically(record(), "{\"seal\": \"x\", \"a\": " + std::string(1900000, '[') +
                                        std::string(1900000, ']') + "}");
    const BatchSaid said = again();
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    EXPECT_TRUE(holds(said.text, "1 run was recomputed")) << said.text;
    EXPECT_EQ(made("one"), first_made("one"));
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

// Without the secret a run is computed again; the signature of the same report stays, and what
// stamps it.
TEST_F(Attacks, BatchReplacesNoSignatureOfTheSameReport) {
    const std::vector<std::string> with_key{"--no-render", "--key", key("measurer").string()};
    EXPECT_EQ(again(with_key).exit_status, 0);
    write_file_atomically(out() / "one/report.json.minisig.tsr", "a stamp");
    const auto signed_run = made("one");
    fs::remove_all(out() / ".runcert");
    const BatchSaid said = again(with_key);
    EXPECT_EQ(said.exit_status, 0) << said.errors << said.text;
    EXPECT_TRUE(holds(said.steps_of("one"), "sign"));
    EXPECT_EQ(made("one"), signed_run);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
