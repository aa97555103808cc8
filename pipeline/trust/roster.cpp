#include "trust/roster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <utility>

#include "core/failure.h"
#include "core/figures.h"
#include "core/text.h"
#include "schemas/common/role_signatures.h"
#include "store/atomic_file.h"
#include "store/pattern.h"
#include "trust/signature_text.h"

namespace runcert {
namespace {

constexpr std::string_view blanks = " \t";

[[noreturn]] void refuse_line(
    const std::string& where, const std::string& what,
    const std::string& remedy =
        "Write it as ROLES [OPTIONS] TYPE KEY WHO, e.g. as runcert keygen "
        "prints it") {
    throw Failure(where, what, remedy);
}

void skip_blanks(std::string_view& rest) {
    rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
}

/// The next word, taken off the line; in quotes it may hold blanks.
std::string_view take_word(std::string_view& rest, const std::string& where) {
    skip_blanks(rest);
    std::string_view word;
    if (rest.starts_with('"')) {
        const std::size_t end = rest.find('"', 1);
        if (end == std::string_view::npos) refuse_line(where, "a quotation mark is never closed");
        word = rest.substr(1, end - 1);
        rest.remove_prefix(end + 1);
    } else {
        word = rest.substr(0, rest.find_first_of(blanks));
        rest.remove_prefix(word.size());
    }
    skip_blanks(rest);
    return word;
}

/// The value in quotes that an option begins with, taken off; \" stands for a quotation mark.
std::string take_quoted(std::string_view& rest, const std::string& name, const std::string& where) {
    if (!rest.starts_with('"'))
        refuse_line(where, fmt::format("the value of {} does not stand in quotation marks", name));
    std::string value;
    for (std::size_t i = 1; i < rest.size(); ++i) {
        if (rest[i] == '"') {
            rest.remove_prefix(i + 1);
            return value;
        }
        if (rest.substr(i, 2) == "\\\"") ++i;
        value += rest[i];
    }
    refuse_line(where, fmt::format("the quotation mark of {} is never closed", name));
}

UtcSecond read_time(const std::string& text, const std::string& name, const std::string& where) {
    const auto time = parse_ssh_time(text);
    if (!time)
        refuse_line(where, fmt::format("\"{}\" is no time for {}", escape_for_message(text), name),
                    "Write YYYYMMDDZ, YYYYMMDDHHMMZ or YYYYMMDDHHMMSSZ; Z is for UTC");
    return *time;
}

template <class T>
void set_once(std::optional<T>& option, T value, const std::string& name,
              const std::string& where) {
    if (option) refuse_line(where, fmt::format("{} is given twice", name), "Give it once");
    option = std::move(value);
}

/// One option, with its value in `rest` behind the equals sign.
void read_option(RosterEntry& entry, const std::string& name, std::string_view& rest,
                 const std::string& where) {
    if (name == "cert-authority")
        refuse_line(where, "certificate authorities are not read here: cert-authority",
                    "Give each signer's own key a line");
    if (name != "namespaces" && name != "valid-after" && name != "valid-before")
        refuse_line(
            where,
            fmt::format("\"{}\" is neither an option nor a type of key", escape_for_message(name)),
            "Options are namespaces, valid-after and valid-before; types of key " +
                ssh_key_types());
    if (!rest.starts_with('=')) refuse_line(where, fmt::format("{} has no value", name));
    rest.remove_prefix(1);
    std::string value = take_quoted(rest, name, where);
    if (name == "namespaces")
        set_once(entry.namespaces, std::move(value), name, where);
    else if (name == "valid-after")
        set_once(entry.valid_after, read_time(value, name, where), name, where);
    else
        set_once(entry.valid_before, read_time(value, name, where), name, where);
}

void read_options(RosterEntry& entry, std::string_view& rest, const std::string& where) {
    while (true) {
        const std::string name = lower_case(rest.substr(0, rest.find_first_of("=, \t")));
        rest.remove_prefix(name.size());
        read_option(entry, name, rest, where);
        if (!rest.starts_with(',')) break;
        rest.remove_prefix(1);
    }
    if (!rest.empty() && blanks.find(rest.front()) == std::string_view::npos)
        refuse_line(where, "something follows an option without a comma");
    skip_blanks(rest);
    if (entry.valid_after && entry.valid_before && *entry.valid_before <= *entry.valid_after)
        refuse_line(where, "valid-before is not after valid-after", "Give times in that order");
}

RosterEntry read_line(std::string_view rest, std::size_t number, const std::string& where) {
    RosterEntry entry;
    entry.line = number;
    entry.roles = take_word(rest, where);
    const auto type_ahead = [&rest] { return rest.substr(0, rest.find_first_of(blanks)); };
    if (entry.roles.empty() || rest.empty()) refuse_line(where, "the line ends before its key");
    if (!is_ssh_key_type(type_ahead())) read_options(entry, rest, where);
    const std::string_view type = take_word(rest, where);
    if (!is_ssh_key_type(type))
        refuse_line(
            where,
            fmt::format("\"{}\" is not a type of key that is read here", escape_for_message(type)),
            "Use one of " + ssh_key_types());
    entry.key = parse_ssh_public_key(type, take_word(rest, where), where);
    entry.who = trim(rest);
    return entry;
}

constexpr std::string_view own_comment = "#runcert";

/// "judge=2,measurer".
std::vector<RoleSignatures> read_counts(std::string_view list, const std::string& where,
                                        const std::string& remedy) {
    constexpr std::int64_t most = 99;
    std::vector<RoleSignatures> required;
    for (std::size_t at = 0; at <= list.size();) {
        const std::string_view entry = list.substr(at, list.find(',', at) - at);
        at += entry.size() + 1;
        const std::string role(entry.substr(0, entry.find('=')));
        const auto count = role.size() == entry.size()
                               ? std::optional<std::int64_t>(1)
                               : parse_integer(entry.substr(role.size() + 1));
        const bool known =
            std::ranges::find(required, role, &RoleSignatures::role) != required.end();
        if (!is_role(role) || !count || *count < 1 || *count > most || known)
            refuse_line(where,
                        fmt::format("\"{}\" is no role with a count of signatures from 1 to {}, "
                                    "named once",
                                    escape_for_message(entry), most),
                        remedy);
        required.push_back({.role = role, .count = *count});
    }
    return required;
}

/// Revocations as they are read: of keys whose lines may come later.
using Revocations = std::vector<std::pair<SshPublicKey, Revocation>>;

/// A line for runcert: comments to ssh-keygen. One that is not understood is refused: who wrote it
/// relies on it.
void read_policy(Roster& roster, Revocations& revoked, std::string_view line,
                 const std::string& where) {
    const char* const remedy =
        "Write #runcert signatures ROLE=COUNT,..., close ROLE, valid-until TIME, successor "
        "ROLE=COUNT,..., follows SHA256, revoked TIME \"REASON\" TYPE KEY, or record RULE CLASS "
        "FIGURE UNIT \"SOURCE\"";
    line.remove_prefix(own_comment.size());
    const std::string_view policy = line.find_first_of(blanks) == 0 ? take_word(line, where) : "";
    const std::string first(take_word(line, where));
    const auto next = [&] { return std::string(take_word(line, where)); };
    bool understood = !first.empty();
    if (policy == "close" && is_role(first) && !roster.closed_by) {
        roster.closed_by = first;
    } else if (policy == "signatures" && understood) {
        for (RoleSignatures& one : read_counts(first, where, remedy)) {
            understood &= std::ranges::find(roster.required, one.role, &RoleSignatures::role) ==
                          roster.required.end();
            roster.required.push_back(std::move(one));
        }
    } else if (policy == "successor" && understood && roster.successor.empty()) {
        roster.successor = read_counts(first, where, remedy);
    } else if (policy == "valid-until" && !roster.valid_until) {
        roster.valid_until = read_time(first, "valid-until", where);
    } else if (policy == "follows" && first.size() == 64 && roster.follows.empty()) {
        roster.follows = first;
    } else if (policy == "revoked") {
        Revocation revocation{.at = read_time(first, "revoked", where), .reason = next()};
        const std::string type = next();
        understood = !revocation.reason.empty() && is_ssh_key_type(type);
        if (understood)
            revoked.emplace_back(parse_ssh_public_key(type, next(), where), std::move(revocation));
    } else if (policy == "record" && has_only(first, "-_.")) {
        StandingRecord record{.profile = first, .craft_class = next()};
        const std::string figure = next(), unit = next();
        const auto value = parse_double(figure);
        const auto known = std::ranges::find(speed_units(), unit, &SpeedUnit::name);
        understood = value && *value > 0.0 && known != speed_units().end();
        record.source = next();
        understood &= !record.source.empty();
        if (understood) {
            record.shown = figure + " " + unit;
            record.speed_m_s = *value / known->per_m_s;
            roster.records.push_back(std::move(record));
        }
    } else {
        understood = false;
    }
    if (!understood || !line.empty())
        refuse_line(where, "this line for runcert is not understood", remedy);
}

/// Failure where a comment begins with this program's name, but not as its own lines do: whoever
/// reads it would rely on it, and nothing would follow from it.
void require_no_likeness(std::string_view line, const std::string& where) {
    if (!line.starts_with('#') || line.starts_with(own_comment)) return;
    const auto letter = std::ranges::find_if(line, [](unsigned char c) { return std::isalpha(c); });
    const std::string words = lower_case({letter, line.end()});
    if (words.starts_with(own_comment.substr(1)))
        refuse_line(where, "this comment looks like a line for runcert, and is none",
                    "Write #runcert in small letters and without a blank, or begin the comment "
                    "with another word");
}

}  // namespace

std::string signature_namespace(std::string_view role) {
    return std::string(role) + "@runcert";
}

void require_role(const std::string& role, const std::string& where) {
    if (!is_role(role))
        refuse_line(where,
                    fmt::format("\"{}\" cannot be a role to sign in", escape_for_message(role)),
                    "Use 1 to 64 letters, digits, - and _, such as measurer or chief-judge");
}

bool RosterEntry::allows(std::string_view role) const {
    return matches_pattern_list(role, roles) &&
           (!namespaces || matches_pattern_list(signature_namespace(role), *namespaces));
}

bool RosterEntry::is_valid_at(UtcSecond time) const {
    return (!revoked || time < revoked->at) && (!valid_after || time >= *valid_after) &&
           (!valid_before || time <= *valid_before);
}

Roster parse_roster(std::string_view text, const std::string& where) {
    signature_text::start_libsodium();
    Roster roster{.text = std::string(text)};
    Revocations revoked;
    const auto lines = signature_text::lines_of(text);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        std::string_view line = lines[i];
        skip_blanks(line);
        const std::string place = fmt::format("{}, line {}", where, i + 1);
        if (!is_printable_line(line))
            refuse_line(place, "the line holds characters that do not print");
        require_no_likeness(line, place);
        if (line.starts_with(own_comment)) read_policy(roster, revoked, line, place);
        if (line.empty() || line.starts_with('#')) continue;
        roster.entries.push_back(read_line(line, i + 1, place));
    }
    for (const auto& [key, revocation] : revoked) {
        bool named = false;
        for (RosterEntry& entry : roster.entries)
            if (entry.key == key) {
                named = true;
                entry.revoked = revocation;
            }
        if (!named)
            refuse_line(where, "it revokes a key that has no line: " + ssh_fingerprint(key),
                        "Keep the key's line: what was time-stamped before it was revoked counts");
    }
    if (roster.entries.empty())
        refuse_line(where, "the roster names no key",
                    "Write a line for each key whose signature counts");
    return roster;
}

