#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "files/process.h"

namespace runcert {

void add_inspect(CLI::App& app, Command& chosen) {
    auto recording = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand("inspect", "Say what a recording is, in a few lines");
    command->add_option("RECORDING", *recording, "the recording's file")->required();
    command->callback([&chosen, recording] {
        chosen = [recording] {
            const ProcessResult result = run_process(
                {(program_folder() / "runcert-import").string(), "--inspect", *recording});
            fmt::print("{}", result.output);
            fmt::print(stderr, "{}", result.errors);
            return result.exit_status;
        };
    });
}

}  // namespace runcert
