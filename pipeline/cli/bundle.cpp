#include "trust/bundle.h"

#include <fmt/format.h>

#include <filesystem>

#include "commands.h"
#include "core/failure.h"
#include "core/text.h"
#include "run/run_lock.h"
#include "store/atomic_file.h"
#include "trust/verification.h"

namespace runcert {
namespace {

struct BundleOptions {
    std::string run_dir;
    std::string out;
    std::vector<std::string> public_keys;
    std::string roster;
    std::string tsa_ca;
    bool force = false;
    bool zip = false;
};

int bundle(const BundleOptions& options) {
    require_known_versions(options.run_dir);
    require_own_roster(options.roster, options.run_dir, true);
    BundleInput input{.run_dir = options.run_dir};
    input.public_keys.assign(options.public_keys.begin(), options.public_keys.end());
    if (!options.roster.empty()) input.roster = options.roster;
    if (!options.tsa_ca.empty()) input.tsa_ca = options.tsa_ca;
    if (options.zip) input.form = ArchiveForm::zip;
    const Bundle made = [&input] {
        const RunLock lock(input.run_dir,
                           RunUse::reads);  // else its files could be those of two runs
        return make_bundle(input);
    }();
    const std::filesystem::path out =
        options.out.empty() ? made.attempt + std::string(ending_of(input.form)) : options.out;
    if (std::filesystem::exists(std::filesystem::symlink_status(out)) && !options.force)
        throw Failure(out.string(), "the file exists already",
                      "Choose another name with --out, or replace it with --force");
    write_file_atomically(out, made.bytes);
    fmt::print("bundle    {}\nfiles     {}, {} bytes packed\n", out.string(), made.files,
               made.bytes.size());
    for (const std::string& name : made.left_out)
        fmt::print("left out  {}\n", plain_text(name));
    return 0;
}

}  // namespace

void add_bundle(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<BundleOptions>(
        app, chosen, "bundle",
        "Pack a run folder, keys and how to verify it into one .tar.zst, or a ZIP", bundle);
    line.text("RUN_DIR", options.run_dir, "the folder of a certified run", CommandLine::required);
    line.text("--out", options.out,
              "file to write (default: the attempt's id with .tar.zst or .zip, here)");
    line.texts("--pubkey", options.public_keys,
               "public key of a signer, to go along (several: repeat it)");
    line.text(
        "--roster", options.roster,
        "roster of the signers' keys, OpenSSH's allowed-signers form; each key in it goes along "
        "as a file too");
    line.text("--tsa-ca", options.tsa_ca, "root certificate of the time stamps' authority, PEM");
    line.flag(
        "--zip", options.zip,
        "a ZIP, which every system opens; its files are not compressed, so that the same files "
        "give the same bytes everywhere");
    line.flag("--force", options.force, "replace the file if it exists");
    line.footer(
        std::string() +
        "In it: one folder, named as the attempt, with the run's files, keys/, VERIFY.txt (how "
        "a\nstranger checks it) and SHA256SUMS. The same folder and keys give the same bytes. "
        "run.yaml\n(clock and durations of the computation, on which nothing depends) stays out. "
        "A folder\nthat is not whole, or holds unknown files, is refused.\n" +
        bundle_limits_words());
}

}  // namespace runcert
