#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace runcert {

/// A subcommand adds itself to the program, and sets `chosen` where it was typed. What it returns
/// is the exit status: 0 yes, 1 no, 2 could not.
using Command = std::function<int()>;

void add_new(CLI::App& app, Command& chosen);
void add_certify(CLI::App& app, Command& chosen);
void add_batch(CLI::App& app, Command& chosen);
void add_verify(CLI::App& app, Command& chosen);
void add_sign(CLI::App& app, Command& chosen);
void add_attest(CLI::App& app, Command& chosen);
void add_timestamp(CLI::App& app, Command& chosen);
void add_inspect(CLI::App& app, Command& chosen);
void add_simulate(CLI::App& app, Command& chosen);
void add_surface(CLI::App& app, Command& chosen);
void add_keygen(CLI::App& app, Command& chosen);
void add_audit(CLI::App& app, Command& chosen);
void add_diff(CLI::App& app, Command& chosen);
void add_explain(CLI::App& app, Command& chosen);
void add_compare(CLI::App& app, Command& chosen);
void add_bundle(CLI::App& app, Command& chosen);
void add_export(CLI::App& app, Command& chosen);
void add_seal(CLI::App& app, Command& chosen);

// What several of them do.

/// Options of a companion program, each passed on where its value is not empty.
using PassedOptions = std::vector<std::pair<std::string, std::string>>;

/// Runs the companion program `runcert-NAME` on a run, a folder or a bundle (empty: on none), prints
/// what it says on standard output and standard error, and gives its exit status. Failure where the
/// program is not there.
int run_companion(const std::string& name, const std::string& run,
                  const std::vector<std::string>& arguments, const PassedOptions& options = {});

/// Renders the pages of a run again, which show who signed and answered, with the keys of a roster
/// where one is named. A sealed PDF goes to superseded/, since a seal is of the page as it was. The
/// exit status: 2 where they could not be rendered, which is said after `done`, what was done.
int render_pages(const std::filesystem::path& run_dir, const std::string& roster,
                 const std::string& done);

/// The option that limits the time of a command that makes or checks a run.
void add_time_limit(CLI::App& command);

/// Whether a file lies in a run folder, or is the run itself, and so is the sender's word.
bool lies_in(const std::filesystem::path& file, const std::filesystem::path& run_dir);

/// Failure where the roster named lies in the run: pages go by the reader's own. Empty is none.
/// Also, for what makes or packs pages, where they go by a roster already, and this is not it.
void require_own_roster(const std::string& roster, const std::filesystem::path& run_dir,
                        bool for_pages = false);

}  // namespace runcert
