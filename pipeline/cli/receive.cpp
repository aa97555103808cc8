#include <fmt/format.h>

#include <filesystem>

#include "commands.h"
#include "core/failure.h"
#include "core/text.h"
#include "store/sha256.h"
#include "trust/receipt.h"
#include "trust/roster.h"
#include "trust/signing.h"

namespace runcert {
namespace {

struct ReceiveOptions {
    std::vector<std::string> files;
    std::string key;
    std::string role = "measurer";
    std::string from;
    std::string out = "receipt.json";
};

int receive(const ReceiveOptions& options) {
    require_role(options.role, "--role");
    if (!is_printable_line(options.from))
        throw Failure("--from", "it holds characters that do not print",
                      "Write a name, on one line");
    Receipt receipt{.from = options.from};
    for (const std::string& file : options.files) {
        const FileDigest digest = digest_file(file);
        if (digest.bytes == 0)
            throw Failure(file, "the file is empty", "Ask for the recording itself");
        receipt.files.push_back({.name = std::filesystem::path(file).filename().string(),
                                 .sha256 = digest.sha256,
                                 .bytes = digest.bytes});
        fmt::print("received  {}  {} bytes  {}\n", digest.sha256, digest.bytes,
                   plain_text(receipt.files.back().name));
    }
    std::fflush(stdout);
    const SecretKey key = load_secret_key(options.key);
    const std::string text = sign_receipt(receipt, options.role, key);
    write_new_file(options.out, text);
    fmt::print(
        "receipt   {0}, by {1} with the key {2}\n"
        "next      runcert timestamp {0}; and in the attempt: receipt: {{file: {3}}}\n",
        options.out, options.role, key_id_text(public_key_of(key)),
        std::filesystem::path(options.out).filename().string());
    return 0;
}

}  // namespace

void add_receive(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<ReceiveOptions>(
        app, chosen, "receive", "Write and sign a receipt for recordings that are handed in",
        receive);
    line.texts("FILE", options.files, "recordings, as they are handed in", CommandLine::required);
    line.text("--key", options.key, "secret key of who receives (runcert keygen)",
              CommandLine::required);
    line.text("--role", options.role, "what whoever receives is (default: measurer)");
    line.text("--from", options.from, "who hands them in");
    line.text("--out", options.out, "file to write (default: receipt.json, here)");
    line.footer(
        "The receipt names each file by its SHA-256, length and name, and the time by this "
        "computer's clock.\nIt shows that a recording was made before. Who trusts neither clock "
        "nor official wants a time stamp\nof it as well. An attempt names it:\n\n  receivers:\n"
        "    - id: primary\n      recording: log.ubx\n      receipt: {file: receipt.json, "
        "time_stamp: receipt.json.tsr}\n\n`certify` refuses a receipt of other files. The report "
        "says what it shows, and nothing else changes.\nExit status: 0 signed, 2 it could not be "
        "done.");
}

}  // namespace runcert
