#include <CLI/CLI.hpp>

#include "commands.h"

namespace runcert {
namespace {

struct ExplainOptions {
    std::string run_dir;
    std::string clause;
    std::string profile;
    std::string roster;
    bool profiles = false;
    bool clauses = false;
    bool inputs = false;
};

int explain(const ExplainOptions& options) {
    require_own_roster(options.roster, options.run_dir);
    std::vector<std::string> arguments;
    if (options.profiles) arguments.emplace_back("--profiles");
    if (options.clauses) arguments.emplace_back("--clauses");
    if (options.inputs) arguments.emplace_back("--inputs");
    if (!options.clause.empty()) arguments.push_back(options.clause);
    return run_companion("explain", options.run_dir, arguments,
                         {{"--profile", options.profile}, {"--roster", options.roster}});
}

}  // namespace

void add_explain(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<ExplainOptions>();
    CLI::App* command =
        app.add_subcommand("explain", "What decides a verdict, clause by clause, in plain words");
    command->add_option("RUN_DIR", options->run_dir,
                        "folder that certify wrote, or a bundle of one");
    command->add_option("CLAUSE", options->clause,
                        "flat-course, nalsa/flat-course, or outcome (default: all in short)");
    command->add_option("--profile", options->profile, "id of the profile (default: all)");
    command->add_option("--roster", options->roster, "whose answers and signatures count");
    command->add_flag("--profiles", options->profiles,
                      "list the profiles that come with the program");
    command->add_flag("--clauses", options->clauses,
                      "with --profiles: a table of their clauses, and where each is known from");
    command->add_flag("--inputs", options->inputs,
                      "list who says what of an attempt, and who answers for it");
    command->footer(
        "Of a clause: its text and source, how its figure is computed and compared, the figures\n"
        "with their uncertainties, the limit, what the attempt replaced, the outcome, and what a\n"
        "official must attest where the recording does not decide. `outcome` or `decision` as\n"
        "CLAUSE explains how the record was compared with. Hashes are checked; nothing is "
        "written.");
    command->callback([&chosen, options] { chosen = [options] { return explain(*options); }; });
}

}  // namespace runcert
