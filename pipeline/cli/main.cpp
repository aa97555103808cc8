#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "core/text.h"
#include "run/stage_main.h"
#include "store/external_program.h"
#include "store/program.h"

using namespace runcert;

int main(int argc, char** argv) {
    return guarded_main([&]() -> int {
        CLI::App app("Certifies speed-record attempts from recorded satellite positions",
                     "runcert");
        app.require_subcommand(1);
        app.set_version_flag(
            "--version",
            [] {
                return fmt::format("runcert {} {}\n{}", program_version(), source_revision(),
                                   trim(external_programs_text()));
            },
            "Print the version, and which external programs there are");
        app.footer("Exit status: 0 success or yes, 1 no, 2 error.");
        Command chosen;
        add_certify(app, chosen);
        add_batch(app, chosen);
        add_verify(app, chosen);
        add_sign(app, chosen);
        add_attest(app, chosen);
        add_timestamp(app, chosen);
        add_inspect(app, chosen);
        add_audit(app, chosen);
        add_diff(app, chosen);
        add_explain(app, chosen);
        add_compare(app, chosen);
        add_simulate(app, chosen);
        add_keygen(app, chosen);
        add_seal(app, chosen);
        add_bundle(app, chosen);
        add_export(app, chosen);
        try {
            app.parse(argc, argv);
        } catch (const CLI::Success& help) {
            return app.exit(help);
        }
        return chosen();
    });
}
