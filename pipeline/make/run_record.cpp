#include "make/run_record.h"

#include <unistd.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "core/failure.h"
#include "run/steps.h"
#include "schemas/common/product_files.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "store/sha256.h"
#include "trust/signature_files.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* form = "runcert-record/2";
constexpr const char* seal = "seal";
/// A record of a run with 20 receivers has some 50 kB.
constexpr std::uintmax_t longest_record = std::uintmax_t{4} << 20;

std::string text_of(const Json& json) {
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json json_of(const StepRecord& step) {
    return {{"programs", step.programs}, {"settings", *step.settings}, {"inputs", step.inputs},
            {"outputs", step.outputs},   {"said", step.said},          {"seconds", step.seconds}};
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

/// Whether a batch makes files of that name.
bool is_made_by_a_batch(const std::string& name) {
    return is_file_of_a_run(name) || name == "report.json" || is_page_name(name);
}

RunRecord foreign_record() {
    RunRecord record;
    record.foreign = true;
    return record;
}

/// A record says what need not be made again and which files are to be removed: one that this
/// user's program did not write must not be read.
RunRecord record_of(Json json, const RecordPlace& place) {
    RunRecord record;
    const std::string written = json.at(seal).get<std::string>();
    json.erase(seal);
    if (!place.key.sealed(text_of(json), written) || json.at("form") != form ||
        json.at("of") != place.of)
        return foreign_record();
    for (const auto& [name, step] : json.at("steps").items())
        record.steps[name] = step_of(step);
    for (const std::string name : json.at("published")) {
        // These are removed one day: only what a batch makes may be among them.
        if (!is_made_by_a_batch(name)) return foreign_record();
        record.published.push_back(name);
    }
    if (json.contains("failure")) {
        const Json& failure = json.at("failure");
        record.failure = RunFailure{.step = failure.at("step"),
                                    .problem = failure.at("problem"),
                                    .where = failure.at("where"),
                                    .remedy = failure.at("remedy")};
    }
    return record;
}

constexpr const char* not_installed = "none";

}  // namespace

RunRecord read_run_record(const RecordPlace& place) {
    if (!std::filesystem::exists(place.file)) return {};
    std::error_code error;
    if (std::filesystem::file_size(place.file, error) > longest_record && !error)
        return foreign_record();
    bool too_deep = false;
    const auto depth_guard = [&too_deep](int depth, Json::parse_event_t, Json&) {
        constexpr int deepest = 64;  // writing out what is deeper would exhaust the stack
        too_deep = too_deep || depth > deepest;
        return !too_deep;
    };
    try {
        Json json = Json::parse(read_file(place.file), depth_guard);
        return too_deep ? foreign_record() : record_of(std::move(json), place);
    } catch (const Json::exception&) {
        return foreign_record();
    }
}

void write_run_record(const RecordPlace& place, const RunRecord& record) {
    Json json{{"form", form},
              {"of", place.of},
              {"steps", Json::object()},
              {"published", record.published}};
    for (const auto& [name, step] : record.steps)
        json["steps"][name] = json_of(step);
    if (record.failure)
        json["failure"] = {{"step", record.failure->step},
                           {"problem", record.failure->problem},
                           {"where", record.failure->where},
                           {"remedy", record.failure->remedy}};
    json[seal] = place.key.seal(text_of(json));
    // Lost by a power cut, it costs making the run again. But what was published must be known, to
    // be removed when the run no longer has it.
    if (record.published.empty())
        write_file_unsynced(place.file, text_of(json));
    else
        write_file_atomically(place.file, text_of(json));
}

std::string program_hash(const std::string& program) {
    const fs::path file =
        program.find('/') == std::string::npos ? external_program_file(program) : fs::path(program);
    if (fs::is_regular_file(file) && access(file.c_str(), X_OK) == 0)
        return digest_file(file).sha256;
    return not_installed;
}

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
