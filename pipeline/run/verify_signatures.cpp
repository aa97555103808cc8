#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "files/time_stamp.h"
#include "run/signature_files.h"
#include "run/signature_judgement.h"
#include "run/signature_policy.h"
#include "run/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

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
    VerificationStep step{
        .passed = true, .what = "time stamps", .finding = {}, .details = {}, .checked = false};
    std::map<std::string, UtcSecond> times{};
};

void check_stamp(Stamps& stamps, const fs::path& run_dir, const std::string& name,
                 const SignatureRules& rules) {
    const std::string signature = name.substr(0, name.rfind('.'));
    const std::string shown = escape_for_message(name, 120);
    if (!fs::is_regular_file(fs::symlink_status(run_dir / signature))) {
        stamps.step.checked = true;
        stamps.step.passed = false;
        stamps.step.details.push_back(shown + ": the signature that it is for is not there");
        return;
    }
    if (rules.time_stamp_cas.empty()) {
        stamps.step.details.push_back(
            shown + ": there, unchecked and not counted; give --tsa-ca to check it");
        return;
    }
    const TimeStampCheck check =
        check_time_stamp(run_dir / signature, run_dir / name, rules.time_stamp_cas);
    stamps.step.checked = true;
    stamps.step.passed = stamps.step.passed && check.valid;
    stamps.step.details.push_back(
        check.valid ? fmt::format("{}: the signature was there at {}", shown, iso_text(check.time))
                    : fmt::format("{}: does not hold: {}", shown, check.reason));
    if (check.valid) stamps.times[signature] = check.time;
}

Stamps check_stamps(const fs::path& run_dir, const SignatureRules& rules) {
    Stamps stamps;
    const std::vector<std::string> names = stamps_in(run_dir);
    for (const std::string& name : names)
        check_stamp(stamps, run_dir, name, rules);
    VerificationStep& step = stamps.step;
    if (!step.checked) {
        step.passed = false;
        step.finding = names.empty() ? "there are none" : "not checked";
    } else {
        step.finding =
            step.passed ? fmt::format("{} by the authorities given",
                                      names.size() == 1 ? "it holds, signed" : "all hold, signed")
                        : "not every time stamp holds";
    }
    return stamps;
}

std::string time_words(const Signer& signer) {
    std::string words;
    if (!signer.stated_time.empty())
        words += fmt::format("; its signer states {}", escape_for_message(signer.stated_time));
    if (signer.time_source == "time stamp") words += fmt::format("; time stamp {}", signer.time);
    return words;
}

std::string signer_line(const Signer& signer) {
    const std::string file = escape_for_message(signer.file, 120);
    const std::string role = signer.role.empty() ? "no role stated" : signer.role;
    const std::string who = signer.who.empty() ? "" : fmt::format(", {}", signer.who);
    if (signer.valid) return fmt::format("{}: {}{}: holds{}", file, role, who, time_words(signer));
    if (signer.broken) return fmt::format("{}: REFUSED: {}", file, signer.reason);
    return fmt::format("{}: {}{}: not counted: {}", file, role, who, signer.reason);
}

/// What the report needs, in words; sets whether it has it.
void judge_policy(const ReportFacts& report, const std::vector<Signer>& signers,
                  VerificationStep& step) {
    const auto valid = std::ranges::count_if(signers, &Signer::valid);
    const auto refused = std::ranges::count_if(signers, &Signer::broken);
    std::vector<std::string> missing;
    for (const RoleState& state : fill_roles(report.required, signers)) {
        step.details.push_back(fmt::format("needed: {} in the role {}; there: {}", state.needed,
                                           state.role, state.there));
        if (state.there < state.needed)
            missing.push_back(fmt::format("{} of {}", state.needed - state.there, state.role));
    }
    step.passed = valid > 0 && refused == 0 && missing.empty();
    if (refused > 0)
        step.finding = "report.json: a signature does not hold";
    else if (valid == 0)
        step.finding = "no signature of report.json counts";
    else if (!missing.empty())
        step.finding = "report.json: signatures are missing: " + listed(missing);
    else
        step.finding = fmt::format("report.json was signed by {}", counted(valid, "signer"));
}

}  // namespace

SignatureLayers verify_signatures(const fs::path& run_dir, const ReportFacts& report,
                                  const SignatureRules& rules) {
    Stamps stamps = check_stamps(run_dir, rules);
    SignatureLayers layers{
        .time_stamps = std::move(stamps.step),
        .signatures = {.passed = false, .what = "signatures", .finding = {}, .details = {}}};
    VerificationStep& step = layers.signatures;
    for (const SignatureFile& file : signature_files(run_dir)) {
        SignatureCase one{.run_dir = run_dir, .file = file};
        const auto stamped = stamps.times.find(file.name);
        if (stamped != stamps.times.end()) one.stamped = stamped->second;
        layers.signers.push_back(judge_signature(one, report, rules));
        step.details.push_back(signer_line(layers.signers.back()));
    }
    judge_policy(report, layers.signers, step);
    if (layers.signers.empty())
        step.finding = "the report is UNSIGNED: nobody answers for it";
    else if (!rules.roster)
        step.finding =
            "the report is signed, but no key was given to check the signatures with "
            "(--pubkey or --roster)";
    return layers;
}

}  // namespace runcert
