#include <CLI/CLI.hpp>

#include "commands.h"

namespace runcert {
namespace {

struct AuditOptions {
    std::string run_dir;
    std::vector<std::string> stages;
    std::string receiver;
    std::string html;
    bool all = false;
};

int audit(const AuditOptions& options) {
    std::vector<std::string> arguments;
    if (options.all) arguments.emplace_back("--all");
    for (const std::string& stage : options.stages)
        arguments.insert(arguments.end(), {"--stage", stage});
    return run_companion("audit", options.run_dir, arguments,
                         {{"--receiver", options.receiver}, {"--html", options.html}});
}

}  // namespace

void add_audit(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<AuditOptions>();
    CLI::App* command = app.add_subcommand(
        "audit", "A walk through a run: every input, decision and result, with its evidence");
    command
        ->add_option("RUN_DIR", options->run_dir, "folder that certify wrote, or a bundle of one")
        ->required();
    command
        ->add_option("--stage", options->stages,
                     "import, enu, screen, smooth, window or check alone (may be repeated)")
        ->allow_extra_args(false);
    command->add_option("--receiver", options->receiver, "id of the receiver (default: all)");
    command->add_flag("--all", options->all,
                      "nothing cut: hashes in full, every parameter, the epochs used one by one");
    command->add_option("--html", options->html,
                        "write the walk to this file as one page, instead of printing it");
    command->footer(
        "What the run is and who made its files; then for each stage and receiver what came in,\n"
        "with its hash, what went out, every decision with its evidence and its line in the\n"
        "recording, and every parameter or figure of a rule that the attempt replaced. Files that\n"
        "are missing are named. Every hash that a file names of another is computed again; one\n"
        "that does not hold ends the audit with status 2. In the run folder nothing is written.");
    command->callback([&chosen, options] { chosen = [options] { return audit(*options); }; });
}

}  // namespace runcert
