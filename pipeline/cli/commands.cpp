#include "commands.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "run/chain.h"
#include "run/run_lock.h"
#include "schemas/common/product_files.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "store/sha256.h"
#include "trust/bundle.h"
#include "trust/signature_files.h"
#include "trust/verification.h"

namespace runcert {

namespace fs = std::filesystem;

int run_companion(const std::string& name, const std::string& run,
                  const std::vector<std::string>& arguments, const PassedOptions& options) {
    std::vector<std::string> command{(program_folder() / ("runcert-" + name)).string()};
    const GivenRun given(run);
    if (!run.empty()) {
        require_known_versions(given.folder());
        command.push_back(given.folder().string());
    }
    command.insert(command.end(), arguments.begin(), arguments.end());
    for (const auto& [option, value] : options)
        if (!value.empty()) command.insert(command.end(), {option, value});
    ProcessResult result = run_process(command);
    if (given.is_bundle())
        for (std::string* const said : {&result.output, &result.errors})
            replace_all(*said, given.folder().string(), run);
    fmt::print("{}", result.output);
    fmt::print(stderr, "{}", result.errors);
    return result.exit_status;
}

int render_pages(const fs::path& run_dir, const std::string& roster, const std::string& done) {
    // Whoever asked for some pages gets no others later.
    std::vector<std::string> pages = pages_in(run_dir);
    if (pages.empty()) pages.assign(page_names.begin(), page_names.end());
    try {
        {
            const RunLock lock(run_dir);
            keep_sealed_page(run_dir);
        }
        run_step("render", {.attempt = run_dir / "attempt.yaml",
                            .run_dir = run_dir,
                            .pages = pages,
                            .roster = roster});
    } catch (const StageFailed& failed) {
        fmt::print(stderr, "{}{}; its pages could not be made again and do not show it\n",
                   message_of(failed), done);
        return 2;
    }
    fmt::print("pages   {}\n", fmt::join(pages, ", "));
    return 0;
}

void add_time_limit(CLI::App& command) {
    command
        .add_option_function<std::int64_t>(
            "--time-limit", [](std::int64_t limit_s) { limit_time(std::chrono::seconds(limit_s)); },
            "seconds after which it ends with 2 and without a result; what was there stays")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000}));
}

bool lies_in(const fs::path& file, const fs::path& run_dir) {
    std::error_code ignored;
    const fs::path inner = fs::weakly_canonical(file, ignored);
    const fs::path outer = fs::weakly_canonical(run_dir, ignored);
    return std::ranges::mismatch(outer, inner).in1 == outer.end();
}

void require_own_roster(const std::string& roster, const fs::path& run_dir, bool for_pages) {
    if (!roster.empty() && lies_in(roster, run_dir))
        throw Failure(roster, "this roster lies in the run, and vouches for nothing",
                      "Give the roster that you have from the body itself");
    const std::string shown_by = for_pages ? roster_of_pages(run_dir) : "";
    if (shown_by.empty() || (!roster.empty() && sha256_hex(read_handwritten(roster)) == shown_by))
        return;
    throw Failure((run_dir / "report.html").string(),
                  "the pages go by the roster with the SHA-256 " + shown(shown_by),
                  "Give that one with --roster; or first make them again by yours: runcert attest "
                  "RUN --render --roster ROSTER");
}

}  // namespace runcert
