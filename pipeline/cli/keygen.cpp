#include <fmt/format.h>

#include <filesystem>

#include "commands.h"
#include "core/failure.h"
#include "trust/roster.h"
#include "trust/signature.h"
#include "trust/signing.h"

namespace runcert {
namespace {

struct KeygenOptions {
    std::string name;
    std::string role = "measurer";
    bool no_password = false;
};

int make_keys(const KeygenOptions& options) {
    const std::string secret = options.name + ".key";
    const std::string open = options.name + ".pub";
    require_role(options.role, "--role");
    for (const std::string& file : {secret, open})
        if (std::filesystem::exists(file))
            throw Failure(file, "the file exists already",
                          "Choose another name: a key that is overwritten is lost");
    std::optional<std::string> password;
    if (!options.no_password) password = ask_new_password();
    const KeyPair pair = generate_key_pair();
    // The secret key first: who has its name has the pair's. Alone it says that it is half a pair,
    // and one of another is never replaced.
    write_new_file(secret, secret_key_file(pair, password), FileAccess::owner_only);
    try {
        write_new_file(open, public_key_file(pair.public_key));
    } catch (const Failure&) {
        std::filesystem::remove(secret);
        throw;
    }
    fmt::print(
        "secret key  {}  (keep it; nobody else may have it)\n"
        "public key  {}  (give it to everybody who is to verify)\n"
        "key id      {}\n"
        "roster      {}\n",
        secret, open, key_id_text(pair.public_key),
        roster_line(pair.public_key, options.role,
                    std::filesystem::path(options.name).filename().string()));
    return 0;
}

}  // namespace

void add_keygen(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<KeygenOptions>(
        app, chosen, "keygen", "Make a key pair for signing reports (minisign's format)",
        make_keys);
    line.text("--out", options.name, "writes NAME.key and NAME.pub", CommandLine::required);
    line.text("--role", options.role,
              "role in the roster line that is printed (default: measurer)");
    line.flag("--no-password", options.no_password, "do not encrypt the secret key");
    line.footer(
        "The roster line goes into the file that `runcert verify --roster` reads; who the key "
        "belongs to\nis the comment at its end, and valid-after=\"20260101Z\", "
        "valid-before=\"20280101Z\" may be put\nbehind the role, separated by commas.");
}

}  // namespace runcert
