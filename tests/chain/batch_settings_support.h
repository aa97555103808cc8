#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "chain_support.h"
#include "make/claim.h"
#include "schemas/common/header.h"

// Attempts that differ in one key or several, and what the stages make of them: what the steps of a
// batch say they depend on is held against what they do depend on.

namespace runcert::chain {

using Json = nlohmann::ordered_json;

/// The stages before check, which is given the attempt and the profiles as inputs.
inline const std::vector<std::string> judged_steps{"import", "enu", "screen", "smooth", "window"};

inline Json json_of(const std::string& yaml) {
    return json_from_yaml(YamlValue(parse_yaml(yaml, "test"), "test"));
}

/// Another value for a key, or for several that only go together.
struct Change {
    std::string key;                    ///< of the field table
    std::map<std::string, Json> edits;  ///< JSON pointers into {attempt, rules}; null takes away
    std::set<std::string> redone;       ///< the judged steps that depend on it
};

inline std::set<std::string> words_in(const std::string& text) {
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

/// A table of changes: `- {key, set: {POINTER: VALUE}, redoes: "enu smooth"}`.
inline std::vector<Change> changes_in(const std::string& yaml) {
    std::vector<Change> changes;
    for (const Json& entry : json_of(yaml)) {
        Change change{
            .key = entry.at("key"), .edits = {}, .redone = words_in(entry.value("redoes", ""))};
        for (const auto& [pointer, value] : entry.at("set").items())
            change.edits[pointer] = value;
        changes.push_back(std::move(change));
    }
    return changes;
}

inline void apply(Json& document, const std::map<std::string, Json>& edits) {
    for (const auto& [pointer, value] : edits) {
        const Json::json_pointer at(pointer);
        if (!value.is_null())
            document[at] = value;
        else if (document.at(at.parent_pointer()).is_array())
            document.at(at.parent_pointer()).erase(std::stoul(at.back()));
        else
            document.at(at.parent_pointer()).erase(at.back());
    }
}

/// An attempt with its profiles and recordings in a folder of its own.
class AttemptCase {
  public:
    /// `document` is {attempt: {...}, rules: {NAME: {...}}}, `files` what stands beside.
    AttemptCase(const fs::path& folder, const Json& document, const fs::path& files)
        : folder_(folder) {
        fs::create_directories(folder_);
        for (const auto& entry : fs::directory_iterator(files))
            fs::copy_file(entry.path(), folder_ / entry.path().filename());
        for (const auto& [name, rule] : document.at("rules").items())
            std::ofstream(folder_ / (name + ".yaml")) << rule.dump(1);
        std::ofstream(file()) << document.at("attempt").dump(1);
        claim_ = read_claim(GivenAttempt{.id = document.at("attempt").at("id"),
                                       .source = "attempt.yaml",
                                       .file = file(),
                                       .folder = folder_});
    }

    fs::path file() const { return folder_ / "attempt.yaml"; }
    const fs::path& folder() const { return folder_; }
    const Attempt& attempt() const { return claim_.attempt; }

    Json settings(const std::string& step) const {
        return *settings_of_step(step, claim_.attempt, claim_.profiles, {});
    }

    /// Does a step in a folder that holds the attempt, its profiles, and of `given` what the step
    /// declares to read; the folder. The test fails where the program does.
    fs::path run(const std::string& step, const fs::path& given) const {
        const fs::path run_dir = folder_ / ("run-" + step);
        fs::create_directories(run_dir);
        const fs::path claim = folder_ / "claim";
        if (fs::create_directory(claim))
            bring_in_claim(claim_.attempt, claim_.text, claim_.source, claim);
        fs::copy(claim, run_dir);
        for (const std::string& name : inputs_of(step_named(step), claim_.attempt))
            fs::copy_file(given / name, run_dir / name, fs::copy_options::overwrite_existing);
        const ProcessResult result =
            run_process(command_of(step_named(step),
                                   {.attempt = run_dir / "attempt.yaml",
                                    .run_dir = run_dir,
                                    .import_options = {"--folder", folder_.string()},
                                    .pages = {"report.html"}},
                                   RUNCERT_PROGRAMS));
        EXPECT_EQ(result.exit_status, 0) << step << "\n" << result.errors;
        return run_dir;
    }

    /// Does all steps, each where it has nothing but what it declares; returns the folder that
    /// holds what they wrote.
    fs::path run_all() const {
        const fs::path all = folder_ / "all";
        fs::create_directories(all);
        bring_in_claim(claim_.attempt, claim_.text, claim_.source, all);
        for (const Step& step : steps()) {
            if (step.program.empty()) continue;
            const fs::path run_dir = run(step.name, all);
            for (const std::string& name : outputs_of(step, attempt(), {.pages = {"report.html"}}))
                if (fs::exists(run_dir / name))
                    fs::copy_file(run_dir / name, all / name, fs::copy_options::overwrite_existing);
        }
        return all;
    }

  private:
    fs::path folder_;
    Claim claim_;
};

/// The steps whose settings differ.
inline std::set<std::string> redone(const AttemptCase& a, const AttemptCase& b) {
    std::set<std::string> changed;
    for (const std::string& step : judged_steps)
        if (a.settings(step).dump() != b.settings(step).dump()) changed.insert(step);
    return changed;
}

/// Whether two changes touch the same keys, and not in the same way.
inline bool overlap(const Change& a, const Change& b) {
    return std::ranges::any_of(a.edits, [&](const auto& one) {
        return std::ranges::any_of(b.edits, [&](const auto& other) {
            if (one.first == other.first) return one.second != other.second;
            return one.first.starts_with(other.first + "/") ||
                   other.first.starts_with(one.first + "/");
        });
    });
}

/// Changes that the same steps depend on, put together where they do not touch the same keys: what
/// the other steps make of all of them at once takes one chain.
inline std::vector<std::vector<Change>> together(const std::vector<Change>& changes) {
    std::vector<std::vector<Change>> groups;
    for (const Change& change : changes) {
        const auto fitting = std::ranges::find_if(groups, [&](const std::vector<Change>& group) {
            return group.front().redone == change.redone &&
                   std::ranges::none_of(
                       group, [&](const Change& other) { return overlap(change, other); });
        });
        (fitting == groups.end() ? groups.emplace_back() : *fitting).push_back(change);
    }
    return groups;
}

}  // namespace runcert::chain
