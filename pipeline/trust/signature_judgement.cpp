#include <fmt/format.h>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/role_signatures.h"
#include "store/sha256.h"
#include "trust/signature.h"
#include "trust/ssh_signature.h"
#include "trust/verification.h"

namespace runcert {
namespace {

Signer broken(Signer signer, std::string reason) {
    signer.broken = true;
    signer.reason = std::move(reason);
    return signer;
}

Signer not_counted(Signer signer, std::string reason) {
    signer.reason = std::move(reason);
    return signer;
}

std::vector<const RosterEntry*> entries_of(const SshPublicKey& key, const SignatureRules& rules) {
    std::vector<const RosterEntry*> entries;
    if (!rules.roster) return entries;
    for (const RosterEntry& entry : rules.roster->entries)
        if (entry.key == key) entries.push_back(&entry);
    return entries;
}

/// Why the key's entry does not cover that time, in words; `what` says whose time it is.
std::string out_of_validity(const RosterEntry& entry, UtcSecond time, const std::string& role,
                            const std::string& what) {
    if (entry.revoked && time >= entry.revoked->at)
        return fmt::format("the key of {} was revoked as of {}: {}; {} is {}", role,
                           iso_text(entry.revoked->at), entry.revoked->reason, what,
                           iso_text(time));
    if (entry.valid_before && time > *entry.valid_before)
        return fmt::format("the key of {} was valid until {}, {} is {}", role,
                           iso_text(*entry.valid_before), what, iso_text(time));
    return fmt::format("the key of {} is valid from {} only, {} is {}", role,
                       iso_text(*entry.valid_after), what, iso_text(time));
}

/// Why one of the roster's entries does not let the signature count; empty where it does.
std::string objection_of(const RosterEntry& entry, const Signer& signer, const SignatureCase& one,
                         const SignatureRules& rules) {
    const UtcSecond time = one.stamped.value_or(rules.at);
    if (!entry.is_valid_at(time)) {
        const std::string what =
            one.stamped ? "the time of its time stamp" : "the time that counts";
        const bool expired = (entry.valid_before && time > *entry.valid_before) ||
                             (entry.revoked && time >= entry.revoked->at);
        return out_of_validity(entry, time, signer.role, what) +
               (expired && !one.stamped ? "; only a time stamp from before its end could show that "
                                          "the signature is older"
                                        : "");
    }
    if (signer.stated_time.empty()) return {};
    const auto stated = parse_iso_utc(signer.stated_time);
    if (!stated) return "the time that its signer states cannot be read";
    if (*stated > rules.present + clock_tolerance)
        return fmt::format("its signer states {}, which is yet to come", iso_text(*stated));
    if (!entry.is_valid_at(*stated))
        return out_of_validity(entry, *stated, signer.role, "the time that its signer states");
    if (one.stamped && *stated > *one.stamped + clock_tolerance)
        return fmt::format("its signer states {}, which is after its time stamp, {}",
                           iso_text(*stated), iso_text(*one.stamped));
    return {};
}

/// Notes times of a valid signature before the end of the recording: nobody signs what is not
/// measured yet.
void note_times(Signer& signer, const SignatureCase& one, const ReportFacts& report) {
    if (!report.recorded_until) return;
    const auto stated = parse_iso_utc(signer.stated_time);
    for (const auto& [time, whose] : {std::pair(stated, "the time that its signer states"),
                                      {one.stamped, "the time of its time stamp"}})
        if (time && *time + clock_tolerance < *report.recorded_until)
            signer.notes.push_back(fmt::format(
                "{}, {}, is BEFORE THE END OF THE RECORDING, {}: one of these clocks is "
                "wrong, or the recording is not what was measured",
                whose, iso_text(*time), iso_text(*report.recorded_until)));
}

/// Whether a signature that holds counts: by the roster, and by the time.
Signer apply_roster(Signer signer, const SshPublicKey& key, const SignatureCase& one,
                    const SignatureRules& rules) {
    const auto entries = entries_of(key, rules);
    signer.known = !rules.roster || !entries.empty();
    if (!rules.roster) return not_counted(std::move(signer), "no key was given to compare with");
    if (entries.empty())
        return not_counted(std::move(signer), rules.by_public_keys
                                                  ? "it was made with a key that was not given"
                                                  : "its key is not on the roster");
    signer.who = entries.front()->who;
    if (signer.role.empty() && !rules.by_public_keys)
        return not_counted(std::move(signer), "it states no role to sign in");
    std::string objection =
        rules.by_public_keys
            ? fmt::format("this key was given for the role {} alone", entries.front()->roles)
            : fmt::format("the roster does not let this key sign as {}", signer.role);
    for (const RosterEntry* entry : entries) {
        if (!entry->allows(signer.role)) continue;
        objection = objection_of(*entry, signer, one, rules);
        if (!objection.empty()) continue;
        signer.who = entry->who;
        signer.valid = true;
        return signer;
    }
    return not_counted(std::move(signer), objection);
}

/// A key that a minisign signature may have been made with, and the result of checking with it.
struct TriedKey {
    PublicKey key{};
    SignatureCheck check{};
};

/// The key that vouches for the trusted comment; the last tried where none does, nothing where
/// there is none to try. Keys of the roster first, then the one that the comment itself names.
std::optional<TriedKey> find_signing_key(const SignatureFile& file, const SignatureClaims& claims,
                                         const ReportFacts& report, const SignatureRules& rules) {
    std::vector<PublicKey> keys;
    if (rules.roster)
        for (const RosterEntry& entry : rules.roster->entries)
            if (const auto key = ed25519_of(entry.key))
                // In OpenSSH's form a key has no id: only that of the signature can be compared.
                if (!entry.key_id || *entry.key_id == claims.key_id)
                    keys.push_back({claims.key_id, *key});
    const std::string named = parse_trusted_comment(claims.trusted_comment).key;
    const bool known_by_id = !keys.empty();
    if (!named.empty()) {
        try {
            keys.push_back(parse_public_key(named, file.name));
        } catch (const Failure&) {
            // Whatever stands there, it is not a key that could vouch for anything.
        }
    }
    std::optional<TriedKey> last;
    for (const PublicKey& key : keys) {
        TriedKey tried{key, check_signature(report.text, file.text, key, file.name)};
        if (tried.check.valid || !tried.check.vouched_comment.empty()) return tried;
        // That a roster's other keys do not fit says nothing; that the named one does not says
        // much.
        const bool has_a_say = !named.empty() || (known_by_id && rules.by_public_keys);
        if (has_a_say) last = std::move(tried);
    }
    return last;
}

/// How a comment that its key vouches for contradicts the report beside it; empty if it does not.
std::string contradiction(const TrustedComment& comment, const PublicKey& key,
                          const ReportFacts& report) {
    if (!comment.repeated.empty())
        return fmt::format("its trusted comment states \"{}=\" twice", comment.repeated);
    if ((!comment.report_id.empty() && comment.report_id != report.report_id) ||
        (!comment.attempt_id.empty() && comment.attempt_id != report.attempt_id))
        return fmt::format("it was made for another report ({}, attempt {}), and is replayed here",
                           escape_for_message(comment.report_id),
                           escape_for_message(comment.attempt_id));
    if (!comment.key.empty() && comment.key != public_key_line(key))
        return "its trusted comment names another key than the one that made it";
    return {};
}

Signer judge_minisign(const SignatureCase& one, const ReportFacts& report,
                      const SignatureRules& rules, Signer signer) {
    const SignatureClaims claims = read_signature_claims(one.file.text, one.file.name);
    const auto tried = find_signing_key(one.file, claims, report, rules);
    if (!tried)
        return not_counted(
            std::move(signer),
            fmt::format("it was made with the key {}, which {}",
                        key_id_text({.key_id = claims.key_id, .key = {}}),
                        rules.roster ? "is none of those known" : "was not given to compare with"));
    signer.key = public_key_line(tried->key);
    if (tried->check.vouched_comment.empty()) return broken(std::move(signer), tried->check.reason);
    const TrustedComment comment = parse_trusted_comment(tried->check.vouched_comment);
    if (const std::string fault = contradiction(comment, tried->key, report); !fault.empty())
        return broken(std::move(signer), fault);
    if (!tried->check.valid) return broken(std::move(signer), tried->check.reason);
    signer.stated_time = comment.signed_at;
    signer.not_recomputed = comment.recomputed == "no";
    note_times(signer, one, report);
    if (is_role(comment.role)) signer.role = comment.role;
    return apply_roster(std::move(signer), ssh_key_of(tried->key.key), one, rules);
}

/// By ssh-keygen, which reads report.json itself.
Signer judge_ssh(const SignatureCase& one, const ReportFacts& report, const SignatureRules& rules,
                 Signer signer) {
    const SshSignature signature = parse_ssh_signature(one.file.text, one.file.name);
    signer.key = ssh_key_text(signature.key);
    const std::string& name_space = signature.name_space;
    const std::string role = name_space.substr(0, name_space.find('@'));
    const UtcSecond time = one.stamped.value_or(rules.at);
    if (rules.roster && entries_of(signature.key, rules).empty())  // of these there may be many
        return apply_roster(std::move(signer), signature.key, one, rules);
    if (!is_role(role) || name_space != signature_namespace(role))
        return not_counted(std::move(signer),
                           fmt::format("it was made for \"{}\", not for ROLE@runcert: sign with "
                                       "ssh-keygen -Y sign -n ROLE@runcert",
                                       escape_for_message(name_space)));
    const auto check = [&](const std::string& allowed) {
        return check_ssh_signature(one.run_dir / "report.json", one.run_dir / one.file.name,
                                   allowed, role, name_space, time);
    };
    if (const SshCheck itself = check(role + " " + signer.key + "\n"); !itself.valid)
        return broken(
            std::move(signer),
            fmt::format("it is not a signature of this report.json by its key: {}", itself.said));
    signer.role = role;
    if (const std::string weakness = weakness_of(signature.key); !weakness.empty())
        signer.notes.push_back(fmt::format(
            "its key is {}, weaker than any that signatures should be made with today", weakness));
    note_times(signer, one, report);
    signer = apply_roster(std::move(signer), signature.key, one, rules);
    // ssh-keygen has the last word on a roster that is written in its own form.
    if (signer.valid)
        if (const SshCheck listed = check(rules.roster->text); !listed.valid) {
            signer.valid = false;
            return not_counted(std::move(signer),
                               fmt::format("ssh-keygen refuses it by the roster: {}", listed.said));
        }
    return signer;
}

}  // namespace

Signer judge_by_roster(Signer signer, const SshPublicKey& key, std::optional<UtcSecond> stamped,
                       const SignatureRules& rules) {
    return apply_roster(std::move(signer), key, {.stamped = stamped}, rules);
}

Signer judge_signature(const SignatureCase& one, const ReportFacts& report,
                       const SignatureRules& rules) {
    Signer signer{.file = one.file.name, .sha256 = sha256_hex(one.file.text)};
    signer.time = iso_text(one.stamped.value_or(rules.at));
    signer.time_source = one.stamped ? "time stamp" : rules.at_was_given ? "given" : "present";
    try {
        return one.file.kind == SignatureKind::minisign ? judge_minisign(one, report, rules, signer)
                                                        : judge_ssh(one, report, rules, signer);
    } catch (const Failure& failure) {
        if (!failure.where().starts_with(one.file.name)) throw;
        return broken(signer, "it is not a signature: " + failure.problem());
    }
}

}  // namespace runcert
