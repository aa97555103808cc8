#include "batch/run_record.h"

#include "core/failure.h"
#include "files/atomic_file.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* form = "runcert-record/1";

Json json_of(const StepRecord& step) {
    return {{"programs", step.programs}, {"settings", step.settings}, {"inputs", step.inputs},
            {"outputs", step.outputs},   {"said", step.said},         {"seconds", step.seconds}};
}

StepRecord step_of(const Json& json) {
    using Hashes = std::map<std::string, std::string>;
    return {.programs = json.at("programs").get<Hashes>(),
            .settings = json.at("settings"),
            .inputs = json.at("inputs").get<Hashes>(),
            .outputs = json.at("outputs").get<Hashes>(),
            .said = json.at("said").get<std::vector<std::string>>(),
            .seconds = json.at("seconds").get<double>()};
}

RunRecord record_of(const Json& json) {
    RunRecord record;
    if (json.at("form") != form) return record;
    for (const auto& [name, step] : json.at("steps").items())
        record.steps[name] = step_of(step);
    record.published = json.at("published").get<std::vector<std::string>>();
    if (json.contains("failure")) {
        const Json& failure = json.at("failure");
        record.failure = RunFailure{.step = failure.at("step"),
                                    .problem = failure.at("problem"),
                                    .where = failure.at("where"),
                                    .remedy = failure.at("remedy")};
    }
    return record;
}

}  // namespace

RunRecord read_run_record(const std::filesystem::path& file) {
    if (!std::filesystem::exists(file)) return {};
    try {
        return record_of(Json::parse(read_file(file)));
    } catch (const Json::exception&) {
        return {};
    }
}

void write_run_record(const std::filesystem::path& file, const RunRecord& record) {
    Json json{{"form", form}, {"steps", Json::object()}, {"published", record.published}};
    for (const auto& [name, step] : record.steps)
        json["steps"][name] = json_of(step);
    if (record.failure)
        json["failure"] = {{"step", record.failure->step},
                           {"problem", record.failure->problem},
                           {"where", record.failure->where},
                           {"remedy", record.failure->remedy}};
    write_file_atomically(file, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace runcert
