#include "make/run_record.h"

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

RunRecord recalled_record(const fs::path& run_dir) {
    try {
        const Json json = Json::parse(recalled(run_dir));
        RunRecord record;
        if (json.at("form") != form) return record;
        for (const auto& [name, step] : json.at("steps").items())
            record.steps[name] = step_of(step);
        if (json.contains("failure")) {
            const Json& failure = json.at("failure");
            record.failure = RunFailure{.step = failure.at("step"),
                                        .problem = failure.at("problem"),
                                        .where = failure.at("where"),
                                        .remedy = failure.at("remedy")};
        }
        return record;
    } catch (const Json::exception&) {
        return {};
    }
}

void remember_record(const fs::path& run_dir, const RunRecord& record) {
    Json json{{"form", form}, {"steps", Json::object()}};
    for (const auto& [name, step] : record.steps)
        json["steps"][name] = json_of(step);
    if (record.failure)
        json["failure"] = {{"step", record.failure->step},
                           {"problem", record.failure->problem},
                           {"where", record.failure->where},
                           {"remedy", record.failure->remedy}};
    remember(run_dir, json.dump(1, ' ', false, Json::error_handler_t::replace));
}

namespace {

/// Of the file of that path or, where it holds no slash, of the first of that name in the folders
/// of the system; "none" where there is none.
std::string program_hash(const std::string& program) {
    const fs::path file =
        program.find('/') == std::string::npos ? external_program_file(program) : fs::path(program);
    if (fs::is_regular_file(file) && access(file.c_str(), X_OK) == 0)
        return digest_file(file).sha256;
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
