#include "run/chain.h"

#include <fmt/format.h>

#include <chrono>

#include "core/failure.h"
#include "core/text.h"
#include "files/file_sync.h"
#include "files/process.h"
#include "run/attempt_files.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

}  // namespace

StageDone run_step(std::string_view step, const StepCall& call, const ProcessOptions& options) {
    const Step& what = step_named(step);
    const auto begin = std::chrono::steady_clock::now();
    const ProcessResult result = run_process(command_of(what, call, program_folder()), options);
    if (result.exit_status == 2) throw StageFailed{what.name, result.errors};
    if (result.exit_status != 0)
        throw Failure(what.program,
                      fmt::format("the program ended with status {}: {}", result.exit_status,
                                  escape_for_message(result.errors, 400)),
                      "This is a fault of the program; please report it with the attempt");
    return {
        .name = what.name,
        .said = lines_of(result.output),
        .seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
}

void run_stages(const fs::path& attempt, const fs::path& run_dir, const fs::path& earlier_run,
                const std::function<void(const StageDone&)>& done) {
    StepCall call{.attempt = attempt, .run_dir = run_dir};
    if (!earlier_run.empty()) call.import_options = {"--earlier-run", earlier_run.string()};
    const ProcessOptions options{.environment = {synced_by_caller()}};
    const fs::path copy = run_dir / attempt_copy_name;
    for (const Step& step : steps()) {
        if (step.products.empty()) continue;
        try {
            done(run_step(step.name, call, options));
        } catch (StageFailed& failed) {
            const std::size_t at = failed.errors.find(copy.string());
            if (at != std::string::npos)
                failed.errors.replace(at, copy.string().size(), attempt.string());
            throw;
        }
        // From here on the run folder's own copy of the attempt is read. What is wrong with it is
        // for its author to find in the original.
        call.attempt = copy;
    }
}

}  // namespace runcert
