#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstring>

#include "cli/commands.h"
#include "core/failure.h"
#include "core/text.h"
#include "outer_commands.h"
#include "run/stage_main.h"
#include "sbom.h"
#include "store/external_program.h"
#include "store/process.h"
#include "store/program.h"

using namespace runcert;

namespace {

/// Failure if the first word is missing or no command.
void require_command(const CLI::App& app, const std::vector<std::string>& words) {
    if (words.empty()) {
        fmt::print("{}", app.help());
        throw Failure("the command line", "it names no command", "Give one of those above");
    }
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands(nullptr))
        names.push_back(command->get_name());
    const std::string& word = words[0];
    if (word.starts_with('-') || std::ranges::find(names, word) != names.end()) return;
    const std::vector<std::string_view> known(names.begin(), names.end());
    throw Failure("the command line", fmt::format("\"{}\" is no command", escape_for_message(word)),
                  fmt::format("Did you mean {}? Commands are {}", nearest(word, known),
                              fmt::join(names, ", ")));
}

/// "help", "help certify" and "version" as options say them.
std::vector<std::string> as_options(std::vector<std::string> words) {
    if (words.empty()) return words;
    if (words[0] == "version") words[0] = "--version";
    if (words[0] == "help" || words[0] == "--help" || words[0] == "-h") {
        words.erase(words.begin());
        words.emplace_back("--help");
    }
    return words;
}

/// Becomes the program `runcert-NAME` where a companion's NAME is the first word: it knows its
/// options and its help.
void become_companion(std::vector<std::string> words) {
    if (std::ranges::find(companions, words[0], &Companion::name) == companions.end()) return;
    const std::string program = program_folder() / ("runcert-" + words[0]);
    words[0] = "runcert " + words[0];  // as its help calls it
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(program.c_str(), arguments.data());
    throw Failure(program,
                  fmt::format("the program could not be started: {}", std::strerror(errno)),
                  "Install it (see packages.txt), or build the program again");
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main([&]() -> int {
        CLI::App app("Certifies speed-record attempts from recorded satellite positions",
                     "runcert");
        app.require_subcommand(1);
        bool sbom = false;
        auto* const listed = app.add_flag(
            "--sbom", sbom, "with --version: programs and libraries with their hashes, as SPDX");
        listed->trigger_on_parse();
        CLI::Option* const version = app.set_version_flag(
            "--version",
            [&sbom] {
                if (sbom) return std::string(trim(sbom_text()));
                return fmt::format("runcert {} {}\n{}", program_version(), source_revision(),
                                   trim(external_programs_text()));
            },
            "Print the version, and which external programs there are");
        listed->needs(version);
        app.footer("Exit status: 0 success or yes, 1 no, 2 error.");
        const auto add_companion = [&app](const Companion& one) {
            app.add_subcommand(std::string(one.name), one.summary);
        };
        Command chosen;
        add_new(app, chosen);
        add_certify(app, chosen);
        add_batch(app, chosen);
        add_verify(app, chosen);
        add_sign(app, chosen);
        add_attest(app, chosen);
        add_timestamp(app, chosen);
        add_receive(app, chosen);
        add_log(app, chosen);
        add_roster(app, chosen);
        add_inspect(app, chosen);
        add_companion(audit_program);
        add_diff(app, chosen);
        add_companion(explain_program);
        add_companion(compare_program);
        add_plan(app, chosen);
        add_simulate(app, chosen);
        add_surface(app, chosen);
        add_keygen(app, chosen);
        add_seal(app, chosen);
        add_bundle(app, chosen);
        add_companion(export_program);
        std::vector<std::string> words = as_options({argv + 1, argv + argc});
        require_command(app, words);
        become_companion(words);
        std::ranges::reverse(words);  // as CLI11 takes them
        try {
            app.parse(words);
        } catch (const CLI::Success& help) {
            return app.exit(help);
        }
        return chosen();
    });
}
