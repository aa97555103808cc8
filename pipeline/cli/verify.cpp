#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "recompute.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "store/process.h"
#include "trust/bundle.h"
#include "trust/receipt.h"
#include "trust/roster.h"
#include "trust/run_standing.h"
#include "trust/signed_log.h"
#include "trust/verification.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

struct VerifyOptions {
    std::string run_dir;
    std::vector<std::string> public_keys;
    std::string roster;
    std::vector<std::string> time_stamp_cas;
    std::string at;
    bool recompute = false;
    bool keep_going = false;
    bool json = false;
};

std::optional<Roster> read_keys(const VerifyOptions& options) {
    std::optional<Roster> roster = read_roster(options.roster);
    for (const std::string& given : options.public_keys) {
        const std::string role = given.substr(0, given.find('='));
        const bool for_a_role = role.size() < given.size() && is_role(role);
        const std::string file = for_a_role ? given.substr(role.size() + 1) : given;
        const std::string who = std::filesystem::path(file).stem().string();
        if (!roster) roster.emplace();
        append(*roster, roster_of_public_key(read_handwritten(file), escape_for_message(who), file,
                                             for_a_role ? role : "*"));
    }
    return roster;
}

SignatureRules read_rules(const VerifyOptions& options) {
    SignatureRules rules{
        .roster = read_keys(options),
        .by_public_keys = options.roster.empty(),
        .roster_of_run = !options.roster.empty() && lies_in(options.roster, options.run_dir)};
    rules.time_stamp_cas.assign(options.time_stamp_cas.begin(), options.time_stamp_cas.end());
    rules.present = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    rules.at = rules.present;
    const auto in_force = [&] {
        if (rules.roster) require_in_force(*rules.roster, rules.at, options.roster);
    };
    if (options.at.empty()) {
        in_force();
        return rules;
    }
    const auto at = parse_iso_utc(options.at);
    if (!at)
        throw Failure("--at", fmt::format("\"{}\" is no time", escape_for_message(options.at)),
                      "Write it in UTC as 2026-11-21T20:41:50Z");
    rules.at = *at;
    rules.at_was_given = true;
    in_force();
    return rules;
}

/// Layers beside the decision: where one of these cannot be checked here, the others stand, and the
/// last line names it.
constexpr std::array<std::string_view, 4> beside_the_decision{"bundle", "time stamps", "log",
                                                              "pages"};

bool fails(const VerificationStep& step) {
    return step.is(LayerAnswer::not_verified);
}

/// All that `runcert verify` found.
struct VerificationResult {
    std::vector<VerificationStep> layers{};
    std::vector<Signer> signers{};
    std::optional<RunStanding> standing{};
    std::string missing_sandbox{};  ///< here, of programs of others that read the folder

    /// No layer says no.
    bool passed() const { return std::ranges::none_of(layers, fails); }
    /// The figures were computed again. What a key signs may have been written by hand.
    bool recomputed() const {
        return std::ranges::any_of(layers, [](const VerificationStep& step) {
            return step.what == "recompute" && step.is(LayerAnswer::verified);
        });
    }
    /// The layers that could not be checked here.
    std::vector<std::string> unchecked() const {
        std::vector<std::string> names;
        for (const VerificationStep& step : layers)
            if (step.is(LayerAnswer::not_checkable)) names.push_back(step.what);
        return names;
    }
    /// Where a layer says no, 1; where one that decides could not be checked, 2. Without the others
    /// the rest stands: `verdict` names them.
    int exit_status() const {
        if (!passed()) return 1;
        const auto decides = [](const std::string& name) {
            return std::ranges::find(beside_the_decision, name) == beside_the_decision.end();
        };
        return std::ranges::any_of(unchecked(), decides) ? 2 : 0;
    }
    /// What does not hold first, and what to do; empty where all does.
    std::string fault() const {
        const auto first = std::ranges::find_if(layers, fails);
        if (first == layers.end()) return {};
        const bool of_signatures = first->what == "signatures" || first->what == "attestations";
        const bool lacks_keys = of_signatures && standing && standing->roster_sha256.empty() &&
                                !signers.empty() && std::ranges::none_of(signers, &Signer::valid) &&
                                std::ranges::none_of(signers, &Signer::broken);
        return fmt::format(
            "{}. {}.{}",
            lacks_keys ? std::string("nobody vouches for the keys of its signers")
            : of_signatures || first->details.empty() ? first->finding
                                                      : first->details.front(),
            lacks_keys      ? "Add --roster FILE, the body's list of keys"
            : of_signatures ? "Ask for the run as its officials signed it"
                            : "Ask whoever sent it for the original",
            std::ranges::count_if(layers, fails) == 1 ? " All else that was checked holds." : "");
    }
    /// "VERIFIED", "SIGNED, NOT RECOMPUTED" or "NOT VERIFIED"; of the first two, what was not
    /// checked: "VERIFIED; pages not checked here".
    std::string verdict() const {
        if (!passed()) return "NOT VERIFIED";
        std::string words = recomputed() ? "VERIFIED" : "SIGNED, NOT RECOMPUTED";
        if (const auto names = unchecked(); !names.empty())
            words += fmt::format("; {} not checked here", listed(names));
        return words;
    }
};

