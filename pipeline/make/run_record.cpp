#include "make/run_record.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "core/failure.h"
#include "run/steps.h"
#include "store/external_program.h"
#include "store/sha256.h"
#include "store/user_state.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* form = "runcert-made/1";

std::string text_of(const Json& json) {
    return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

Json json_of(const StepRecord& step) {
    return {{"programs", step.programs}, {"settings", *step.settings}, {"inputs", step.inputs},
            {"outputs", step.outputs},   {"said", step.said},          {"seconds", step.seconds}};
}

StepRecord step_of(const Json& json) {
    return {.programs = json.at("programs").get<FileHashes>(),
            .settings = json.at("settings"),
            .inputs = json.at("inputs").get<FileHashes>(),
            .outputs = json.at("outputs").get<FileHashes>(),
            .said = json.at("said").get<std::vector<std::string>>(),
            .seconds = json.at("seconds").get<double>()};
}

constexpr const char* not_installed = "none";

}  // namespace

RunRecord recalled_record(const std::string& sha256) {
    if (sha256.empty()) return {};
    try {
        const Json json = Json::parse(recalled("run " + sha256));
        RunRecord record;
        if (json.at("form") != form) return {};
        for (const auto& [name, step] : json.at("steps").items())
            record[name] = step_of(step);
        return record;
    } catch (const Json::exception&) {
        return {};
    }
}

void remember_record(const std::string& sha256, const RunRecord& record,
                     const std::string& before) {
    if (!before.empty() && before != sha256) remember("run " + before, {});
    Json json{{"form", form}, {"steps", Json::object()}};
    for (const auto& [name, step] : record)
        json["steps"][name] = json_of(step);
    remember("run " + sha256, text_of(json));
}

std::optional<RunFailure> recalled_failure(const fs::path& run_dir, const FileHashes& claim) {
    try {
        const Json json = Json::parse(recalled(about_folder("failure", run_dir)));
        if (json.at("claim").get<FileHashes>() != claim) return std::nullopt;
        return RunFailure{.step = json.at("step"),
                          .problem = json.at("problem"),
                          .where = json.at("where"),
                          .remedy = json.at("remedy")};
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

void remember_failure(const fs::path& run_dir, const FileHashes& claim,
                      const std::optional<RunFailure>& failure) {
    remember(about_folder("failure", run_dir), failure ? text_of({{"claim", claim},
                                                                  {"step", failure->step},
                                                                  {"problem", failure->problem},
                                                                  {"where", failure->where},
                                                                  {"remedy", failure->remedy}})
                                                       : "");
}

namespace {

/// Of the file of that path or, where it holds no slash, of the first of that name in the folders
/// of the system; "none" where there is none.
std::string program_hash(const std::string& program) {
    const fs::path file =
        program.find('/') == std::string::npos ? external_program_file(program) : fs::path(program);
    if (fs::is_regular_file(file) && access(file.c_str(), X_OK) == 0) return remembered_sha256(file);
    return not_installed;
}

}  // namespace

std::map<std::string, StepPrograms> programs_of_steps(const fs::path& folder) {
    std::map<std::string, std::string> known;
    const auto hash_of = [&](const std::string& program) {
        const auto [entry, is_new] = known.try_emplace(program);
        if (is_new) entry->second = program_hash(program);
        return entry->second;
    };
    std::map<std::string, StepPrograms> all;
    for (const Step& step : steps()) {
        StepPrograms& programs = all[step.name];
        if (!step.program.empty()) {
            const std::string file = fs::absolute(folder / step.program).string();
            programs[step.program] = hash_of(file);
            if (programs[step.program] == not_installed)
                throw Failure(file, "the program of a stage is missing",
                              "Build or install the program again");
        }
        for (const std::string& other : step.calls)
            programs[other] = hash_of(other);
    }
    return all;
}

}  // namespace runcert
