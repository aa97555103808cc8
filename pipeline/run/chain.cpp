#include "run/chain.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/rounding.h"
#include "core/text.h"
#include "schemas/common/product_files.h"
#include "schemas/observations/observations.h"
#include "store/ecsv.h"
#include "store/program.h"
#include "store/yaml_output.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Runs a step's program on the attempt as the claim brought it in, and not on the file, which may
/// change meanwhile. What is wrong with it is for its author to find in the original.
StageDone run_program(const Step& step, const RunInMaking& run) {
    const fs::path copy = run.folder / std::string(attempt_copy_name);
    const fs::path& folder = run.source.folder;
    const std::vector<std::string> taken_from =
        run.source.earlier_run
            ? std::vector<std::string>{"--earlier-run", run.source.earlier_run->string()}
            : std::vector<std::string>{"--folder", folder.empty() ? "." : folder.string()};
    try {
        return run_step(step.name,
                        {.attempt = copy,
                         .run_dir = run.folder,
                         .import_options = taken_from,
                         .pages = run.report.pages},
                        run.process, run.programs);
    } catch (StageFailed& failed) {
        replace_all(failed.result.errors, copy.string(), run.source.file.string());
        replace_all(failed.result.errors, run.folder.string(), run.known_as.string());
        throw;
    }
}

StageDone make_step(const Step& step, const RunInMaking& run) {
    if (step.name == "render" && run.draw) return run.draw();
    if (!step.program.empty()) {
        StageDone done = run_program(step, run);
        done.wrote = outputs_of(step, run.attempt, run.report);
        return done;
    }
    const auto begin = Clock::now();
    StageDone done{.name = step.name};
    if (step.name == "claim") {
        bring_in_claim(run.attempt, run.text, run.source, run.folder);
        done.wrote = outputs_of(step, run.attempt, run.report);
    } else {
        done.wrote = {run.sign()};
    }
    done.seconds = seconds_since(begin);
    return done;
}

/// Refuses tables of recordings that begin after an instant.
void require_recorded(const fs::path& folder, const std::vector<std::string>& tables,
                      GpsTime latest) {
    for (const std::string& name : tables) {
        if (!name.starts_with(products::observations.stem)) continue;
        const FileView view(folder / name);
        const EcsvReader table(view.bytes(), name);  // reads the header alone
        const auto first = read_members<RecordingFacts>(YamlValue(table.meta(), name)).first_epoch;
        if (first && *first > latest)
            throw Failure(name,
                          "the recording begins later than tomorrow: " + to_utc_iso(*first, 0),
                          "Set this computer's clock, or hand in a recording with true times");
    }
}

}  // namespace

GpsTime end_of_tomorrow(std::time_t now) {
    constexpr std::time_t gps_epoch_s = 315'964'800, day_s = 86'400;
    return GpsTime().plus_nanoseconds(((now - gps_epoch_s) / day_s + 2) *
                                      GpsTime::nanoseconds_per_day);
}

std::vector<std::string> own_words(const std::string& errors) {
    const std::vector<std::string> lines = lines_of(errors);
    constexpr std::array heads{std::string_view("error: "), std::string_view("  where: "),
                               std::string_view("  what to do: ")};
    if (lines.size() < heads.size()) return {};
    std::vector<std::string> words;
    for (std::size_t i = 0; i < heads.size(); ++i) {
        const std::string& line = lines[lines.size() - heads.size() + i];
        if (!line.starts_with(heads[i])) return {};
        words.push_back(line.substr(heads[i].size()));
    }
    return words;
}

std::string message_of(const StageFailed& failed) {
    const ProcessResult& result = failed.result;
    if (result.end == ProcessEnd::by_itself && result.exit_status == 2) {
        const std::vector<std::string> words = own_words(result.errors);
        const std::string begin = capitalised(ComputerFailure::prefix);
        if (words.empty() || !words[0].starts_with(begin)) return result.errors;
        throw ComputerFailure(words[1], words[0].substr(begin.size()), words[2]);
    }
    throw Failure(step_named(failed.name).program,
                  fmt::format("the program ended with status {}: {}", result.exit_status,
                              escape_for_message(result.errors, 400)),
                  "This is a fault of the program; please report it with the attempt");
}

std::optional<std::string> failed_call(const StageFailed& failed) {
    for (const std::string& name : step_named(failed.name).calls)
        if (failed.result.errors.find(fmt::format("\n  where: {}\n", name)) != std::string::npos)
            return name;
    return std::nullopt;
}

StageDone run_step(std::string_view step, const StepCall& call, const ProcessOptions& options,
                   const fs::path& programs) {
    const auto begin = Clock::now();
    ProcessResult result = run_process(command_of(step_named(step), call, programs), options);
    if (result.end != ProcessEnd::by_itself || result.exit_status != 0)
        throw StageFailed{std::string(step), std::move(result)};
    return {.name = std::string(step),
            .said = lines_of(result.output),
            .seconds = seconds_since(begin)};
}

void make_run(const RunInMaking& run, const std::function<bool(const Step&)>& stays,
              const std::function<void(const StageDone&)>& done) {
    for (const Step& step : steps()) {
        if (!is_step_of(step, run.report) || stays(step)) continue;
        const StageDone made = make_step(step, run);
        if (step.name == "import" && run.latest)
            require_recorded(run.folder, made.wrote, *run.latest);
        done(made);
    }
}

std::string run_times_text(std::time_t started, const std::vector<StageDone>& stages) {
    nlohmann::ordered_json record;
    record["program"] = program_version();
    record["source_revision"] = source_revision();
    record["started_unix_s"] = started;
    for (const StageDone& stage : stages)
        record["stages"].push_back(
            {{"stage", stage.name}, {"seconds", rounded(stage.seconds, 3)}, {"said", stage.said}});
    return to_yaml_text(record);
}

}  // namespace runcert
