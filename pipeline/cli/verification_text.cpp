#include "verification_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/plain_text.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

const char* mark_of(const VerificationStep& step) {
    if (!step.checked) return "-";
    return step.passed ? "yes" : "NO";
}

Json text_or_null(const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(text);
}

Json layer_json(const VerificationStep& step) {
    return {{"layer", step.what},
            {"passed", step.checked ? Json(step.passed) : Json(nullptr)},
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

}  // namespace

bool VerificationResult::passed() const {
    return std::ranges::all_of(
        layers, [](const VerificationStep& step) { return step.passed || !step.checked; });
}

bool VerificationResult::recomputed() const {
    return std::ranges::any_of(layers, [](const VerificationStep& step) {
        return step.what == "recompute" && step.checked && step.passed;
    });
}

std::string VerificationResult::verdict() const {
    if (!passed()) return "NOT VERIFIED";
    return recomputed() ? "VERIFIED" : "SIGNED, NOT RECOMPUTED";
}

/// A title rests on all layers: that a record was beaten is not said of a run that does not verify.
std::vector<std::string> VerificationResult::standing_lines() const {
    std::vector<std::string> lines;
    if (!standing) return lines;
    for (const RuleStanding& rule : standing->rules)
        lines.push_back(
            passed() || rule.state.standing.state != StandingState::complete
                ? fmt::format("{}: {}. Standing: {}.", rule.profile,
                              outcome_words(rule.state).title, standing_text(rule.state.standing))
                : fmt::format("{}: no standing, since not all above holds.", rule.profile));
    lines.push_back(vouched_words(*standing));
    return lines;
}

std::string verification_text(const VerificationResult& result) {
    std::string text;
    for (const VerificationStep& step : result.layers) {
        text +=
            fmt::format("{:<4} {:<13} {}\n", mark_of(step), step.what, plain_text(step.finding));
        for (const std::string& detail : step.details)
            text += fmt::format("     {:<13} {}\n", "", plain_text(detail));
    }
    text += "\n";
    for (const std::string& line : result.standing_lines())
        text += plain_text(line) + "\n";
    text += fmt::format("\n{}\n", result.verdict());
    if (result.passed() && !result.recomputed())
        text +=
            "The signatures hold. Whether the figures follow from the recording was not checked: "
            "add --recompute.\n";
    if (!result.missing_sandbox.empty()) text += plain_text(result.missing_sandbox) + "\n";
    return text;
}

std::string verification_json(const VerificationResult& result) {
    const bool passed = result.passed();
    Json json{{"verdict", result.verdict()},
              {"exit_status", passed ? 0 : 1},
              {"exit_meaning", !passed               ? "some of it does not hold"
                               : result.recomputed() ? "all of it holds"
                                                     : "all that was checked holds; the figures "
                                                       "were not computed again"},
              {"missing_sandbox", text_or_null(result.missing_sandbox)},
              {"layers", Json::array()},
              {"signers", Json::array()}};
    for (const VerificationStep& step : result.layers)
        json["layers"].push_back(layer_json(step));
    for (const Signer& signer : result.signers)
        json["signers"].push_back(signer_json(signer));
    json["standing"] = result.standing_lines();
    return json.dump(2, ' ', true, Json::error_handler_t::replace) + '\n';
}

}  // namespace runcert
