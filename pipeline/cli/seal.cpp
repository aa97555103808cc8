#include "trust/seal.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "run/run_lock.h"

namespace runcert {
namespace {

struct SealOptions {
    std::string run_dir;
    std::string key;
    std::string certificate;
    std::string reason = "Measurement report as computed from the attached report.json";
};

int seal(const SealOptions& options) {
    const RunLock lock(options.run_dir);
    const SealCheck check =
        seal_report(options.run_dir, options.key, options.certificate, options.reason);
    fmt::print("seal      {}/report.pdf: {}\ntype      {}\n", options.run_dir, check.words,
               check.type);
    return 0;
}

}  // namespace

void add_seal(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<SealOptions>();
    CLI::App* command = app.add_subcommand("seal", "Seal report.pdf with an X.509 key");
    command->add_option("RUN_DIR", options->run_dir, "the folder of a certified run")->required();
    command
        ->add_option("--key", options->key,
                     "private key, PEM, RSA (3072 bits or more) or ECDSA (P-256 or more), mode 600")
        ->required();
    command->add_option("--certificate", options->certificate, "its certificate, PEM")->required();
    command->add_option("--reason", options->reason, "why it is sealed, shown by PDF readers")
        ->capture_default_str();
    command->footer(
        "The seal comes last: signing report.json and rendering write a new PDF, without it. It "
        "is\n"
        "one invisible signature, made by PoDoFo and checked by poppler's pdfsig before it "
        "replaces\n"
        "the PDF: CMS, SubFilter adbe.pkcs7.detached of ISO 32000-1, with the certificate in it: "
        "the\n"
        "form that ETSI TS 102 778-2 calls PAdES Basic.\n"
        "It is not a PAdES baseline signature (EN 319 142-1): it binds the certificate by no "
        "signed\n"
        "attribute, and holds no time stamp and no revocation data. Its time is the computer's\n"
        "clock. It says that the file "
        "is as the key's owner left it; what is signed by the officials is report.json.");
    command->callback([&chosen, options] { chosen = [options] { return seal(*options); }; });
}

}  // namespace runcert
