#pragma once

#include "signatures_support.h"
#include "store/sha256.h"
#include "trust/attestation.h"
#include "trust/run_standing.h"

namespace runcert::chain {

/// A run of the salt lake with keys for each role that its rule names, and a second judge.
class Attestations : public SignedRuns {
  protected:
    static void SetUpTestSuite() {
        SignedRuns::SetUpTestSuite();
        for (const char* name : {"board", "judge2"}) {
            const std::string role = std::string(name) == "board" ? "board" : "judge";
            const ProcessResult made =
                runcert({"keygen", "--out", (shared_->path() / name).string(), "--role", role,
                         "--no-password"});
            const std::size_t line = made.output.find("roster      ") + 12;
            lines_[name] = made.output.substr(line, made.output.find('\n', line) - line);
        }
        std::string all;
        for (const char* name : {"measurer", "judge", "judge2", "board"})
            all += lines_[name] + "\n";
        write_file_atomically(shared_->path() / "roster", all);
    }

    nlohmann::json report() const {
        return nlohmann::json::parse(read_file(run() / "report.json"))["predicate"];
    }
    /// The clauses that a role answers for.
    std::vector<std::string> due(const std::string& role) const {
        std::vector<std::string> clauses;
        const nlohmann::json all = report();
        for (const auto& one : all["verdict"]["profiles"][0]["requirements"])
            if (one["status"] == "attest" && one["answered_by"]["role"] == role)
                clauses.push_back(one["clause"]);
        return clauses;
    }
    ProcessResult attest(const std::string& name, const std::string& role,
                         const std::vector<std::string>& clauses,
                         const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{"attest", run().string()};
        arguments.insert(arguments.end(), clauses.begin(), clauses.end());
        arguments.insert(arguments.end(),
                         {"--role", role, "--key", key(name), "--yes", "--no-render"});
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments);
    }
    /// The name of the envelope, from the run folder on.
    std::string must_attest(const std::string& name, const std::string& role,
                            const std::vector<std::string>& clauses,
                            const std::vector<std::string>& more = {}) const {
        const ProcessResult result = attest(name, role, clauses, more);
        EXPECT_EQ(result.exit_status, 0) << result.output << result.errors;
        const std::size_t at = result.output.rfind("attestations/answer-");
        return at == std::string::npos
                   ? ""
                   : result.output.substr(at, result.output.find('\n', at) - at);
    }
    /// All that is due, answered yes, the report signed, and the run closed.
    void complete() const {
        answer_all();
        close();
    }
    void answer_all() const {
        for (const char* role : {"measurer", "judge", "board"})
            if (const auto clauses = due(role); !clauses.empty()) must_attest(role, role, clauses);
        must_sign("measurer", "measurer");
    }
    /// The name of the closing statement.
    std::string close(const std::string& name = "board", const std::string& role = "board",
                      const std::string& by = roster()) const {
        return must_attest(name, role, {}, {"--close", "--roster", by});
    }
    static std::string beaten(const std::string& by = roster()) {
        const std::string hash = sha256_hex(read_file(by));
        return fmt::format(
            "nalsa: Record beaten, by the roster {} {}: compare it with your body's. Standing: "
            "complete.",
            hash.substr(0, 4), hash.substr(4, 4));
    }
    static inline const std::string unclosed =
        "nalsa: Measured speed exceeds the record; answers not closed. Standing: answers not "
        "closed.";
    /// Not beaten, and the reason is said.
    void expect_open(const std::string& why) const {
        const auto all = found();
        EXPECT_EQ(standing(all), unclosed) << why;
        EXPECT_TRUE(says(all["standing"], why)) << why << all["standing"].dump(1);
    }
    /// A yes as `attest` would word it.
    Answer answer_to(const std::string& clause) const {
        for (const DueClause& one : due_clauses(read_report_facts(run())))
            if (one.clause == clause)
                return {one.profile, one.clause, one.text, one.shown, std::string(answer_yes)};
        ADD_FAILURE() << clause;
        return {};
    }
    /// An envelope put there by other means than `attest`.
    std::string plant(const Attestation& said, const std::string& name) const {
        const std::string payload = statement_text(said);
        const std::string file = "attestations/" + envelope_name(attestation_id(payload));
        write_file_atomically(run() / file, sign_envelope(payload, secret_key(name)));
        return file;
    }
    static SecretKey secret_key(const std::string& name) {
        return parse_secret_key(read_file(key(name)), std::nullopt, name);
    }
    Attestation read(const std::string& file) const {
        return read_statement(read_envelope(read_file(run() / file), file).payload, file);
    }
    nlohmann::json found() const { return verify_json({"--roster", roster()}); }
    static std::string standing(const nlohmann::json& found) {
        return found["standing"][0].get<std::string>();
    }
    void expect_fault(const std::string& words) const {
        const auto all = found();
        EXPECT_EQ(layer(all, "attestations")["passed"], false) << words;
        EXPECT_TRUE(says(layer(all, "attestations"), words)) << layer(all, "attestations").dump(1);
        EXPECT_EQ(all["exit_status"], 1);
        EXPECT_FALSE(says(all["standing"], "Record beaten")) << all["standing"];
    }
};

}  // namespace runcert::chain
