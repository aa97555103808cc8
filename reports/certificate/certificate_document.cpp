#include "reports/certificate/certificate_document.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/claimed_text.h"
#include "core/text.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

void add_if_any(Document& document, Section section) {
    if (!section.blocks.empty()) document.sections.push_back(std::move(section));
}

}  // namespace

std::vector<RuleView> rule_views(const ReportInputs& inputs) {
    std::vector<RuleView> views;
    for (std::size_t i = 0; i < inputs.profiles.size(); ++i)
        views.push_back({inputs.attempt, inputs.verdict.profiles[i], inputs.profiles[i],
                         windows_of(inputs.receivers.front().windows, inputs.profiles[i].id),
                         inputs.profiles.size() > 1});
    return views;
}

std::string clause_name(const std::string& clause) {
    // Ids never change; what they are called in the field's terms may.
    if (clause == "kind-of-solution") return "Fix type";
    if (clause == "positions-on-the-earth") return "Geodetic coordinates";
    if (clause == "imu-as-measured") return "IMU as measured";
    std::string name = clause;
    std::ranges::replace(name, '-', ' ');
    return capitalised(name);
}

std::vector<Block> shown(const Plots& plots, Json& figures) {
    std::vector<Block> blocks;
    for (const Plot& one : plots) {
        const Json figure = plot_json(one);
        const auto known = std::ranges::find(figures, figure);
        blocks.push_back(
            plot(static_cast<std::size_t>(known - figures.begin()), one.title, one.caption));
        if (known == figures.end()) figures.push_back(figure);
    }
    return blocks;
}

Document certificate_document(const ReportInputs& inputs, const std::string& report_id,
                              Json& figures) {
    Document document{.title = "Measurement report " + report_id,
                      .subtitle = "Craft, as claimed: " + claimed(inputs.attempt.craft.name)};
    document.sections.push_back(first_page(inputs, report_id, figures));
    add_if_any(document, requirements_section(inputs));
    add_if_any(document, window_section(inputs, figures));
    add_if_any(document, uncertainty_section(inputs));
    add_if_any(document, screening_section(inputs, figures));
    add_if_any(document, witnesses_section(inputs, figures));
    add_if_any(document, attitude_section(inputs, figures));
    add_if_any(document, run_section(inputs, figures));
    add_if_any(document, recording_section(inputs));
    add_if_any(document, method_section(inputs));
    add_if_any(document, files_section(inputs, report_id));
    return document;
}

}  // namespace runcert
