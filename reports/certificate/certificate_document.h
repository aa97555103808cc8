#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/certificate/report_data.h"
#include "reports/words/figures.h"
#include "schemas/document/document.h"

// The certificate as blocks: its first page, and the annex in the order in which a board asks.

namespace runcert {

/// A report as people read it. `figures` are those of its predicate, and stand where the sections
/// place them. Failure where the inputs do not belong together.
Document certificate_document(const ReportInputs& inputs, const std::string& report_id,
                              const nlohmann::ordered_json& figures);

/// What is certified by one rule.
struct RuleView {
    const ReportInputs& inputs;
    const ProfileVerdict& verdict;
    const Profile& profile;
    const ProfileWindows* windows =
        nullptr;  ///< of the judged receiver; null if none were searched

    const SpeedUnit& unit() const { return speed_unit(rule_unit_name(profile)); }
    /// The certified window; null if there is none.
    const CertifiableWindow* best() const;
    /// "Budget: rule “nalsa”", where there are several rules.
    std::string titled(const std::string& title) const;
    /// The figures as they are to be read; those of the window where the verdict has no speed, and
    /// the required speed alone where there is neither.
    ShownFigures shown() const;
};
std::vector<RuleView> rule_views(const ReportInputs& inputs);

/// "Secondary method" of the clause secondary-method.
std::string clause_name(const std::string& clause);
/// Which speed counts, "Speed over 3 s, by the definition: displacement over time."
std::string rule_words(const Profile& profile);
/// The figures of that kind, as plots in the order of the report.
std::vector<Block> plots_of(const nlohmann::ordered_json& figures, std::string_view kind);

/// One speed, to be shown in every unit.
struct SpeedRow {
    std::string label;
    std::optional<double> speed_m_s;
    SpeedKind kind = SpeedKind::measured;
    bool counts = false;  ///< the one that the rule counts
};
/// Rows of one speed each, in every unit, the rule's own first, with the decimals of the figures on
/// the first page. Rows without a speed are left out.
Block speed_table(const std::string& title, const std::vector<SpeedRow>& rows,
                  const RuleView& rule);

// The sections.

Section first_page(const ReportInputs& inputs, const std::string& report_id,
                   const nlohmann::ordered_json& figures);
Section requirements_section(const ReportInputs& inputs);
Section window_section(const ReportInputs& inputs, const nlohmann::ordered_json& figures);
Section uncertainty_section(const ReportInputs& inputs);
Section screening_section(const ReportInputs& inputs, const nlohmann::ordered_json& figures);
/// Empty where there are neither witnesses nor raw signals.
Section witnesses_section(const ReportInputs& inputs, const nlohmann::ordered_json& figures);
Section run_section(const ReportInputs& inputs, const nlohmann::ordered_json& figures);
Section recording_section(const ReportInputs& inputs);
Section method_section(const ReportInputs& inputs);
Section files_section(const ReportInputs& inputs, const std::string& report_id);

/// The blocks of a rule's uncertainty budget and of its check.
std::vector<Block> budget_blocks(const RuleView& rule);
/// What screening of a receiver decided and what its tests rested on.
std::vector<Block> screening_blocks(const ReceiverResults& results);

/// Who answers for a requirement: "judge", "2 of judge".
std::string answerer_text(const Requirement& requirement);
/// Figures of the method and of rules that the attempt replaced, in words.
std::vector<std::string> deviations(const ReportInputs& inputs);
/// The report's figures of the raw signals, and what they say; empty where there are none.
std::vector<std::string> raw_signal_sentences(const ReceiverResults& results);

}  // namespace runcert
