#include "commands.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "core/failure.h"
#include "run/chain.h"
#include "run/run_lock.h"
#include "schemas/common/product_files.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "trust/signature_files.h"
#include "trust/verification.h"

namespace runcert {

namespace fs = std::filesystem;

CommandLine added_command(CLI::App& app, Command& chosen, const std::string& name,
                          const std::string& summary, Command run) {
    CLI::App* command = app.add_subcommand(name, summary);
    command->callback([&chosen, run = std::move(run)] { chosen = run; });
    return CommandLine(*command);
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

void write_new_file(const fs::path& name, const std::string& text, FileAccess access) {
    AtomicFile file(name, access);
    file.write(text);
    file.commit_as_new();
}

}  // namespace runcert
