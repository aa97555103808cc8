#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "commands.h"
#include "core/failure.h"
#include "files/atomic_file.h"
#include "files/signature.h"
#include "run/signing.h"

namespace runcert {
namespace {

int make_keys(const std::string& name, bool no_password) {
    const std::string secret = name + ".key";
    const std::string open = name + ".pub";
    for (const std::string& file : {secret, open})
        if (std::filesystem::exists(file))
            throw Failure(file, "the file exists already",
                          "Choose another name: a key that is overwritten is lost");
    std::optional<std::string> password;
    if (!no_password) password = ask_new_password();
    const KeyPair pair = generate_key_pair();
    write_file_atomically(secret, secret_key_file(pair, password), FileAccess::owner_only);
    write_file_atomically(open, public_key_file(pair.public_key));
    fmt::print(
        "secret key  {}  (keep it; nobody else may have it)\n"
        "public key  {}  (give it to everybody who is to verify)\n"
        "key id      {}\n",
        secret, open, key_id_text(pair.public_key));
    return 0;
}

}  // namespace

void add_keygen(CLI::App& app, Command& chosen) {
    auto name = std::make_shared<std::string>();
    auto no_password = std::make_shared<bool>(false);
    CLI::App* command =
        app.add_subcommand("keygen", "Make a key pair for signing reports (minisign's format)");
    command->add_option("--out", *name, "writes NAME.key and NAME.pub")->required();
    command->add_flag("--no-password", *no_password, "do not encrypt the secret key");
    command->callback([&chosen, name, no_password] {
        chosen = [name, no_password] { return make_keys(*name, *no_password); };
    });
}

}  // namespace runcert
