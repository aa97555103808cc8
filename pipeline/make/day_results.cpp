#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "make/day_run.h"
#include "make/run_record.h"
#include "schemas/common/product_files.h"
#include "store/atomic_file.h"
#include "store/folder.h"
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

/// Folders of results that hold a run of no attempt of the day.
std::vector<std::string> runs_without_attempt(const Day& day, const fs::path& out) {
    std::set<std::string> ids;
    for (const DayAttempt& attempt : day.attempts)
        ids.insert(attempt.id);
    std::vector<std::string> names;
    const Folder results(out);
    for (const std::string& name : results.names())
        if (!ids.contains(name) && results.kind_of(name) == EntryKind::folder &&
            !name.starts_with('.') && fs::exists(out / name / "report.json"))
            names.push_back(name);
    return names;
}

/// Moves an entry that this user's calls did not write to the first free name among what was
/// superseded.
void set_aside(const Folder& folder, const std::string& name) {
    const Folder kept = folder.make(batch_folder).make("superseded");
    std::string free = name;
    for (int number = 2; kept.kind_of(free) != EntryKind::none; ++number)
        free = fmt::format("{}.{}", name, number);
    folder.rename(name, kept, free);
}

/// What became of each attempt, as runcert-day reads it.
std::string results_list_text(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                              const fs::path& out) {
    Json list{{"day", day.name}, {"attempts", Json::array()}, {"notes", day.notes}};
    for (const std::string& id : runs_without_attempt(day, out))
        list["notes"].push_back(
            fmt::format("The folder {} holds a run that no attempt of this day makes", id));
    for (std::size_t i = 0; i < outcomes.size(); ++i)
        list["attempts"].push_back(attempt_json(day.attempts[i], outcomes[i], out));
    return list.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

void make_day_results(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                      const fs::path& out) {
    const std::string list = results_list_text(day, outcomes, out);
    const fs::path program = program_folder() / "runcert-day";
    StepRecord now{.programs = {{"runcert-day", digest_file(program).sha256}},
                   .settings = Json::object(),
                   .inputs = {{"list", sha256_hex(list)}}};
    const auto hash_of = [&out](const char* name) {
        const fs::path file = out / name;
        return fs::is_regular_file(fs::symlink_status(file)) ? digest_file(file).sha256 : "";
    };
    const std::string earlier = hash_of(day_files.front());
    const StepRecord before = recalled_record(earlier)[results_step];
    if (what_changed(before, now).empty() && are_as_written(out, before.outputs)) return;
    for (const std::string name : day_files) {
        const auto known = before.outputs.find(name);
        if (fs::exists(fs::symlink_status(out / name)) &&
            (known == before.outputs.end() || !are_as_written(out, {*known})))
            set_aside(Folder(out), name);
    }
    const fs::path list_file = out / batch_folder / "results.json";
    write_file_atomically(list_file, list);
    const std::chrono::minutes limit(10);
    const ProcessResult result =
        run_process({program.string(), "--out", out.string(), "--list", list_file.string()},
                    {.time_limit = limit, .most_output = most_output_of_step, .own_group = true});
    if (result.end != ProcessEnd::by_itself || result.exit_status != 0) {
        const RunFailure failure = failure_of_program(results_step, result, limit);
        throw Failure(failure.where, failure.problem, failure.remedy);
    }
    for (const char* name : day_files)
        now.outputs[name] = hash_of(name);
    remember_record(now.outputs[day_files.front()], {{results_step, now}}, earlier);
}

}  // namespace runcert