/// What stands in front of a layer, and its word for programs.
struct AnswerWords {
    const char* mark;
    const char* word;
};

AnswerWords words_of(const VerificationStep& step) {
    if (!step.answer) return {"-", "nothing to check"};
    if (step.is(LayerAnswer::verified)) return {"yes", "verified"};
    return fails(step) ? AnswerWords{"NO", "not verified"} : AnswerWords{"?", "not checkable here"};
}

Json text_or_null(const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(text);
}

Json layer_json(const VerificationStep& step) {
    const bool decided = step.is(LayerAnswer::verified) || step.is(LayerAnswer::not_verified);
    return {{"layer", step.what},
            {"answer", words_of(step).word},
            {"passed", decided ? Json(step.is(LayerAnswer::verified)) : Json(nullptr)},
            {"finding", step.finding},
            {"details", step.details}};
}

Json signer_json(const Signer& signer) {
    return {{"file", signer.file},
            {"role", text_or_null(signer.role)},
            {"key", text_or_null(signer.key)},
            {"who", text_or_null(signer.who)},
            {"stated_time", text_or_null(signer.stated_time)},
            {"time", signer.time},
            {"time_source", signer.time_source},
            {"valid", signer.valid},
            {"reason", text_or_null(signer.reason)},
            {"notes", signer.notes}};
}

/// Where each rule stands: that a record was beaten is not said of a run that does not verify.
std::vector<std::string> standing_of(const VerificationResult& result) {
    return result.standing ? standing_lines(*result.standing, result.passed())
                           : std::vector<std::string>();
}

bool asked_to_recompute(const VerificationResult& result) {
    return std::ranges::find(result.layers, "recompute", &VerificationStep::what) !=
           result.layers.end();
}

/// For people: a line for each layer, its details below, the verdict at the end.
std::string verification_text(const VerificationResult& result) {
    std::string text;
    for (const VerificationStep& step : result.layers) {
        text += fmt::format("{:<4} {:<13} {}\n", words_of(step).mark, step.what,
                            plain_text(step.finding));
        for (const std::string& detail : step.details)
            text += fmt::format("     {:<13} {}\n", "", plain_text(detail));
    }
    text += "\n";
    for (const std::string& line : standing_of(result))
        text += plain_text(line) + "\n";
    text += "\n";
    if (!result.missing_sandbox.empty()) text += plain_text(result.missing_sandbox) + "\n";
    if (result.passed() && !result.recomputed())
        text += fmt::format(
            "The signatures hold. Whether the figures follow from the recording was not checked{}",
            asked_to_recompute(result) ? ".\n" : ": add --recompute.\n");
    const std::string fault = result.fault();
    return text + result.verdict() + (fault.empty() ? "" : ": " + plain_text(fault)) + "\n";
}

std::string exit_meaning(const VerificationResult& result) {
    if (result.exit_status() == 1) return "some of it does not hold";
    if (result.exit_status() == 2) return "what decides could not be checked here";
    if (!result.recomputed())
        return "all that was checked holds; the figures were not computed again";
    return result.unchecked().empty() ? "all of it holds"
                                      : "all that decides holds; not all was checked";
}

