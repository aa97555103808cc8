#include "reports/certificate/json_screening_basis.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_facts.h"
#include "reports/words/screening.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::ptrdiff_t faults_listed = 20;  ///< in the report
constexpr std::size_t faults_shown = 3;       ///< in words

/// Counts hold every fault, the table a thousand of them at most.
std::int64_t faults_of(const TimeStampSummary& time) {
    return std::max(time.gaps + time.duplicates + time.backward, std::ssize(time.faults));
}

std::string model_text(const ScreeningModel& model) {
    if (model.noise == NoiseBasis::fitted) return std::string(words_of(model.noise));
    return fmt::format("{} times the stated one ({})", significant_text(model.measurement_scale, 2),
                       words_of(model.noise));
}

/// Once, where it is the same on all axes.
std::string noise_text(const std::vector<ScreeningModel>& models) {
    if (models.empty()) return "none: nothing could be tested";
    std::string first = model_text(models.front());
    if (std::all_of(models.begin(), models.end(),
                    [&](const ScreeningModel& model) { return model_text(model) == first; }))
        return first;
    std::string text;
    for (const ScreeningModel& model : models)
        text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", to_text(model.axes),
                            model_text(model));
    return text;
}

/// Fix types in their order, a line for each with all of its axes.
void add_kinds(Json& facts, const std::vector<FixTypeErrors>& kinds) {
    std::vector<std::pair<FixType, std::string>> lines;
    for (const FixTypeErrors& kind : kinds) {
        const auto line = std::find_if(lines.begin(), lines.end(),
                                       [&](const auto& each) { return each.first == kind.fix; });
        if (line == lines.end())
            lines.emplace_back(kind.fix, fix_type_errors_text(kind));
        else
            line->second += "; " + fix_type_errors_text(kind);
    }
    for (auto& [fix, text] : lines)
        facts.push_back(fact(capitalised(words_of(fix)), std::move(text)));
}

std::string fault_text(const TimeFault& fault) {
    return fmt::format("epoch {}: {}", fault.epoch, time_fault_text(fault));
}

std::string time_text(const TimeStampSummary& time) {
    const std::int64_t faults = faults_of(time);
    if (faults == 0) return "no fault";
    std::string text = counted(faults, "fault");
    const std::size_t shown = std::min(time.faults.size(), faults_shown);
    for (std::size_t i = 0; i < shown; ++i)
        text += (i == 0 ? ": " : "; ") + fault_text(time.faults[i]);
    const std::int64_t left = faults - static_cast<std::int64_t>(shown);
    return left > 0 ? text + fmt::format("; and {} more", left) : text;
}

}  // namespace

Json screening_basis_json(const ScreeningBasis& basis) {
    Json json = members_json(basis);
    Json& faults = json["time"]["faults"];
    if (std::ssize(basis.time.faults) > faults_listed)
        faults.erase(faults.begin() + faults_listed, faults.end());
    json["time"]["faults_found"] = faults_of(basis.time);
    return json;
}

Json screening_basis_facts(const ScreeningBasis& basis) {
    Json facts = Json::array();
    facts.push_back(fact("False alarms", false_alarm_text(basis)));
    facts.push_back(fact("Noise assumed by the tests", noise_text(basis.models)));
    add_kinds(facts, basis.fix_types);
    facts.push_back(fact("Recorded velocities", basis.velocity
                                                    ? velocity_comparison_text(*basis.velocity)
                                                    : "too few were recorded to compare"));
    for (const DisplacementComparison& each : basis.displacements)
        facts.push_back(fact("Displacements by a witness", displacement_comparison_text(each)));
    if (basis.device)
        facts.push_back(
            fact("Signs of positions that were not measured", device_signs_text(*basis.device)));
    facts.push_back(fact("Order and spacing of the time stamps", time_text(basis.time)));
    if (basis.baseline)
        facts.push_back(fact("Other receiver", baseline_comparison_text(*basis.baseline)));
    return facts;
}

}  // namespace runcert
