#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "files/process.h"

namespace runcert {
namespace {

struct ExplainOptions {
    std::string run_dir;
    std::string clause;
    std::string profile;
    bool profiles = false;
};

int explain(const ExplainOptions& options) {
    std::vector<std::string> command{(program_folder() / "runcert-explain").string()};
    if (options.profiles) command.emplace_back("--profiles");
    if (!options.profile.empty()) command.insert(command.end(), {"--profile", options.profile});
    for (const std::string& word : {options.run_dir, options.clause})
        if (!word.empty()) command.push_back(word);
    const ProcessResult result = run_process(command);
    fmt::print("{}", result.output);
    fmt::print(stderr, "{}", result.errors);
    return result.exit_status;
}

}  // namespace

void add_explain(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<ExplainOptions>();
    CLI::App* command =
        app.add_subcommand("explain", "What decides a verdict, clause by clause, in plain words");
    command->add_option("RUN_DIR", options->run_dir, "folder that certify wrote");
    command->add_option("CLAUSE", options->clause,
                        "flat-course, nalsa/flat-course, or outcome (default: all in short)");
    command->add_option("--profile", options->profile, "id of the profile (default: all)");
    command->add_flag("--profiles", options->profiles,
                      "list the profiles that come with the program");
    command->footer(
        "Of a clause: its text and source, how its figure is computed and compared, the figures\n"
        "with their uncertainties, the limit, what the attempt replaced, the outcome, and what a\n"
        "person must do where the data do not decide. `outcome` or `decision` as CLAUSE explains\n"
        "how the record was compared with. Hashes are checked; nothing is written.");
    command->callback([&chosen, options] { chosen = [options] { return explain(*options); }; });
}

}  // namespace runcert