/// For machines, one JSON document: verdict, exit_status and its meaning, the layers that could not
/// be checked, each layer with its answer (passed is null where it is neither yes nor no), signers,
/// standing.
std::string verification_json(const VerificationResult& result) {
    Json json{{"verdict", result.verdict()},
              {"exit_status", result.exit_status()},
              {"exit_meaning", exit_meaning(result)},
              {"not_checked_here", result.unchecked()},
              {"missing_sandbox", text_or_null(result.missing_sandbox)},
              {"layers", Json::array()},
              {"signers", Json::array()}};
    for (const VerificationStep& step : result.layers)
        json["layers"].push_back(layer_json(step));
    for (const Signer& signer : result.signers)
        json["signers"].push_back(signer_json(signer));
    json["standing"] = standing_of(result);
    return json.dump(2, ' ', true, Json::error_handler_t::replace) + '\n';
}

/// Files that are not what the report names, or were changed by somebody, are not computed with.
bool found_a_fault(const VerificationResult& result) {
    return std::ranges::any_of(result.layers,
                               [](const VerificationStep& step) {
                                   return fails(step) && step.what != "signatures";
                               }) ||
           std::ranges::any_of(result.signers, &Signer::broken);
}

/// A layer that computes for long, which is left out after a fault unless asked for.
template <class Layer>
void add_long_layer(VerificationResult& result, bool keep_going, const char* what, Layer&& layer) {
    if (keep_going || !found_a_fault(result))
        result.layers.push_back(layer());
    else
        result.layers.push_back({.what = what,
                                 .answer = LayerAnswer::not_checkable,
                                 .finding = "not done, because of what was found above "
                                            "(--keep-going does it all the same)"});
}

/// A bundle of another form than this program gives it may hold what nobody looks at.
void add_deviation(VerificationStep& step, const std::optional<std::string>& deviation,
                   const ReportFacts& report) {
    if (!deviation || !step.is(LayerAnswer::verified)) return;
    step.finding = "it is not as this runcert writes a bundle";
    if (is_made_here(report))
        step.fail(*deviation);
    else
        step.leave(fmt::format("not checked here: {}; {}", made_by_another(report), *deviation));
}

int verify(const VerifyOptions& options) {
    // A copy is verified: whoever writes to the original meanwhile changes nothing.
    const TemporaryFolder folder;
    const std::filesystem::path given = folder.path() / "run";
    if (std::filesystem::is_directory(options.run_dir)) require_within_limits(options.run_dir);
    std::filesystem::copy(
        std::filesystem::canonical(options.run_dir), given,
        std::filesystem::copy_options::recursive | std::filesystem::copy_options::copy_symlinks);
    std::filesystem::path run_dir = given;
    std::optional<UnpackedBundle> bundle;
    if (std::filesystem::is_regular_file(given)) {
        bundle = unpack_bundle(given, options.run_dir);
        run_dir = bundle->run_dir;
    }
    require_within_limits(run_dir);
    const SignatureRules rules = read_rules(options);
    const ReportFacts report = read_report_facts(run_dir);
    VerificationResult result;
    if (auto sums = verify_bundle(run_dir, bundle.has_value())) {
        if (bundle) add_deviation(*sums, deviation_of_bundle(given, run_dir), report);
        result.layers.push_back(std::move(*sums));
    }
    for (VerificationStep& layer :
         std::array{verify_files(run_dir, report), verify_chain(run_dir, report),
                    verify_schemas(run_dir, report), verify_rules(run_dir),
                    verify_report(run_dir, report)})
        result.layers.push_back(std::move(layer));
    add_long_layer(result, options.keep_going, "contents",
                   [&] { return verify_report_text(run_dir, report); });
    SignatureLayers signatures = verify_signatures(run_dir, report, rules);
    result.layers.push_back(std::move(signatures.signatures));
    result.layers.push_back(std::move(signatures.time_stamps));
    result.signers = std::move(signatures.signers);
    AttestationLayer attestations = verify_attestations(run_dir, report, result.signers, rules);
    result.layers.push_back(std::move(attestations.step));
    result.standing = std::move(attestations.standing);
    if (auto receipts = verify_receipts(run_dir, report, rules))
        result.layers.push_back(std::move(*receipts));
    if (auto logged = verify_logged(run_dir, report, rules))
        result.layers.push_back(std::move(*logged));
    add_long_layer(result, options.keep_going, "pages", [&] {
        return verify_pages(run_dir, report, rules, result.standing.value_or(RunStanding{}));
    });
    if (options.recompute)
        add_long_layer(result, options.keep_going, "recompute",
                       [&] { return verify_recomputation(run_dir, report); });
    result.missing_sandbox = missing_sandbox();
    require_time();
    fmt::print("{}", options.json ? verification_json(result) : verification_text(result));
    return result.exit_status();
}

