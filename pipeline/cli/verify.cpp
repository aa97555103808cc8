#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "commands.h"
#include "core/failure.h"
#include "files/atomic_file.h"
#include "recompute.h"
#include "run/verification.h"

namespace runcert {
namespace {

struct VerifyOptions {
    std::string run_dir;
    std::string public_key;
    bool recompute = false;
};

bool print_step(const VerificationStep& step) {
    fmt::print("{:<4} {:<12} {}\n", step.passed ? "yes" : "NO", step.what, step.finding);
    for (const std::string& detail : step.details)
        fmt::print("     {:<12} {}\n", "", detail);
    return step.passed;
}

int verify(const VerifyOptions& options) {
    const std::filesystem::path run_dir = options.run_dir;
    if (!std::filesystem::is_directory(run_dir))
        throw Failure(run_dir.string(), "this is not a folder",
                      "Give the folder of a certified run");
    std::optional<PublicKey> key;
    if (!options.public_key.empty())
        key = parse_public_key(read_handwritten(options.public_key), options.public_key);
    bool passed = print_step(verify_files(run_dir));
    passed = print_step(verify_chain(run_dir)) && passed;
    passed = print_step(verify_signature(run_dir, key)) && passed;
    if (options.recompute) passed = print_step(verify_recomputation(run_dir)) && passed;
    fmt::print("\n{}\n", passed ? "VERIFIED" : "NOT VERIFIED");
    return passed ? 0 : 1;
}

}  // namespace

void add_verify(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<VerifyOptions>();
    CLI::App* command =
        app.add_subcommand("verify", "Check a run folder: signature, every hash, the whole chain");
    command->add_option("RUN_DIR", options->run_dir, "the folder of a certified run")->required();
    command->add_option("--pubkey", options->public_key, "public key of who signed");
    command->add_flag("--recompute", options->recompute,
                      "run every stage again and compare every file");
    command->footer("Exit status: 0 all of it holds, 1 it does not, 2 it could not be checked.");
    command->callback([&chosen, options] { chosen = [options] { return verify(*options); }; });
}

}  // namespace runcert
