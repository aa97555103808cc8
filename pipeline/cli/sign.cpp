#include <fmt/format.h>

#include <filesystem>

#include "commands.h"
#include "recompute.h"
#include "run/run_lock.h"
#include "trust/bundle.h"
#include "trust/roster.h"
#include "trust/signature.h"
#include "trust/signed_log.h"
#include "trust/signing.h"

namespace runcert {
namespace {

struct SignOptions {
    std::string run_dir;
    std::string key;
    std::string role;
    std::string roster;
    std::string log;
    bool no_render = false;
    bool no_recompute = false;
};

constexpr const char* bring_back =
    "Bring back the original files and move others away, or certify again";

int sign_run(const SignOptions& options) {
    GivenRun given(options.run_dir);
    const std::filesystem::path run_dir = given.run_folder_to_write();
    {
        const RunLock clears(run_dir);  // what a killed call of this user's left half written
    }
    const ReportFacts report = read_report_facts(run_dir);
    require_role(options.role, "--role");
    require_own_roster(options.roster, run_dir, !options.no_render);
    require_in_force(options.roster);
    require_signable(run_dir, report, bring_back);
    require_passed(run_dir, verify_report_text(run_dir, report), bring_back);
    if (!options.no_recompute)
        require_passed(run_dir, verify_recomputation(run_dir, report), bring_back);
    for (const std::string& line : what_is_signed(run_dir))
        fmt::print("signing {}\n", line);
    std::fflush(stdout);
    const SecretKey key = load_secret_key(options.key);
    std::string file;
    {
        const RunLock lock(run_dir);
        // Before the signature: there is none that the log lacks.
        if (!options.log.empty()) append_to_log(options.log, entry_of(report, options.role, key));
        file = sign_report(run_dir, report, key, options.role, !options.no_recompute);
    }
    fmt::print("signed  report {} of {}, as {}, by the key {}\nfile    {}\n", report.report_id,
               report.attempt_id, options.role, key_id_text(public_key_of(key)),
               (run_dir / file).string());
    return options.no_render ? 0 : render_pages(run_dir, options.roster, "the report is signed");
}

}  // namespace

void add_sign(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<SignOptions>(
        app, chosen, "sign", "Sign the report of a run folder, in addition to existing signatures",
        sign_run);
    line.text("RUN_DIR", options.run_dir,
              "the folder of a certified run, or a bundle, which is unpacked here",
              CommandLine::required);
    line.text("--key", options.key,
              "secret key (runcert keygen, minisign -G); its password is asked for, or read from "
              "standard input",
              CommandLine::required);
    line.text("--role", options.role,
              "what the signer answers as: measurer, judge, ... (letters, digits, - and _)",
              CommandLine::required);
    line.flag("--no-recompute", options.no_recompute,
              "sign without computing every file again; the signature then says so");
    line.text("--roster", options.roster,
              "whose signatures and answers the pages count; verify them with it too");
    line.text("--log", options.log, "the body's log of what is signed, to which this is added");
    line.flag("--no-render", options.no_render, "leave the pages as they are");
    line.footer(
        "Writes report.json.minisig, or report.json.ROLE.minisig where another signer has that; "
        "the same key\nin the same role replaces its own. Refused where a file of the folder is "
        "missing, changed or not\npart of the report, and where the figures do not follow from "
        "the recordings. With an ssh key: in the folder, `ssh-keygen -Y sign -n ROLE@runcert -f "
        "KEY\nreport.json`, and with several signers rename report.json.sig to "
        "report.json.ROLE.sig.\nExit status: 0 signed, 2 it could not be done.");
}

}  // namespace runcert
