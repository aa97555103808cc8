#include "trust/roster.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "commands.h"
#include "core/failure.h"
#include "core/text.h"
#include "store/sha256.h"
#include "trust/run_standing.h"
#include "trust/signing.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

struct RosterOptions {
    std::string roster;
    std::string after;
    std::string key;
    std::string role = "board";
};

UtcSecond now() {
    return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
}

/// What a signature of a roster is of: its bytes, named by its hash.
ReportFacts facts_of(const std::string& text) {
    constexpr std::size_t digits = 16;
    return {.text = text, .report_id = sha256_hex(text).substr(0, digits), .attempt_id = "roster"};
}

std::string validity_text(const RosterEntry& entry) {
    std::string text;
    if (entry.valid_after) text += ", from " + iso_text(*entry.valid_after);
    if (entry.valid_before) text += ", until " + iso_text(*entry.valid_before);
    if (entry.revoked)
        text += fmt::format(", REVOKED as of {}: {}", iso_text(entry.revoked->at),
                            entry.revoked->reason);
    return text;
}

void show(const Roster& roster) {
    const std::string sha256 = sha256_hex(roster.text);
    fmt::print("roster   {}  (SHA-256 {})\n", short_fingerprint(sha256), sha256);
    if (roster.valid_until) fmt::print("until    {}\n", iso_text(*roster.valid_until));
    for (const RosterEntry& entry : roster.entries)
        fmt::print("key      {}: {} {}{}\n", plain_text(entry.roles), ssh_fingerprint(entry.key),
                   plain_text(entry.who), plain_text(validity_text(entry)));
    for (const auto& [name, list] :
         {std::pair("asks for", &roster.required), {"followed", &roster.successor}})
        for (const RoleSignatures& one : *list)
            fmt::print("{} {} of {}\n", name, one.count, one.role);
    fmt::print("closes   {}\n", roster.closing_role());
    for (const StandingRecord& record : roster.records)
        fmt::print("record   {}, {}: {} ({})\n", record.profile, plain_text(record.craft_class),
                   record.shown, plain_text(record.source));
}

/// The signatures beside a roster: ROSTER.ROLE.minisig.
std::vector<SignatureFile> signatures_of(const fs::path& roster) {
    std::vector<SignatureFile> files;
    const std::string begin = roster.filename().string() + ".";
    for (const auto& entry : fs::directory_iterator(folder_of(roster)))
        if (const std::string name = entry.path().filename().string();
            name.starts_with(begin) && name.ends_with(".minisig") &&
            fs::is_regular_file(entry.symlink_status()))
            files.push_back({.name = name, .text = read_handwritten(entry.path())});
    std::ranges::sort(files, {}, &SignatureFile::name);
    return files;
}

/// Whether enough keys of the earlier roster signed this one, in the roles that it asks for.
bool follows(const Roster& roster, const RosterOptions& options) {
    const Roster earlier = *read_roster(options.after);
    const SignatureRules rules{.roster = earlier, .present = now(), .at = now()};
    require_in_force(earlier, rules.at, options.after);
    std::vector<Signer> signers;
    for (const SignatureFile& file : signatures_of(options.roster)) {
        signers.push_back(judge_signature({.run_dir = folder_of(options.roster), .file = file},
                                          facts_of(roster.text), rules));
        const Signer& signer = signers.back();
        fmt::print("signed   {}: {}\n", plain_text(file.name),
                   plain_text(signer.valid ? fmt::format("{} ({})", signer.role, signer.who)
                                           : "does not count: " + signer.reason));
    }
    bool enough = roster.follows == sha256_hex(earlier.text) && !earlier.successor.empty();
    if (earlier.successor.empty())
        fmt::print("NO       {} does not say who signs the roster that follows it\n",
                   plain_text(options.after));
    else if (!enough)
        fmt::print("NO       it does not name {} as the one that it follows: #runcert follows {}\n",
                   plain_text(options.after), sha256_hex(earlier.text));
    std::vector<RequiredSignatures> required;
    for (const RoleSignatures& one : earlier.successor)
        required.push_back({.role = one.role, .count = static_cast<std::size_t>(one.count)});
    for (const RoleState& role : fill_roles(required, signers)) {
        fmt::print("{}  {} of {} by {}\n", role.there >= role.needed ? "yes    " : "NO     ",
                   role.there, role.needed, role.role);
        enough &= role.there >= role.needed;
    }
    return enough;
}

void sign_roster(const std::string& text, const RosterOptions& options) {
    require_role(options.role, "--role");
    const SecretKey key = load_secret_key(options.key);
    const ReportFacts facts = facts_of(text);
    const std::string file = fmt::format("{}.{}.{}.minisig", options.roster, options.role,
                                         key_id_text(public_key_of(key)));
    const std::string comment = trusted_comment_text({.report_id = facts.report_id,
                                                      .attempt_id = facts.attempt_id,
                                                      .role = options.role,
                                                      .key = public_key_line(public_key_of(key)),
                                                      .signed_at = iso_text(now())});
    write_new_file(file, sign(text, key, comment));
    fmt::print("signature {}\n", file);
}

int roster(const RosterOptions& options) {
    const Roster roster = *read_roster(options.roster);
    show(roster);
    std::fflush(stdout);
    if (!options.key.empty()) sign_roster(roster.text, options);
    const bool sound = options.after.empty() || follows(roster, options);
    if (!options.after.empty())
        fmt::print("{}\n", sound ? "It follows the earlier roster."
                                 : "It does not follow the earlier roster: do not use it.");
    return sound ? 0 : 1;
}

}  // namespace

void add_roster(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<RosterOptions>(
        app, chosen, "roster", "Show a body's roster, sign it, or check that it follows another",
        roster);
    line.text("ROSTER", options.roster, "the roster", CommandLine::required);
    line.text("--after", options.after,
              "the roster that you have: did enough of its keys sign the new one?");
    line.text("--key", options.key, "secret key to sign the roster with");
    line.text("--role", options.role, "what the signer is (default: board)");
    line.footer(
        "Beside keys, a roster has lines of the body's policy:\n"
        "  #runcert valid-until 20280101Z             after that it vouches for nobody\n"
        "  #runcert revoked 20260301Z \"lost\" TYPE KEY only what was time-stamped before counts\n"
        "  #runcert successor board=2                 who signs the roster that follows it\n"
        "  #runcert follows SHA256                    of the one that it follows\n"
        "  #runcert record nalsa land-yacht 202.9 km/h \"WHERE\"  the record that stands\n"
        "  #runcert signatures judge=2, #runcert close judge    see runcert verify --help\n"
        "A roster is followed while it is in force. Signatures lie beside the new one, as "
        "ROSTER.ROLE.KEY.minisig.\nExit status: 0 shown, signed or follows; 1 does not follow; 2 "
        "it cannot be read.");
}

}  // namespace runcert
