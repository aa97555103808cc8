#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace runcert {

/// A subcommand adds itself to the program, and sets `chosen` where it was typed. What it returns
/// is the exit status: 0 yes, 1 no, 2 could not.
using Command = std::function<int()>;

void add_certify(CLI::App& app, Command& chosen);
void add_batch(CLI::App& app, Command& chosen);
void add_verify(CLI::App& app, Command& chosen);
void add_sign(CLI::App& app, Command& chosen);
void add_attest(CLI::App& app, Command& chosen);
void add_timestamp(CLI::App& app, Command& chosen);
void add_inspect(CLI::App& app, Command& chosen);
void add_simulate(CLI::App& app, Command& chosen);
void add_keygen(CLI::App& app, Command& chosen);
void add_audit(CLI::App& app, Command& chosen);
void add_diff(CLI::App& app, Command& chosen);
void add_explain(CLI::App& app, Command& chosen);
void add_compare(CLI::App& app, Command& chosen);
void add_bundle(CLI::App& app, Command& chosen);
void add_export(CLI::App& app, Command& chosen);
void add_seal(CLI::App& app, Command& chosen);

}  // namespace runcert
