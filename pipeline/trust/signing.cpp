#include "trust/signing.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <iostream>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/declared.h"
#include "schemas/verdict/figures.h"
#include "schemas/verdict/outcome.h"
#include "store/atomic_file.h"
#include "store/utc_second.h"
#include "trust/roster.h"
#include "trust/signature.h"
#include "trust/signature_files.h"

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

/// Keys that others can read are others' keys too.
void require_private(const std::filesystem::path& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0 || (status.st_mode & (S_IRWXG | S_IRWXO)) == 0) return;
    throw Failure(
        path.string(),
        fmt::format("others than its owner can use this secret key (mode {:04o})",
                    status.st_mode & 07777U),
        fmt::format("Run `chmod 600 {}`; if others had access to this computer, make a new "
                    "key",
                    path.string()));
}

void refuse_other_key(const std::string& text, const std::filesystem::path& path) {
    const OtherKey other = other_key_in(text);
    if (!other.kind.empty())
        throw Failure(path.string(), fmt::format("this is {}, not a secret key", other.kind),
                      other.remedy);
}

/// The place for a signature: its own earlier one, or the first that is free.
std::string place_for(const std::filesystem::path& run_dir, const PublicKey& key,
                      const std::string& role) {
    for (const SignatureFile& file : signature_files(run_dir)) {
        if (file.kind != SignatureKind::minisign) continue;
        try {
            const TrustedComment comment =
                parse_trusted_comment(read_signature_claims(file.text, file.name).trusted_comment);
            if (comment.role == role && comment.key == public_key_line(key)) return file.name;
        } catch (const Failure&) {
            // No signature, whatever it is: it is not this key's.
        }
    }
    const auto is_free = [&run_dir](const std::string& name) {
        return !std::filesystem::exists(std::filesystem::symlink_status(run_dir / name));
    };
    if (is_free("report.json.minisig")) return "report.json.minisig";
    std::string name = fmt::format("report.json.{}.minisig", role);
    for (int number = 2; !is_free(name); ++number)
        name = fmt::format("report.json.{}.{}.minisig", role, number);
    return name;
}

}  // namespace

SecretKey load_secret_key(const std::filesystem::path& path) {
    const std::string text = read_handwritten(path);
    refuse_other_key(text, path);
    if (!secret_key_is_encrypted(text)) {
        SecretKey key = parse_secret_key(text, std::nullopt, path.string());
        require_private(path);
        return key;
    }
    require_private(path);
    return parse_secret_key(text, ask(fmt::format("password of {}", path.string())), path.string());
}

std::string ask_new_password() {
    std::string password = ask("new password");
    if (ask("the same again") != password)
        throw Failure("password", "the two passwords differ", "Try again");
    return password;
}

std::string signing_role(const Attempt& attempt) {
    if (attempt.officials.empty()) return "unstated";
    require_role(attempt.officials.front().role, "the attempt's officials[0].role");
    return attempt.officials.front().role;
}

std::string sign_report(const std::filesystem::path& run_dir, const ReportFacts& report,
                        const SecretKey& key, const std::string& role, bool recomputed) {
    require_role(role, "the role to sign in");
    const PublicKey public_key = public_key_of(key);
    const std::string name = place_for(run_dir, public_key, role);
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    const std::string comment = trusted_comment_text({.report_id = report.report_id,
                                                      .attempt_id = report.attempt_id,
                                                      .role = role,
                                                      .key = public_key_line(public_key),
                                                      .signed_at = iso_text(now),
                                                      .recomputed = recomputed ? "" : "no"});
    // While a password was typed, another report could have been put in this one's place.
    if (read_file(run_dir / "report.json") != report.text)
        throw Failure((run_dir / "report.json").string(),
                      "the report was changed after it was checked; nothing was signed",
                      "Find out who writes into the folder, and sign again");
    // What was stamped is the signature that is replaced: both are kept, and go only when the new
    // one is there.
    const std::vector<std::string> replaced{name, time_stamp_name(name),
                                            time_stamp_query_name(name)};
    for (const std::string& each : replaced)
        keep_superseded(run_dir, each);
    const Folder run(run_dir);
    run.write(name, sign(report.text, key, comment));
    for (std::size_t i = 1; i < replaced.size(); ++i)
        run.remove(replaced[i]);
    return name;
}

void require_passed(const std::filesystem::path& run_dir, const VerificationStep& step,
                    const std::string& remedy) {
    if (step.is(LayerAnswer::verified)) return;
    throw Failure(run_dir.string(),
                  fmt::format("{}{}{}", step.finding, step.details.empty() ? "" : ": ",
                              fmt::join(step.details, "; ")),
                  "Nothing was signed. " +
                      (step.is(LayerAnswer::not_checkable) ? "Install what is missing" : remedy));
}

void require_signable(const std::filesystem::path& run_dir, const ReportFacts& report,
                      const std::string& remedy) {
    require_passed(run_dir, verify_files(run_dir, report), remedy);
    require_passed(run_dir, verify_chain(run_dir, report), remedy);
    require_passed(run_dir, verify_schemas(run_dir, report), remedy);
    require_passed(run_dir, verify_rules(run_dir), remedy);
    require_passed(run_dir, verify_report(run_dir, report), remedy);
}

std::vector<std::string> what_is_signed(const std::filesystem::path& run_dir) {
    const std::filesystem::path file = run_dir / products::verdict_file;
    std::vector<std::string> lines;
    for (const ProfileVerdict& verdict : read_verdict(read_file(file), file.string()).profiles)
        lines.push_back(plain_text(fmt::format(
            "{}: {}{}", rule_identity_text(verdict),
            verdict.shown ? measured_speed_text(*verdict.shown, verdict.coverage_factor) + "; "
                          : std::string(),
            outcome_words(state_of(verdict)).title)));
    return lines;
}

}  // namespace runcert
