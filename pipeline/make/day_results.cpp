#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "make/day_run.h"
#include "make/run_files.h"
#include "make/run_marks.h"
#include "make/run_record.h"
#include "schemas/common/product_files.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "store/sha256.h"
#include "trust/attestation.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* results_step = "results";
constexpr std::array day_files{"day.yaml", "day.csv", "day.html"};

Json file_json(const DayAttempt& attempt, const FileHashes& files, const std::string& name,
               const fs::path& out) {
    const std::string file = attempt.id + "/" + name;
    return {{"file", file}, {"sha256", files.at(name)}, {"bytes", fs::file_size(out / file)}};
}

void add_done(Json& json, const DayAttempt& attempt, const FileHashes& files, const fs::path& out) {
    json["verdict"] = file_json(attempt, files, std::string(products::verdict_file), out);
    json["report"] = file_json(attempt, files, "report.json", out);
    json["observations"] = Json::array();
    for (const auto& [name, hash] : files)
        if (name.starts_with(products::observations.stem))
            json["observations"].push_back(file_json(attempt, files, name, out));
    for (const std::string& name : attestation_names(out / attempt.id)) {
        const std::string file = attempt.id + "/" + name;
        if (!fs::is_regular_file(out / file)) continue;
        const FileDigest digest = digest_file(out / file);
        json["attestations"].push_back(
            {{"file", file}, {"sha256", digest.sha256}, {"bytes", digest.bytes}});
    }
    json["pages"] = Json::array();
    for (const char* const page : page_names)
        if (files.contains(page)) json["pages"].push_back(fmt::format("{}/{}", attempt.id, page));
    json["notes"] = Json::array();
}

Json attempt_json(const DayAttempt& attempt, const AttemptOutcome& outcome, const fs::path& out) {
    Json json{{"id", attempt.id}, {"source", attempt.source}, {"state", outcome.state}};
    if (outcome.state == "done") add_done(json, attempt, outcome.files, out);
    if (outcome.failure) {
        json["step"] = outcome.failure->step;
        json["problem"] = outcome.failure->problem;
        json["where"] = outcome.failure->where;
        json["remedy"] = outcome.failure->remedy;
    }
    if (outcome.state == "not_processed") json["reason"] = outcome.reason;
    return json;
}

bool are_as_written(const fs::path& out, const FileHashes& files) {
    return std::ranges::all_of(files, [&](const auto& file) {
        return fs::is_regular_file(out / file.first) &&
               digest_file(out / file.first).sha256 == file.second;
    });
}

/// What became of each attempt, as runcert-day reads it.
std::string results_list_text(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                              const BatchContext& context) {
    const fs::path& out = context.out;
    Json list{{"day", day.name}, {"attempts", Json::array()}, {"notes", day.notes}};
    for (const std::string& id : mark_runs(day, outcomes, context))
        list["notes"].push_back(
            fmt::format("The folder {} holds a run that no attempt of this day makes", id));
    for (std::size_t i = 0; i < outcomes.size(); ++i)
        list["attempts"].push_back(attempt_json(day.attempts[i], outcomes[i], out));
    return list.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

void make_day_results(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                      const BatchContext& context) {
    const BatchFolders folders(context.out);
    const std::string list = results_list_text(day, outcomes, context);
    const std::string program = (context.program_folder / "runcert-day").string();
    StepRecord now{.programs = {{"runcert-day", program_hash(program)}},
                   .settings = Json::object(),
                   .inputs = {{"list", sha256_hex(list)}},
                   .outputs = {},
                   .said = {}};
    const RecordPlace place{
        .file = folders.results_record(), .of = "day", .key = context.record_key};
    RunRecord record = read_run_record(place);
    const auto known = record.steps.find(results_step);
    if (known != record.steps.end() && what_changed(known->second, now).empty() &&
        are_as_written(context.out, known->second.outputs))
        return;
    for (const std::string name : day_files) {
        const fs::path file = context.out / name;
        const auto before = known == record.steps.end() ? FileHashes() : known->second.outputs;
        if (fs::exists(fs::symlink_status(file)) &&
            !are_as_written(context.out, {{name, before.contains(name) ? before.at(name) : ""}}))
            set_aside(Folder(context.out), name, context.out);
    }
    write_file_atomically(folders.results_list(), list);
    const ProcessResult result = run_process(
        {program, "--out", context.out.string(), "--list", folders.results_list().string()},
        {.time_limit = context.time_limit, .most_output = most_output_of_step, .own_group = true});
    if (result.end != ProcessEnd::by_itself || result.exit_status != 0) {
        const RunFailure failure = failure_of_program(results_step, result, context.time_limit);
        throw Failure(failure.where, failure.problem, failure.remedy);
    }
    for (const char* name : day_files)
        now.outputs[name] = digest_file(context.out / name).sha256;
    record.steps[results_step] = std::move(now);
    write_run_record(place, record);
}

int write_results_of(const Day& day, const std::vector<RunState>& states,
                     const BatchContext& context, std::string_view words_before) {
    std::vector<AttemptOutcome> outcomes;
    for (std::size_t i = 0; i < states.size(); ++i)
        outcomes.push_back(outcome_of(day.attempts[i], states[i],
                                      "it was not run to its end; the same command makes it"));
    make_day_results(day, outcomes, context);
    const auto done =
        static_cast<std::size_t>(std::ranges::count(outcomes, "done", &AttemptOutcome::state));
    fmt::print("{}{} of {} attempts done; results {}\n", words_before, done, outcomes.size(),
               (context.out / "day.html").string());
    return done == outcomes.size() ? 0 : 2;
}

}  // namespace runcert
