#include <CLI/CLI.hpp>

#include "commands.h"

namespace runcert {

void add_inspect(CLI::App& app, Command& chosen) {
    auto recording = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand("inspect", "Say what a recording is, in a few lines");
    command->add_option("RECORDING", *recording, "the recording's file")->required();
    auto navigation = std::make_shared<std::string>();
    command->add_option("--navigation", *navigation,
                        "broadcast orbits for raw measurements (RINEX); else a .nav file of the "
                        "same name beside them");
    command->callback([&chosen, recording, navigation] {
        chosen = [recording, navigation] {
            std::vector<std::string> arguments{"--inspect", *recording};
            if (!navigation->empty()) arguments.push_back(*navigation);
            return run_companion("import", arguments);
        };
    });
}

}  // namespace runcert
