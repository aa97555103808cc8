#pragma once

#include <gtest/gtest.h>

#include <cstdlib>

#include "chain_support.h"
#include "day_support.h"

// Days that are certified again after something changed, and what was made again then.

namespace runcert::chain {

using Json = nlohmann::ordered_json;

/// What a batch said with --json.
struct BatchSaid {
    int exit_status = 0;
    std::string errors;
    std::string text;  ///< all events
    /// By attempt, why each step ran that did, "smooth" -> "program changed: runcert-smooth".
    std::map<std::string, std::map<std::string, std::string>> ran;
    std::map<std::string, std::string> states;    ///< by attempt: "done", "failed"
    std::map<std::string, std::string> problems;  ///< by attempt that failed
    std::string notes;
    int steps_run = 0;

    /// The steps of an attempt that ran, "claim check report".
    std::string steps_of(const std::string& id) const {
        static const std::vector<std::string> order{"claim",  "import", "enu",   "screen",
                                                    "smooth", "window", "check", "report",
                                                    "sign",   "render"};
        std::string steps;
        const auto found = ran.find(id);
        for (const std::string& step : order)
            if (found != ran.end() && found->second.contains(step))
                steps += (steps.empty() ? "" : " ") + step;
        return steps;
    }
};

inline BatchSaid heard(const ProcessResult& result) {
    BatchSaid said{.exit_status = result.exit_status,
                   .errors = result.errors,
                   .text = result.output,
                   .ran = {},
                   .states = {},
                   .problems = {},
                   .notes = {}};
    std::map<int, std::string> ids;
    std::istringstream lines(result.output);
    for (std::string line; std::getline(lines, line);) {
        const Json event = Json::parse(line);
        const std::string kind = event.at("event");
        if (kind == "note") said.notes += event.at("text").get<std::string>() + "\n";
        if (kind == "begin") ids[event.at("index")] = event.at("id");
        if (kind == "step" && event.at("ran"))
            said.ran[ids.at(event.at("index"))][event.at("step")] = event.at("reason");
        if (kind == "attempt") {
            said.states[event.at("id")] = event.at("state");
            said.problems[event.at("id")] = event.at("error");
        }
        if (kind == "end") said.steps_run = event.at("steps_run");
    }
    return said;
}

inline BatchSaid batch_json(const fs::path& day, const fs::path& out,
                            const std::vector<std::string>& more = {},
                            const std::string& program = RUNCERT_PROGRAMS "/runcert") {
    std::vector<std::string> command{program,      "batch",  day.string(), "--out",
                                     out.string(), "--json", "--jobs",     "1"};
    command.insert(command.end(), more.begin(), more.end());
    return heard(run_process(command));
}

/// Replaces the first occurrence of a text in a file, which must be there.
inline void edit(const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = read_file(file);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from << " in " << file;
    std::ofstream(file, std::ios::binary) << text.replace(at, from.size(), to);
}

/// A day of two attempts, "one" of the day file and "two" of a file of its own with two receivers,
/// each without pages, made once; each test has a copy of the day and of its results.
class Batches : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shared_ = new TemporaryFolder;
        setenv("XDG_STATE_HOME", (shared_->path() / "state").c_str(), 1);
        const fs::path day = shared_->path() / "day";
        make_day(day, 3, 110);
        std::ofstream(day / "own.yaml") << rule;
        std::ofstream(day / "day.yaml") << day_text;
        std::ofstream(day / "two.yaml") << two_text;
        const BatchSaid said = batch_json(day, shared_->path() / "out", {"--no-render"});
        ASSERT_EQ(said.exit_status, 0) << said.errors << said.text;
        ASSERT_EQ(said.steps_run, 16);
    }
    static void TearDownTestSuite() { delete shared_; }
    void SetUp() override {
        fs::copy(shared_->path(), folder_.path(), fs::copy_options::recursive);
        use_state(path("state"));
    }
    /// What the user's programs remember is there from now on.
    static void use_state(const fs::path& folder) {
        setenv("XDG_STATE_HOME", folder.c_str(), 1);
        if (fs::exists(folder / "runcert/made"))
            fs::permissions(folder / "runcert/made", fs::perms::owner_all);
    }

    fs::path day() const { return folder_.path() / "day"; }
    fs::path out() const { return folder_.path() / "out"; }
    fs::path path(const std::string& name) const { return folder_.path() / name; }

    BatchSaid again(const std::vector<std::string>& more = {"--no-render"}) const {
        return batch_json(day(), out(), more);
    }

    /// What a run folder holds, but for the times that a run took.
    static std::map<std::string, std::string> run_contents(const fs::path& run) {
        auto contents = contents_of(run);
        contents.erase("run.yaml");
        // What was changed in it is kept there.
        std::erase_if(contents,
                      [](const auto& file) { return file.first.starts_with("superseded/"); });
        return contents;
    }
    std::map<std::string, std::string> made(const std::string& id) const {
        return run_contents(out() / id);
    }
    /// As the first batch made them.
    static std::map<std::string, std::string> first_made(const std::string& id) {
        return run_contents(shared_->path() / "out" / id);
    }

    /// The key of a person without a password.
    fs::path key(const std::string& name) const {
        const ProcessResult result =
            runcert({"keygen", "--out", path(name).string(), "--no-password"});
        EXPECT_EQ(result.exit_status, 0) << result.errors;
        return path(name + ".key");
    }

    static constexpr const char* rule = R"(schema: profile/1.0
id: own
body: a body
title: a title
window: {duration_s: 3, definition: displacement}
margin: {kind: absolute, value: 1, unit: mph}
clauses: [{id: margin, text: more, source: a book, certainty: quoted, decided_by: margin}]
)";
    static constexpr const char* day_text = R"(schema: day/1.0
id: test-day
defaults:
  craft: {name: simulated, class: land-yacht}
  officials: [{role: measurer}]
  record: {speed: 202.9, unit: km/h, source: "a list"}
  profiles: [own.yaml]
  rules: [{profile: own, figure: margin.value, value: 2}, {profile: own, figure: window.duration_s, value: 2.5}]
  parameters: {screen: {gap_factor: 1.5}, smooth: {robust_scale: 2.0}, window: {selection_samples: 100, monte_carlo_trials_max: 100000}}
attempts:
  - {id: one, recording: recordings/0001.pos}
  - {attempt: two.yaml}
)";
    static constexpr const char* two_text = R"(schema: attempt/1.0
id: two
craft: {name: simulated, class: land-yacht}
receivers:
  - {id: primary, recording: recordings/0002.pos}
  - {id: spare, recording: recordings/0003.pos}
profiles: [own.yaml]
parameters: {window: {selection_samples: 100, monte_carlo_trials_max: 100000}}
)";

  private:
    inline static TemporaryFolder* shared_ = nullptr;
    TemporaryFolder folder_;
};

}  // namespace runcert::chain
