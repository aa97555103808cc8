#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "store/external_program.h"
#include "trust/signature.h"
#include "trust/signature_files.h"
#include "trust/ssh_signature.h"
#include "trust/time_stamp.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// Keys by the slot they fill: augmenting paths [Kuhn55].
class Matching {
  public:
    explicit Matching(std::vector<std::set<std::string>> keys_of_slot)
        : keys_of_slot_(std::move(keys_of_slot)), filled_(keys_of_slot_.size(), false) {
        for (std::size_t slot = 0; slot < keys_of_slot_.size(); ++slot) {
            std::set<std::string> tried;
            fill(slot, tried);
        }
        for (const auto& [key, slot] : slot_of_key_)
            filled_[slot] = true;
    }
    bool is_filled(std::size_t slot) const { return filled_[slot]; }

  private:
    bool fill(std::size_t slot, std::set<std::string>& tried) {
        for (const std::string& key : keys_of_slot_[slot]) {
            if (!tried.insert(key).second) continue;
            const auto taken = slot_of_key_.find(key);
            if (taken != slot_of_key_.end() && !fill(taken->second, tried)) continue;
            slot_of_key_[key] = slot;
            return true;
        }
        return false;
    }

    std::vector<std::set<std::string>> keys_of_slot_;
    std::map<std::string, std::size_t> slot_of_key_;
    std::vector<bool> filled_;
};

std::vector<std::string> stamps_in(const fs::path& run_dir) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(run_dir)) {
        const std::string name = entry.path().filename().string();
        if (belongs_to_signatures(name) && name.ends_with(".tsr") &&
            fs::is_regular_file(entry.symlink_status()))
            names.push_back(name);
    }
    std::ranges::sort(names);
    return names;
}

/// The time of each signature whose stamp holds; what is found of every stamp goes into `step`.
struct Stamps {
    VerificationStep step{.what = "time stamps"};
    std::map<std::string, UtcSecond> times{};
};

void check_stamp(Stamps& stamps, const fs::path& run_dir, const std::string& name,
                 const SignatureRules& rules) {
    const std::string signature = name.substr(0, name.rfind('.'));
    const std::string file = shown(name);
    if (!fs::is_regular_file(fs::symlink_status(run_dir / signature)))
        return stamps.step.fail(file + ": the signature that it is for is not there");
    if (rules.time_stamp_cas.empty())
        return stamps.step.leave(file +
                                 ": there, unchecked and not counted; give --tsa-ca to check it");
    if (const std::string missing = missing_program_words("openssl"); !missing.empty())
        return stamps.step.leave(file + ": there, unchecked and not counted: " + missing);
    TimeStampCheck check =
        check_time_stamp(run_dir / signature, run_dir / name, rules.time_stamp_cas);
    if (check.valid && check.time > rules.present + clock_tolerance)
        check = {.reason = fmt::format("it is of {}, which is yet to come", iso_text(check.time))};
    if (!check.valid)
        return stamps.step.fail(fmt::format("{}: does not hold: {}", file, check.reason));
    if (!stamps.step.answer) stamps.step.answer = LayerAnswer::verified;
    stamps.step.details.push_back(
        fmt::format("{}: the signature was there at {}", file, iso_text(check.time)));
    stamps.times[signature] = check.time;
}

Stamps check_stamps(const fs::path& run_dir, const SignatureRules& rules) {
    Stamps stamps;
    const std::vector<std::string> names = stamps_in(run_dir);
    for (const std::string& name : names)
        check_stamp(stamps, run_dir, name, rules);
    VerificationStep& step = stamps.step;
    step.finding = !step.answer                          ? "there are none"
                   : step.is(LayerAnswer::not_checkable) ? "not checked here"
                   : step.is(LayerAnswer::not_verified)
                       ? "not every time stamp holds"
                       : fmt::format("{} by the authorities given",
                                     names.size() == 1 ? "it holds, signed" : "all hold, signed");
    return stamps;
}

std::string time_words(const Signer& signer) {
    std::string words;
    if (!signer.stated_time.empty())
        words += fmt::format("; its signer states {}", escape_for_message(signer.stated_time));
    if (signer.time_source == "time stamp") words += fmt::format("; time stamp {}", signer.time);
    if (signer.not_recomputed) words += "; signed without recomputing";
    for (const std::string& note : signer.notes)
        words += "; " + note;
    return words;
}

std::string signer_line(const Signer& signer) {
    const std::string file = shown(signer.file);
    const std::string role = signer.role.empty() ? "no role stated" : signer.role;
    const std::string who = signer.who.empty() ? "" : fmt::format(", {}", signer.who);
    if (signer.valid) return fmt::format("{}: {}{}: holds{}", file, role, who, time_words(signer));
    if (signer.broken) return fmt::format("{}: REFUSED: {}", file, signer.reason);
    return fmt::format("{}: {}{}: not counted: {}", file, role, who, signer.reason);
}

/// One key that signed in two roles, or in two forms, is one signer.
std::int64_t signers_that_count(const std::vector<Signer>& signers) {
    std::set<std::string> keys;
    for (const Signer& signer : signers)
        if (signer.valid) keys.insert(key_identity(signer));
    return static_cast<std::int64_t>(keys.size());
}