void add_options(CommandLine& line, VerifyOptions& options) {
    line.text("RUN_DIR", options.run_dir,
              "the folder of a certified run, or a bundle of one (.tar.zst, .zip)",
              CommandLine::required);
    line.texts("--pubkey", options.public_keys,
               "public key of who signed (runcert keygen, minisign, OpenSSH), which counts in "
               "every role, or as ROLE=KEY in that one; may be repeated. No roster vouches for it");
    line.text("--roster", options.roster,
              "whose signatures count: OpenSSH's allowed signers, the principals being roles");
    line.exclude("--roster", {"--pubkey"});
    line.texts("--tsa-ca", options.time_stamp_cas,
               "certificate (PEM) of a root that time stamps are accepted under; may be repeated. "
               "Without it they are not checked, and do not count");
    line.text(
        "--at", options.at,
        "the time at which keys must be valid, for signatures without a checked time stamp, as "
        "2026-11-21T20:41:50Z (default: the present)");
    line.flag("--recompute", options.recompute, "run every stage again and compare every file");
    line.flag("--keep-going", options.keep_going,
              "render pages and recompute even where another layer found a fault");
    line.flag("--json", options.json, "print one JSON document instead");
    line.time_limit();
}

}  // namespace

void add_verify(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<VerifyOptions>(
        app, chosen, "verify",
        "Check a run folder: every hash, the whole chain, schemas, rules, signatures, pages",
        verify);
    add_options(line, options);
    line.footer(
        std::string() +
        "A roster has a line for each key, as `runcert keygen` prints it:\n  measurer,observer "
        "namespaces=\"*@runcert\",valid-after=\"20260101Z\",valid-before=\"20280101Z\" "
        "ssh-ed25519 AAAA... WHO\nRoles may hold * and ?, and ! in front refuses; namespaces are "
        "ROLE@runcert. Times are YYYYMMDD,\nYYYYMMDDHHMM or YYYYMMDDHHMMSS, in UTC with a Z "
        "behind them (recommended), else in the local time of\nthe computer that verifies. Keys "
        "of type ssh-ed25519 serve for minisign's signatures too, others for\nthose of ssh-keygen "
        "alone.\nA line \"#runcert signatures judge=2,measurer\" in it asks for these signatures, "
        "whatever rule and\nattempt ask for; of each role the most counts. \"#runcert close "
        "judge\" says who closes\na run (default: the board).\nA key must be valid at the time of "
        "the signature's checked time stamp, else at --at; what the signer\nstates is shown, and "
        "must lie within the key's validity too. A key counts for one role. Whether "
        "a\ncertificate of an authority was revoked is not looked at.\nEach layer says yes, NO, "
        "or \"?\": it cannot be checked here, and why (a program is missing, or\nis another than "
        "made it). The last line names these: \"VERIFIED; pages not checked here\".\nVERIFIED "
        "alone means that all was checked.\nWithout --recompute the verdict is at best \"signed, "
        "not recomputed\": whoever signs may have\nwritten the figures by hand. Pages are "
        "rendered again each time.\n" +
        bundle_limits_words() +
        "\nThe standing counts answers (runcert attest) and signatures by keys of the roster: it "
        "is\ncomplete where each requirement is met or attested, all signatures stand, and the "
        "close\n(attest --close) lists them all. A roster that lies in the run vouches for "
        "nothing. What is\nopen, or was answered no, does not change the exit status; an "
        "attestation that is not as it\nwas signed does.\nExit status: 0 verified, or signed and "
        "not recomputed; 1 not verified; 2 not checkable, as where\n--recompute could not be "
        "done. Pages, time stamps and the form of a bundle do not change it\nwhere they cannot be "
        "checked.");
}

}  // namespace runcert
