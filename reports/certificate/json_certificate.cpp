#include <fmt/format.h>

#include <algorithm>

#include "core/rounding.h"
#include "reports/certificate/certificate_document.h"
#include "reports/certificate/json_parts.h"

namespace runcert {
namespace {

/// A unit of speed as D-SI writes it (https://doi.org/10.5281/zenodo.3522631), which has no mph.
std::string d_si_unit(const SpeedUnit& unit) {
    if (unit.name == "km/h") return "\\kilo\\metre\\per\\hour";
    if (unit.name == "kn") return "\\nauticalmile\\per\\hour";
    return "\\metre\\per\\second";
}

/// The unit of speed in which D-SI can give what the rule gives.
const SpeedUnit& certificate_unit(const Profile& profile) {
    const SpeedUnit& own = speed_unit(rule_unit_name(profile));
    return own.name == "mph" ? speed_unit("km/h") : own;
}

Json result_json(const ProfileVerdict& verdict, const Profile& profile) {
    const SpeedUnit& unit = certificate_unit(profile);
    return {{"rule", verdict.profile},
            {"name", rule_words(profile)},
            {"value", rounded(*verdict.speed_m_s * unit.per_m_s, 6)},
            {"unit", d_si_unit(unit)},
            {"expanded_uncertainty", rounded(*verdict.expanded_uncertainty_m_s * unit.per_m_s, 6)},
            {"coverage_factor", verdict.coverage_factor},
            {"coverage_probability", rounded(coverage_probability(profile.coverage_factor), 4)},
            {"distribution", "Student's t with the effective degrees of freedom of the budget"}};
}

Json called_json(const CalledProgram& program) {
    Json entry{{"name", program.name}};
    if (!program.version.empty()) entry["release"] = program.version;
    entry["sha256"] = program.sha256;
    return entry;
}

Json software_json(const ReportInputs& inputs) {
    Json list = Json::array();
    const auto add = [&](const Json& entry) {
        if (std::find(list.begin(), list.end(), entry) == list.end()) list.push_back(entry);
    };
    const auto ours = [](const std::string& name, const std::string& release,
                         const std::string& revision) {
        return Json{{"name", name}, {"release", release}, {"source_revision", revision}};
    };
    for (const ReceiverResults& results : inputs.receivers)
        for (const Header* header : headers_of(results, inputs.verdict)) {
            add(ours(header->stage, header->program_version, header->source_revision));
            for (const CalledProgram& program : header->programs)
                add(called_json(program));
        }
    add(ours("runcert-report", program_version(), source_revision()));
    return list;
}

void set_times(Json& json, const ReceiverResults& judged) {
    const auto& first = judged.observations.facts.first_epoch;
    if (!first || judged.screened.rows.empty()) return;
    json["begin_performance"] = to_utc_iso(*first, 3);
    json["end_performance"] =
        to_utc_iso(first->plus_nanoseconds(last_time(judged.screened.rows).nanoseconds), 3);
}

}  // namespace

std::vector<std::string> deviations(const ReportInputs& inputs) {
    std::vector<std::string> list;
    for (const std::string& parameter : inputs.attempt.overrides) {
        const std::size_t dot = std::min(parameter.find('.'), parameter.size() - 1);
        const YamlValue value =
            inputs.attempt
                .resolved["parameters"][parameter.substr(0, dot)][parameter.substr(dot + 1)];
        list.push_back(fmt::format(
            "Parameter {}{}, set by the attempt.", parameter,
            value.exists()
                ? ": " + json_from_yaml(value).dump(-1, ' ', false, Json::error_handler_t::replace)
                : ""));
    }
    for (const ProfileVerdict& verdict : inputs.verdict.profiles)
        for (const Override& figure : verdict.overrides)
            list.push_back(fmt::format(
                "Rule {}, {}: {} in place of {}{}{}. Reason: {}.", verdict.profile, figure.figure,
                number_text(figure.used), number_text(figure.rule), figure.unit.empty() ? "" : " ",
                figure.unit, figure.reason.empty() ? "none given" : figure.reason));
    return list;
}

Json signatures_required_json(const ReportInputs& inputs) {
    std::vector<RoleSignatures> needed;
    for (const Profile& profile : inputs.profiles)
        needed = combined(std::move(needed), profile.signatures);
    Json list = Json::array();
    for (const RoleSignatures& one : combined(std::move(needed), inputs.attempt.signatures))
        list.push_back({{"role", one.role}, {"count", one.count}});
    return list;
}

Json certificate_json(const ReportInputs& inputs, const std::string& report_id) {
    const Attempt& attempt = inputs.attempt;
    Json json{{"unique_identifier", report_id},
              {"item", {{"name", attempt.craft.name}, {"class", attempt.craft.kind}}}};
    if (!attempt.place.empty()) json["performance_location"] = attempt.place;
    set_times(json, inputs.receivers.front());
    json["responsible_persons"] = Json::array();
    for (const Official& official : attempt.officials) {
        Json person{{"role", official.role}};
        if (!official.name.empty()) person["person_name"] = official.name;
        json["responsible_persons"].push_back(std::move(person));
    }
    json["software"] = software_json(inputs);
    json["results"] = Json::array();
    for (std::size_t i = 0; i < inputs.profiles.size(); ++i) {
        const ProfileVerdict& verdict = inputs.verdict.profiles[i];
        if (verdict.speed_m_s && verdict.expanded_uncertainty_m_s &&
            verdict.outcome != Outcome::not_certifiable)
            json["results"].push_back(result_json(verdict, inputs.profiles[i]));
    }
    json["deviations"] = deviations(inputs);
    return json;
}

Json amends_json(const Attempt& attempt) {
    if (!attempt.amends) return nullptr;
    return {{"report_id", attempt.amends->report_id},
            {"sha256", attempt.amends->sha256},
            {"amends_reason", attempt.amends->reason}};
}

}  // namespace runcert
