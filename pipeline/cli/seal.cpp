#include "trust/seal.h"

#include <fmt/format.h>

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
    auto [line, options] =
        add_command<SealOptions>(app, chosen, "seal", "Seal report.pdf with an X.509 key", seal);
    line.text("RUN_DIR", options.run_dir, "the folder of a certified run", CommandLine::required);
    line.text("--key", options.key,
              "private key, PEM, RSA (3072 bits or more) or ECDSA (P-256 or more), mode 600",
              CommandLine::required);
    line.text("--certificate", options.certificate, "its certificate, PEM", CommandLine::required);
    line.text("--reason", options.reason, "why it is sealed, shown by PDF readers");
    line.show_default("--reason");
    line.footer(
        "The seal comes last: signing report.json and rendering write a new PDF, without it. It "
        "is\none invisible signature, made by PoDoFo and checked by poppler's pdfsig before it "
        "replaces\nthe PDF: CMS, SubFilter adbe.pkcs7.detached of ISO 32000-1, with the "
        "certificate in it: the\nform that ETSI TS 102 778-2 calls PAdES Basic.\nIt is not a "
        "PAdES baseline signature (EN 319 142-1): it binds the certificate by no "
        "signed\nattribute, and holds no time stamp and no revocation data. Its time is the "
        "computer's\nclock. It says that the file is as the key's owner left it; what is signed "
        "by the officials is report.json.");
}

}  // namespace runcert
