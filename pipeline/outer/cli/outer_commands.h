#pragma once

#include "cli/commands.h"

namespace runcert {

void add_new(CLI::App& app, Command& chosen);
void add_batch(CLI::App& app, Command& chosen);
void add_inspect(CLI::App& app, Command& chosen);
void add_plan(CLI::App& app, Command& chosen);
void add_simulate(CLI::App& app, Command& chosen);
void add_surface(CLI::App& app, Command& chosen);
void add_diff(CLI::App& app, Command& chosen);

}  // namespace runcert
