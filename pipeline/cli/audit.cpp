#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "files/process.h"

namespace runcert {
namespace {

struct AuditOptions {
    std::string run_dir;
    std::string receiver;
    bool all = false;
};

int audit(const AuditOptions& options) {
    std::vector<std::string> command{(program_folder() / "runcert-audit").string(),
                                     options.run_dir};
    if (!options.receiver.empty()) command.insert(command.end(), {"--receiver", options.receiver});
    if (options.all) command.emplace_back("--all");
    const ProcessResult result = run_process(command);
    fmt::print("{}", result.output);
    fmt::print(stderr, "{}", result.errors);
    return result.exit_status;
}

}  // namespace

void add_audit(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<AuditOptions>();
    CLI::App* command =
        app.add_subcommand("audit", "Every decision of screening, with its row in the recording");
    command->add_option("RUN_DIR", options->run_dir, "folder that certify wrote")->required();
    command->add_option("--receiver", options->receiver, "id of the receiver (default: all)");
    command->add_flag("--all", options->all, "list the epochs used too, one by one");
    command->footer(
        "For each receiver: what the tests rested on; every epoch left out and every break, with\n"
        "its place in the recording, its reason and, where a test decided, its statistic; the\n"
        "smallest errors that the tests find. Hashes are checked; nothing is written.");
    command->callback([&chosen, options] { chosen = [options] { return audit(*options); }; });
}

}  // namespace runcert