const StandingRecord* Roster::record_of(std::string_view profile,
                                        std::string_view craft_class) const {
    for (const StandingRecord& record : records)
        if (record.profile == profile && matches_pattern_list(craft_class, record.craft_class))
            return &record;
    return nullptr;
}

void require_in_force(const Roster& roster, UtcSecond at, const std::string& where) {
    if (roster.valid_until && at > *roster.valid_until)
        throw Failure(where,
                      fmt::format("the roster was in force until {}, and it is {}",
                                  iso_text(*roster.valid_until), iso_text(at)),
                      "Ask the body for its present roster");
}

void require_in_force(const std::string& file) {
    if (const auto roster = read_roster(file))
        require_in_force(
            *roster, std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()),
            file);
}

std::optional<Roster> read_roster(const std::string& file) {
    if (file.empty()) return std::nullopt;
    return parse_roster(read_handwritten(file), file);
}

Roster roster_of_public_key(std::string_view text, const std::string& who, const std::string& where,
                            const std::string& roles) {
    signature_text::start_libsodium();
    const std::string_view line = trim(text);
    if (is_ssh_key_type(line.substr(0, line.find(' '))) &&
        line.find('\n') != std::string_view::npos)
        refuse_line(where, "a public key is one line; what else stands there would count as well",
                    "Give each key a file of its own, or give them as a roster");
    if (is_ssh_key_type(line.substr(0, line.find(' '))))
        return parse_roster(roles + " " + std::string(line) + "\n", where);
    const PublicKey key = parse_public_key(text, where);
    Roster roster = parse_roster(roles + " " + ssh_key_text(ssh_key_of(key.key)) + "\n", where);
    roster.entries.front().key_id = key.key_id;
    roster.entries.front().who = who;
    return roster;
}

void append(Roster& roster, const Roster& more) {
    if (!roster.text.empty() && !roster.text.ends_with('\n')) roster.text += '\n';
    roster.text += more.text;
    roster.entries.insert(roster.entries.end(), more.entries.begin(), more.entries.end());
}

std::string roster_line(const PublicKey& key, const std::string& role, std::string_view who) {
    return fmt::format("{} namespaces=\"{}\" {} {}", role, signature_namespace(role),
                       ssh_key_text(ssh_key_of(key.key)), who);
}

}  // namespace runcert
