#include "run/signing.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"

namespace runcert {
namespace {

/// Keeps the terminal from showing what is typed, for as long as it lives.
class HiddenInput {
  public:
    HiddenInput() {
        hidden_ = isatty(STDIN_FILENO) != 0 && tcgetattr(STDIN_FILENO, &before_) == 0;
        if (!hidden_) return;
        termios silent = before_;
        silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
        tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
    }
    ~HiddenInput() {
        if (hidden_) tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
    }
    HiddenInput(const HiddenInput&) = delete;
    HiddenInput& operator=(const HiddenInput&) = delete;

  private:
    termios before_{};
    bool hidden_ = false;
};

std::string ask(const std::string& question) {
    fmt::print(stderr, "{}: ", question);
    std::string password;
    bool read = false;
    {
        const HiddenInput hidden;
        read = static_cast<bool>(std::getline(std::cin, password));
    }
    fmt::print(stderr, "\n");
    if (!read)
        throw Failure("password", "there is no password to read",
                      "Run on a terminal, or give the password on standard input");
    return password;
}

}  // namespace

SecretKey load_secret_key(const std::filesystem::path& path) {
    const std::string text = read_handwritten(path);
    if (!secret_key_is_encrypted(text)) return parse_secret_key(text, std::nullopt, path.string());
    return parse_secret_key(text, ask(fmt::format("password of {}", path.string())), path.string());
}

std::string ask_new_password() {
    std::string password = ask("new password");
    if (ask("the same again") != password)
        throw Failure("password", "the two passwords differ", "Try again");
    return password;
}

std::string signing_role(const Attempt& attempt) {
    return attempt.officials.empty() ? "unstated" : attempt.officials.front().role;
}

void sign_report(const std::filesystem::path& run_dir, const SecretKey& key,
                 const std::string& role) {
    const std::string report = read_file(run_dir / "report.json");
    const auto json = nlohmann::json::parse(report);
    const std::string comment =
        fmt::format("runcert report={} attempt={} role={} signed={:%Y-%m-%dT%H:%M:%SZ}",
                    json.at("predicate").at("report_id").get<std::string>(),
                    json.at("predicate").at("attempt").at("id").get<std::string>(), role,
                    fmt::gmtime(std::time(nullptr)));
    write_file_atomically(run_dir / "report.json.minisig", sign(report, key, comment));
}

}  // namespace runcert
