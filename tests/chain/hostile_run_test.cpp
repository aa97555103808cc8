#include "hostile_support.h"

// Run folders and keys that were tampered with, and what the other commands are given.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// Makes the tables of a good run and changes one.
HostileCase tampered(const std::string& name, const std::string& file,
                     std::function<std::string(std::string)> change, const std::string& stage,
                     std::vector<std::string> said) {
    return {.name = name,
            .prepare =
                [file, change](const fs::path& folder) {
                    for (const char* one : {"import", "enu", "screen", "smooth", "window"})
                        EXPECT_EQ(run_process({fmt::format("{}/runcert-{}", RUNCERT_PROGRAMS, one),
                                               "--attempt", (folder / "attempt.yaml").string(),
                                               "--run-dir", (folder / "run").string()})
                                      .exit_status,
                                  0);
                    write_plainly(folder / "run" / file, change(read_file(folder / "run" / file)));
                },
            .said = std::move(said),
            .command = {"runcert-" + stage, "--attempt", "FOLDER/attempt.yaml", "--run-dir",
                        "FOLDER/run"}};
}

HostileCase inspected(const std::string& name, const std::string& bytes,
                      std::vector<std::string> said) {
    return {.name = name,
            .prepare = [bytes](const fs::path& folder) { write_plainly(folder / "file", bytes); },
            .said = std::move(said),
            .command = {"runcert", "inspect", "FOLDER/file"}};
}

HostileCase simulated(const std::string& name, const std::string& text,
                      std::vector<std::string> said) {
    return {
        .name = name,
        .prepare = [text](const fs::path& folder) { write_plainly(folder / "spec.yaml", text); },
        .said = std::move(said),
        .command = {"runcert", "simulate", "FOLDER/spec.yaml", "--out", "FOLDER/new"}};
}

/// A key to sign with, or to verify with.
HostileCase key(const std::string& name, const std::string& text, bool secret,
                std::vector<std::string> said) {
    HostileCase one{
        .name = name,
        .prepare = [text](const fs::path& folder) { write_plainly(folder / "key", text); },
        .said = std::move(said)};
    if (secret)
        one.command.insert(one.command.end(), {"--key", "FOLDER/key"});
    else
        one.command = {"runcert", "verify", "FOLDER/run", "--pubkey", "FOLDER/key"};
    return one;
}

const std::string public_key =
    "untrusted comment: minisign public key\n"
    "RWQAAAAAAAAAANdamAGCsQq31Uv+08lkBzoO4XLz2qYjJa8CGmj3B1Ea\n";

std::vector<HostileCase> cases() {
    const auto as = [](const std::string& text) {
        return [text](const std::string&) { return text; };
    };
    const auto cut = [](const std::string& text) { return text.substr(0, text.size() / 2); };
    const auto with = [](const std::string& what, const std::string& by) {
        return [what, by](const std::string& text) { return replaced(text, what, by); };
    };
    return {
        tampered("a cut table", "1-observations.ecsv", cut, "enu", {"1-observations.ecsv:"}),
        tampered("an empty table", "1-observations.ecsv", as(""), "enu", {"1-observations.ecsv"}),
        tampered("a table of another kind", "1-observations.ecsv", as(good_recording()), "enu",
                 {"1-observations.ecsv:1"}),
        tampered("a table with a NUL", "1-observations.ecsv", with("\n1,", std::string("\n\0,", 3)),
                 "enu", {"1-observations.ecsv:"}),
        tampered("nan in a table", "2-enu.ecsv", with("\n2,1.000000000", "\n2,nan"), "screen",
                 {"2-enu.ecsv:", "nan"}),
        tampered("a changed table", "1-observations.ecsv", with("35.1000", "35.2000"), "check",
                 {"1-observations.ecsv", "SHA-256"}),
        tampered("cut windows", "5-windows.yaml", cut, "check", {"5-windows.yaml:"}),
        tampered("windows of NUL", "5-windows.yaml", as(std::string(100, char{})), "check",
                 {"5-windows.yaml", "zero"}),
        tampered("a header of aliases", "2-enu.ecsv",
                 with("# datatype:", "# a: &a [x]\n# b: [*a]\n# datatype:"), "screen",
                 {"2-enu.ecsv:"}),
        tampered("a deep header", "3-screened.ecsv",
                 with("# datatype:", "# a: " + std::string(100'000, '[') + "\n# datatype:"),
                 "smooth", {"3-screened.ecsv:"}),
        inspected("inspect: nothing", "", {"file:1:1", "empty"}),
        inspected("inspect: a table that needs an attempt", "a,b\n1,2\n", {"file:1:1", "columns"}),
        {.name = "inspect: a folder",
         .prepare = [](const fs::path&) {},
         .said = {"folder"},
         .command = {"runcert", "inspect", "FOLDER"}},
        {.name = "inspect: an endless device",
         .prepare = [](const fs::path&) {},
         .said = {"/dev/zero", "device"},
         .command = {"runcert", "inspect", "/dev/zero"}},
        {.name = "an attempt that is an endless device",
         .prepare = [](const fs::path&) {},
         .said = {"/dev/zero", "device"},
         .command = {"runcert", "certify", "/dev/zero", "--out", "FOLDER/run"}},
        simulated("simulate: an attempt", good_attempt, {"spec.yaml:1:", "simulation/1.0"}),
        simulated("simulate: a run of a billion years",
                  "schema: simulation/1.0\nrun: {top_speed_m_s: 60, start_speed_m_s: 0.01, "
                  "half_speed_time_s: 15, duration_s: 3e16, rate_hz: 10, bearing_deg: 160}\n",
                  {"spec.yaml:"}),
        key("an empty key", "", true, {"key"}),
        key("a public key to sign with", public_key, true, {"key"}),
        key("a key of a million letters", std::string(1'000'000, 'A'), true, {"key"}),
        key("a cut public key", public_key.substr(0, 70), false, {"key"}),
        key("a public key of binary", std::string("\xff\x00\x01", 3), false, {"key"}),
    };
}

TEST(Hostile, RunFoldersAndOtherCommands) {
    for (const HostileCase& one : cases())
        expect_hostile_refused(one);
}

/// A good run's folder whose signature or report was changed: the answer is no, or cannot be given.
TEST(Hostile, CutSignaturesAreNeverValid) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    write_plainly(folder.path() / "attempt.yaml", good_attempt);
    write_plainly(folder.path() / "recording.pos", good_recording());
    ASSERT_EQ(
        runcert({"keygen", "--out", (folder.path() / "k").string(), "--no-password"}).exit_status,
        0);
    ASSERT_EQ(certify(folder.path() / "attempt.yaml", run,
                      {"--no-render", "--key", (folder.path() / "k.key").string()})
                  .exit_status,
              1);
    const auto verified = [&] {
        return run_measured({"runcert", "verify", run.string(), "--pubkey",
                             (folder.path() / "k.pub").string()})
            .exit_status;
    };
    ASSERT_EQ(verified(), 0);
    const std::string signature = read_file(run / "report.json.minisig");
    for (std::size_t length = 0; length < signature.size() - 1; length += 37) {
        write_plainly(run / "report.json.minisig", signature.substr(0, length));
        EXPECT_NE(verified(), 0) << length;
    }
    write_plainly(run / "report.json.minisig", std::string(2 << 20, 'A'));
    EXPECT_NE(verified(), 0);
    write_plainly(run / "report.json.minisig", signature);
    write_plainly(run / "report.json", std::string(100'000, '['));
    EXPECT_EQ(verified(), 2);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
