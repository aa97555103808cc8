#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "reports/document/document_text.h"
#include "schemas/document/document.h"
#include "store/process.h"

namespace runcert {
namespace {

struct InspectOptions {
    std::string recording;
    std::string navigation;
    bool json = false;
};

/// The stage reads the recording, and says what it is as a document.
int inspect(const InspectOptions& options) {
    std::vector<std::string> command{(program_folder() / "runcert-import").string(), "--inspect",
                                     options.recording};
    if (!options.navigation.empty()) command.push_back(options.navigation);
    const ProcessResult said = run_process(command);
    if (!said.output.empty() && options.json)
        fmt::print("{}\n", nlohmann::ordered_json::parse(said.output).dump(2, ' ', true));
    else if (!said.output.empty())
        fmt::print("{}",
                   document_text(read_members<Document>(YamlValue(
                                     parse_yaml(said.output, "runcert-import"), "runcert-import")),
                                 terminal_columns()));
    fmt::print(stderr, "{}", said.errors);
    return said.exit_status;
}

}  // namespace

void add_inspect(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<InspectOptions>();
    CLI::App* command = app.add_subcommand("inspect", "Say what a recording is, in a few lines");
    command->add_option("RECORDING", options->recording, "the recording's file")->required();
    command->add_option("--navigation", options->navigation,
                        "broadcast orbits for raw measurements (RINEX); else a .nav file of the "
                        "same name beside them");
    command->add_flag("--json", options->json, "one JSON document instead of text");
    command->callback([&chosen, options] { chosen = [options] { return inspect(*options); }; });
}

}  // namespace runcert
