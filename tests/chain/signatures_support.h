#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "chain_support.h"
#include "store/sha256.h"

namespace runcert::chain {

/// A run of an example, unsigned, keys, and a roster with a line for each, made once; each test has
/// a copy of the run to sign and spoil.
class SignedRuns : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shared_ = new TemporaryFolder();
        certify(examples / "salt_lake" / "attempt.yaml", original(), {"--no-render"});
        ASSERT_TRUE(fs::exists(original() / "report.json"));
        for (const char* role : {"measurer", "judge", "stranger"}) {
            const ProcessResult made =
                runcert({"keygen", "--out", (shared_->path() / role).string(), "--role", role,
                         "--no-password"});
            ASSERT_EQ(made.exit_status, 0) << made.errors;
            const std::size_t line = made.output.find("roster      ") + 12;
            lines_[role] = made.output.substr(line, made.output.find('\n', line) - line);
        }
        write_file_atomically(shared_->path() / "roster",
                              lines_["measurer"] + "\n" + lines_["judge"] + "\n");
    }
    static void TearDownTestSuite() {
        delete shared_;
        shared_ = nullptr;
    }
    void SetUp() override { fs::copy(original(), run(), fs::copy_options::recursive); }

    static fs::path original() { return shared_->path() / "original"; }
    /// The second run, made where a test asks for it.
    static fs::path other_run() {
        const fs::path out = shared_->path() / "other";
        if (!fs::exists(out)) certify(examples / "rejected" / "attempt.yaml", out, {"--no-render"});
        EXPECT_TRUE(fs::exists(out / "report.json"));
        return out;
    }
    static std::string key(const std::string& name) {
        return (shared_->path() / (name + ".key")).string();
    }
    static std::string public_key(const std::string& name) {
        return (shared_->path() / (name + ".pub")).string();
    }
    static std::string roster() { return (shared_->path() / "roster").string(); }

    fs::path run() const { return folder_.path() / "run"; }
    fs::path path(const std::string& name) const { return folder_.path() / name; }
    /// The example, or the same with another report.
    fs::path attempt(bool other = false) const {
        const fs::path folder = path(other ? "attempt-2" : "attempt-1");
        if (!fs::exists(folder)) {
            fs::copy(examples / "salt_lake", folder, fs::copy_options::recursive);
            if (other)
                write_file_atomically(folder / "attempt.yaml",
                                      read_file(folder / "attempt.yaml") + "attempts_made: 2\n");
        }
        return folder / "attempt.yaml";
    }

    /// A roster of these lines, for one test.
    std::string roster_of(const std::vector<std::string>& lines) const {
        std::string text;
        for (const std::string& line : lines)
            text += line + "\n";
        write_file_atomically(path("roster"), text);
        return path("roster").string();
    }
    /// The line of a key with options put in.
    static std::string line_with(const std::string& role, const std::string& options) {
        std::string line = lines_[role];
        return line.insert(line.find(" ssh-ed25519"), "," + options);
    }

    /// The line of a key for other roles.
    static std::string line_for(const std::string& name, const std::string& roles) {
        return roles + lines_[name].substr(lines_[name].find(" ssh-"));
    }

    ProcessResult sign(const std::string& name, const std::string& role) const {
        return runcert({"sign", run().string(), "--key", key(name), "--role", role, "--no-render",
                        "--no-recompute"});
    }
    void must_sign(const std::string& name, const std::string& role) const {
        const ProcessResult result = sign(name, role);
        ASSERT_EQ(result.exit_status, 0) << result.errors;
    }
    ProcessResult verify(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments{"verify", run().string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments);
    }
    nlohmann::json verify_json(std::vector<std::string> more) const {
        more.emplace_back("--json");
        const ProcessResult result = verify(more);
        const auto json = nlohmann::json::parse(result.output, nullptr, false);
        EXPECT_TRUE(json.is_object()) << result.output << result.errors;
        if (!json.is_object()) return nlohmann::json::object();
        EXPECT_EQ(json["exit_status"], result.exit_status);
        const bool recomputed = std::ranges::find(more, "--recompute") != more.end();
        std::string verdict = result.exit_status != 0 ? "NOT VERIFIED"
                              : recomputed            ? "VERIFIED"
                                                      : "SIGNED, NOT RECOMPUTED";
        const auto unchecked = json["not_checked_here"];
        if (result.exit_status == 0 && !unchecked.empty()) {
            EXPECT_EQ(unchecked.size(), 1U) << unchecked;
            verdict += "; " + unchecked[0].get<std::string>() + " not checked here";
        }
        EXPECT_EQ(json["verdict"], verdict);
        return json;
    }
    static nlohmann::json layer(const nlohmann::json& found, const std::string& name) {
        for (const auto& one : found["layers"])
            if (one["layer"] == name) return one;
        ADD_FAILURE() << "no layer " << name << " in " << found.dump(1);
        return nlohmann::json::object({{"passed", nullptr}, {"finding", ""}, {"details", ""}});
    }
    /// What the signer of a file is found to be.
    static nlohmann::json signer(const nlohmann::json& found, const std::string& file) {
        for (const auto& one : found["signers"])
            if (one["file"] == file) return one;
        ADD_FAILURE() << "no signer " << file << " in " << found.dump(1);
        return nlohmann::json::object({{"valid", nullptr}, {"reason", ""}});
    }
    void change(const std::string& file, const std::string& from, const std::string& to) const {
        std::string text = read_file(run() / file);
        const std::size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << file << ": " << from;
        write_file_atomically(run() / file, text.replace(at, from.size(), to));
    }
    /// A run in place of this one, whose attempt asks for these signatures.
    void certify_asking_for(const std::string& entries) const {
        fs::copy(examples / "salt_lake", path("asking"), fs::copy_options::recursive);
        const fs::path attempt = path("asking") / "attempt.yaml";
        write_file_atomically(attempt, read_file(attempt) + "signatures: [" + entries + "]\n");
        fs::remove_all(run());
        certify(attempt, run(), {"--no-render"});
        ASSERT_TRUE(fs::exists(run() / "report.json"));
    }
    /// Lets the report alone ask for these signatures.
    void require_signatures(const std::string& entries) const {
        change("report.json", "\"signatures_required\": []",
               "\"signatures_required\": [" + entries + "]");
    }
    /// Lets the report name the file as it is now.
    void fix_hash(const std::string& file) const {
        const auto report = nlohmann::json::parse(read_file(run() / "report.json"));
        std::string old;
        for (const auto& subject : report["subject"])
            if (subject["name"] == file) old = subject["digest"]["sha256"];
        ASSERT_EQ(old.size(), 64U) << file;
        const std::string now =
            run_process({"sha256sum", (run() / file).string()}).output.substr(0, 64);
        std::string text = read_file(run() / "report.json");
        for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old))
            text.replace(at, 64, now);
        write_file_atomically(run() / "report.json", text);
    }

    /// A file among what was superseded of the run whose report.json this was.
    fs::path superseded(const std::string& report, const std::string& file) const {
        return run() / "superseded" / sha256_hex(report).substr(0, 16) / file;
    }

    /// Of what programs make for a while, nothing is left in the run folder or beside it.
    void expect_nothing_left() const {
        for (const fs::path& folder : {run(), run().parent_path()})
            for (const auto& entry : fs::directory_iterator(folder))
                EXPECT_FALSE(entry.path().filename().string().starts_with(".runcert-")) << entry;
    }

    static bool says(const nlohmann::json& value, const std::string& part) {
        return value.dump().find(part) != std::string::npos;
    }

    static inline TemporaryFolder* shared_ = nullptr;
    static inline std::map<std::string, std::string> lines_{};
    TemporaryFolder folder_;
};

}  // namespace runcert::chain