/// What report and roster ask for together: none of the two lowers what the other asks for.
std::vector<RequiredSignatures> required_by(const ReportFacts& report,
                                            const SignatureRules& rules) {
    std::vector<RequiredSignatures> required = report.required;
    if (!rules.roster) return required;
    for (const RoleSignatures& one : rules.roster->required) {
        const auto count = static_cast<std::size_t>(one.count);
        const auto known = std::ranges::find(required, one.role, &RequiredSignatures::role);
        if (known == required.end())
            required.push_back({.role = one.role, .count = count});
        else
            known->count = std::max(known->count, count);
    }
    return required;
}

/// What is needed, in words; sets whether it is there.
void judge_policy(const std::vector<RequiredSignatures>& required,
                  const std::vector<Signer>& signers, VerificationStep& step) {
    const auto valid = std::ranges::count_if(signers, &Signer::valid);
    const auto refused = std::ranges::count_if(signers, &Signer::broken);
    std::vector<std::string> missing;
    for (const RoleState& state : fill_roles(required, signers)) {
        step.details.push_back(fmt::format("needed: {} in the role {}; there: {}", state.needed,
                                           state.role, state.there));
        if (state.there < state.needed)
            missing.push_back(fmt::format("{} of {}", state.needed - state.there, state.role));
    }
    step.answer = valid > 0 && refused == 0 && missing.empty() ? LayerAnswer::verified
                                                               : LayerAnswer::not_verified;
    if (refused > 0)
        step.finding = "report.json: a signature does not hold";
    else if (valid == 0)
        step.finding = "no signature of report.json counts";
    else if (!missing.empty())
        step.finding = "report.json: signatures are missing: " + listed(missing);
    else
        step.finding = fmt::format("report.json was signed by {}",
                                   counted(signers_that_count(signers), "signer"));
}

/// Different keys of one holder count as different signers; the reader is told.
std::vector<std::string> shared_holders(const std::vector<Signer>& signers) {
    std::map<std::string, std::set<std::string>> keys_of;
    for (const Signer& signer : signers)
        if (signer.valid && !signer.who.empty()) keys_of[signer.who].insert(key_identity(signer));
    std::vector<std::string> notes;
    for (const auto& [who, keys] : keys_of)
        if (keys.size() > 1)
            notes.push_back(
                fmt::format("note: {} keys that count are called \"{}\": is that one "
                            "person?",
                            keys.size(), who));
    return notes;
}

}  // namespace

std::string key_identity(const Signer& signer) {
    if (signer.key.find(' ') != std::string::npos) return signer.key;
    return ssh_key_text(ssh_key_of(parse_public_key(signer.key, signer.file).key));
}

std::vector<RoleState> fill_roles(const std::vector<RequiredSignatures>& required,
                                  const std::vector<Signer>& signers) {
    std::vector<RoleState> states;
    std::vector<std::set<std::string>> keys_of_slot;
    std::vector<std::size_t> state_of_slot;
    for (const RequiredSignatures& one : required) {
        std::set<std::string> keys;
        for (const Signer& signer : signers)
            if (signer.valid && signer.role == one.role) keys.insert(key_identity(signer));
        keys_of_slot.insert(keys_of_slot.end(), one.count, keys);
        state_of_slot.insert(state_of_slot.end(), one.count, states.size());
        states.push_back({.role = one.role, .needed = one.count});
    }
    const Matching matching(std::move(keys_of_slot));
    for (std::size_t slot = 0; slot < state_of_slot.size(); ++slot)
        if (matching.is_filled(slot)) ++states[state_of_slot[slot]].there;
    return states;
}

SignatureLayers verify_signatures(const fs::path& run_dir, const ReportFacts& report,
                                  const SignatureRules& rules) {
    Stamps stamps = check_stamps(run_dir, rules);
    SignatureLayers layers{.time_stamps = std::move(stamps.step),
                           .signatures = {.what = "signatures"}};
    VerificationStep& step = layers.signatures;
    for (const SignatureFile& file : signature_files(run_dir)) {
        SignatureCase one{.run_dir = run_dir, .file = file};
        const auto stamped = stamps.times.find(file.name);
        if (stamped != stamps.times.end()) one.stamped = stamped->second;
        layers.signers.push_back(judge_signature(one, report, rules));
        step.details.push_back(signer_line(layers.signers.back()));
    }
    if (rules.at_was_given)
        step.details.push_back(
            fmt::format("keys without a checked time stamp were judged as of {} (--at), not as of "
                        "the present, {}",
                        iso_text(rules.at), iso_text(rules.present)));
    for (std::string& note : shared_holders(layers.signers))
        step.details.push_back(std::move(note));
    if (rules.roster && rules.by_public_keys)
        step.details.emplace_back(
            "the keys were given one by one: no roster vouches for whose they are or for their "
            "roles");
    judge_policy(required_by(report, rules), layers.signers, step);
    if (layers.signers.empty())
        step.finding = "the report is UNSIGNED: nobody answers for it";
    else if (!rules.roster)
        step.finding =
            "the report is signed, but no key was given to check the signatures with "
            "(--pubkey or --roster)";
    return layers;
}

}  // namespace runcert
