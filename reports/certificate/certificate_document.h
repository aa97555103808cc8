#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "reports/certificate/report_data.h"
#include "reports/plot/plot.h"
#include "reports/results/results.h"
#include "schemas/document/document.h"

// The certificate as blocks: its first page, and the annex in the order in which a board asks.

namespace runcert {

/// A report as people read it. What its sections draw is added to `figures` of its predicate.
/// Failure where the inputs do not belong together.
Document certificate_document(const ReportInputs& inputs, const std::string& report_id,
                              nlohmann::ordered_json& figures);

/// The blocks where plots stand; those that `figures` lacks are added to it.
std::vector<Block> shown(const Plots& plots, nlohmann::ordered_json& figures);

/// What was found by each rule, of the judged receiver.
std::vector<RuleView> rule_views(const ReportInputs& inputs);

/// "Secondary method" of the clause secondary-method.
std::string clause_name(const std::string& clause);

// The sections.

Section first_page(const ReportInputs& inputs, const std::string& report_id,
                   nlohmann::ordered_json& figures);
Section requirements_section(const ReportInputs& inputs);
Section window_section(const ReportInputs& inputs, nlohmann::ordered_json& figures);
Section uncertainty_section(const ReportInputs& inputs);
Section screening_section(const ReportInputs& inputs, nlohmann::ordered_json& figures);
/// Empty where there are neither witnesses nor raw signals.
Section witnesses_section(const ReportInputs& inputs, nlohmann::ordered_json& figures);
/// Empty where no receiver has an IMU.
Section attitude_section(const ReportInputs& inputs, nlohmann::ordered_json& figures);
Section run_section(const ReportInputs& inputs, nlohmann::ordered_json& figures);
Section recording_section(const ReportInputs& inputs);
Section method_section(const ReportInputs& inputs);
Section files_section(const ReportInputs& inputs, const std::string& report_id);

/// Who answers for a requirement: "judge", "2 of judge".
std::string answerer_text(const Requirement& requirement);
/// Figures of the method and of rules that the attempt replaced, in words.
std::vector<std::string> deviations(const ReportInputs& inputs);
}  // namespace runcert
