#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "files/atomic_file.h"
#include "run/evidence.h"
#include "run/stage_main.h"
#include "stages/import/import.h"
#include "stages/import/inspect.h"

using namespace runcert;

namespace {

/// Brings everything from outside into the run folder: after this stage nothing else is read.
void import_attempt(StageRun& run, const std::optional<std::filesystem::path>& evidence) {
    const Attempt& attempt = run.attempt();
    for (const std::string& claimed : attempt.profiles) {
        const std::string text = find_profile(claimed, run.attempt_path(), evidence);
        (void)read_profile(text, claimed);
        run.write(evidence_profile_file(claimed), text);
    }
    run.write(std::string(evidence_attempt_file), run.attempt_text());
    for (const Receiver& receiver : attempt.receivers) {
        StageRun one = run;
        const std::string bytes = find_recording(receiver, run.attempt_path(), evidence);
        const std::string original = std::filesystem::path(receiver.recording).filename().string();
        one.note_attempt();
        one.note_input("recording", evidence_recording_file(receiver), bytes, original);
        Observations observations =
            import_recording(receiver, {.name = receiver.recording, .bytes = bytes});
        one.write(evidence_recording_file(receiver), bytes);
        observations.header = one.header();
        one.write(product_file(attempt, receiver, "1-observations", "ecsv"),
                  write_observations(observations));
        run.say(fmt::format("{} epochs from {} ({})", observations.rows.size(), original,
                            observations.format));
    }
}

int inspect_file(const std::string& path) {
    const std::string bytes = read_file(path);
    Receiver receiver;
    receiver.id = "inspected";
    receiver.recording = path;
    receiver.format = "auto";
    const Observations observations = import_recording(receiver, {.name = path, .bytes = bytes});
    fmt::print("{}", inspection_text(inspect(observations), path));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 3 && std::string_view(argv[1]) == "--inspect")
        return guarded_main([&] { return inspect_file(argv[2]); });
    std::string evidence;
    return stage_main(
        argc, argv, "import",
        "Any supported recording to one table of WGS 84 positions in GPS time",
        [&](StageRun& run) {
            import_attempt(run, evidence.empty() ? std::nullopt
                                                 : std::optional<std::filesystem::path>(evidence));
        },
        [&](CLI::App& app) {
            app.add_option("--evidence", evidence,
                           "take recordings and profiles from this run folder's copies instead of "
                           "where the attempt says");
        });
}
