#include <fmt/format.h>

#include "reports/results/results.h"

namespace runcert {
namespace {

/// km/h, m/s, kn, mph, the rule's own in front.
std::vector<const SpeedUnit*> units_in_order(const SpeedUnit& own) {
    std::vector<const SpeedUnit*> units{&own};
    for (const SpeedUnit& unit : speed_units())
        if (unit.name != own.name) units.push_back(&unit);
    return units;
}

}  // namespace

const SpeedUnit& RuleView::unit() const {
    return speed_unit(verdict.shown ? verdict.shown->unit : rule_unit_name(profile));
}

const CertifiableWindow* RuleView::best() const {
    return windows != nullptr && windows->best ? &*windows->best : nullptr;
}

std::string RuleView::titled(const std::string& title) const {
    return several ? fmt::format("{}: rule “{}”", title, verdict.profile) : title;
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

}  // namespace runcert
