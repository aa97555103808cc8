#include "reports/certificate/certificate_document.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/text.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

/// km/h, m/s, kn, mph, the rule's own in front.
std::vector<const SpeedUnit*> units_in_order(const SpeedUnit& own) {
    std::vector<const SpeedUnit*> units{&own};
    for (const SpeedUnit& unit : speed_units())
        if (unit.name != own.name) units.push_back(&unit);
    return units;
}

void add_if_any(Document& document, Section section) {
    if (!section.blocks.empty()) document.sections.push_back(std::move(section));
}

}  // namespace

const CertifiableWindow* RuleView::best() const {
    return windows != nullptr && windows->best ? &*windows->best : nullptr;
}

std::string RuleView::titled(const std::string& title) const {
    return inputs.profiles.size() < 2 ? title
                                      : fmt::format("{}: rule “{}”", title, verdict.profile);
}

ShownFigures RuleView::shown() const {
    if (verdict.speed_m_s) return shown_of(verdict, unit().name);
    if (best() != nullptr)
        return shown_in({.speed_m_s = best()->speed_m_s,
                         .expanded_uncertainty_m_s =
                             expanded_uncertainty_m_s(*best(), verdict.coverage_factor)},
                        unit());
    ShownFigures figures{.unit = std::string(unit().name)};
    const auto& rounding = profile.result ? profile.result : profile.rounding;
    if (verdict.required_speed_m_s)
        figures.required_speed =
            shown_speed(SpeedKind::required, *verdict.required_speed_m_s,
                        rounding ? static_cast<int>(rounding->decimals) : unit().decimals, unit());
    return figures;
}

std::vector<RuleView> rule_views(const ReportInputs& inputs) {
    std::vector<RuleView> views;
    for (std::size_t i = 0; i < inputs.profiles.size(); ++i)
        views.push_back({inputs, inputs.verdict.profiles[i], inputs.profiles[i],
                         windows_of(inputs.receivers.front().windows, inputs.profiles[i].id)});
    return views;
}

std::string clause_name(const std::string& clause) {
    // Ids never change; what they are called in the field's terms may.
    if (clause == "kind-of-solution") return "Fix type";
    if (clause == "positions-on-the-earth") return "Geodetic coordinates";
    std::string name = clause;
    std::ranges::replace(name, '-', ' ');
    return capitalised(name);
}

std::vector<Block> plots_of(const Json& figures, std::string_view kind) {
    std::vector<Block> blocks;
    for (std::size_t i = 0; i < figures.size(); ++i)
        if (figures[i]["figure"] == kind)
            blocks.push_back(plot(i, figures[i]["figure_title"], figures[i]["caption"]));
    return blocks;
}

Block speed_table(const std::string& title, const std::vector<SpeedRow>& rows,
                  const RuleView& rule) {
    const auto units = units_in_order(rule.unit());
    const ShownFigures shown = rule.shown();
    std::vector<std::string> heads{""};
    for (const SpeedUnit* unit : units)
        heads.push_back(fmt::format(">{}|14", unit->name));
    Block block = table(heads, title);
    for (const SpeedRow& row : rows) {
        if (!row.speed_m_s) continue;
        std::vector<std::string> cells{row.label};
        for (const SpeedUnit* unit : units)
            cells.push_back(shown_speed(row.kind, *row.speed_m_s, shown, *unit));
        add_row(block, std::move(cells), row.counts ? "chosen" : "");
    }
    return block;
}

Document certificate_document(const ReportInputs& inputs, const std::string& report_id,
                              const Json& figures) {
    Document document{.title = "Measurement report " + report_id,
                      .subtitle = inputs.attempt.craft.name};
    document.sections.push_back(first_page(inputs, report_id, figures));
    add_if_any(document, requirements_section(inputs));
    add_if_any(document, window_section(inputs, figures));
    add_if_any(document, uncertainty_section(inputs));
    add_if_any(document, screening_section(inputs, figures));
    add_if_any(document, witnesses_section(inputs, figures));
    add_if_any(document, run_section(inputs, figures));
    add_if_any(document, recording_section(inputs));
    add_if_any(document, method_section(inputs));
    add_if_any(document, files_section(inputs, report_id));
    return document;
}

}  // namespace runcert
