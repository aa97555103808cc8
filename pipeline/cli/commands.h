#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "run/stage_main.h"
#include "store/atomic_file.h"

namespace runcert {

/// A subcommand adds itself to the program, and sets `chosen` where it was typed. What it returns
/// is the exit status: 0 yes, 1 no, 2 could not. Those of the outer ring: outer_commands.h.
using Command = std::function<int()>;

void add_certify(CLI::App& app, Command& chosen);
void add_verify(CLI::App& app, Command& chosen);
void add_sign(CLI::App& app, Command& chosen);
void add_attest(CLI::App& app, Command& chosen);
void add_timestamp(CLI::App& app, Command& chosen);
void add_keygen(CLI::App& app, Command& chosen);
void add_bundle(CLI::App& app, Command& chosen);
void add_receive(CLI::App& app, Command& chosen);
void add_log(CLI::App& app, Command& chosen);
void add_roster(CLI::App& app, Command& chosen);
void add_seal(CLI::App& app, Command& chosen);

CommandLine added_command(CLI::App& app, Command& chosen, const std::string& name,
                          const std::string& summary, Command run);

/// The line of a new command, and what its options are read into; where it is typed, `run` is
/// given them.
template <class Options>
std::pair<CommandLine, Options&> add_command(CLI::App& app, Command& chosen,
                                             const std::string& name, const std::string& summary,
                                             const std::function<int(const Options&)>& run) {
    const auto options = std::make_shared<Options>();
    return {added_command(app, chosen, name, summary, [options, run] { return run(*options); }),
            *options};
}

// What several of them do.

/// Renders the pages of a run again, which show who signed and answered, with the keys of a roster
/// where one is named. A sealed PDF goes to superseded/, since a seal is of the page as it was. The
/// exit status: 2 where they could not be rendered, which is said after `done`, what was done.
int render_pages(const std::filesystem::path& run_dir, const std::string& roster,
                 const std::string& done);

/// Failure where a file of that name is there.
void write_new_file(const std::filesystem::path& name, const std::string& text,
                    FileAccess access = FileAccess::by_umask);

}  // namespace runcert
