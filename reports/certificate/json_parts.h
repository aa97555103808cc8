#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/certificate/report_data.h"
#include "reports/words/figures.h"

// The parts of a report's predicate (`v1.yaml`), which `report_json` puts together.

namespace runcert {

using Json = nlohmann::ordered_json;

/// The members of that name.
Json attempt_json(const Attempt& attempt, const Verdict& verdict);
Json frame_json(const ReportInputs& inputs);
Json receiver_json(const ReceiverResults& results, const Receiver& receiver);
Json method_json(const ReportInputs& inputs);
/// Of the profile of that index in the verdict.
Json profile_json(const ReportInputs& inputs, std::size_t index);
/// What is to be drawn. `profiles` are the above.
Json figures_json(const ReportInputs& inputs, const Json& profiles);

/// The signatures that its rules and its attempt require, for each role the largest count.
Json signatures_required_json(const ReportInputs& inputs);
/// What every certificate of a measurement says (ISO/IEC 17025:2017 7.8.2), in the words of PTB's
/// Digital Calibration Certificate where it has one (https://www.ptb.de/dcc/).
Json certificate_json(const ReportInputs& inputs, const std::string& report_id);
/// The report that this one replaces; null where there is none.
Json amends_json(const Attempt& attempt);
/// What the page of the raw signals says; null where there are none.
Json raw_signals_json(const ReceiverResults& results);

/// Of a receiver: what screening decided (epochs by reason, decisions by hypothesis) and what its
/// tests rested on, of the faults of the time stamps the first 20.
Json screening_json(const ScreenedTable& table);
/// The same as shown, a line for each thing that an official asks.
Json screening_facts(const ScreenedTable& table);

/// Of a profile: which speed counts, "Speed over 3 s, by the definition: Displacement over time."
std::string rule_words(const Profile& profile);
/// Sets what the profile looks for where it is not the usual: a time, horizontally, from positions.
void set_rule(Json& json, const Profile& profile);
/// The record to beat, with its speed in each unit and in words.
Json record_json(const RecordToBeat& record);
/// Sets the record, how the outcome was decided, and the rule of decision in words, with who agreed
/// on it. Of the profile of that index in the verdict.
void set_decision(Json& json, const ReportInputs& inputs, std::size_t index);
/// Sets what must be read with the verdict: notes, replaced figures, clauses that could not be
/// confirmed. Nothing where there are none.
void set_reservations(Json& json, const ProfileVerdict& verdict);
/// The certified window, which the verdict must have. `windows` is null where none were searched.
Json window_json(const ProfileVerdict& verdict, const ProfileWindows* windows,
                 const Profile& profile);
/// The refused window of a verdict, which has one.
Json indicated_json(const ProfileVerdict& verdict, const Profile& profile);

/// The unit and the factor that a window's uncertainties are shown with.
struct UncertaintyScale {
    const SpeedUnit& unit;
    double coverage_factor = 2.0;
};

/// Of a window: where the uncertainty of its speed comes from. What the fitted noise alone and the
/// robust estimate say, the bound on time-correlated errors, the choice of the fastest window, the
/// budget and its Monte Carlo check. Speeds as shown are in the rule's unit.
Json uncertainty_json(const ProfileVerdict& verdict, const ProfileWindows& windows,
                      const Profile& profile);
/// The rows of the budget, each with its figures, its share of the variance and what is shown.
Json budget_json(const CertifiableWindow& window, const UncertaintyScale& scale);
/// What stands beneath the rows: combined and expanded uncertainty.
Json budget_total_json(const CertifiableWindow& window, const UncertaintyScale& scale);
/// The Monte Carlo check beside what the law of propagation gives for the same interval, compared
/// as [GUM-S1] 8 asks: both within the numerical tolerance.
Json monte_carlo_json(const CertifiableWindow& window, const UncertaintyScale& scale);

/// Adds a label and a text to a list of facts.
void add_fact(Json& facts, std::string_view label, std::string value);

/// Sets `name_km_h`, `name_m_s`, `name_knots`, `name_mph` where there is a speed.
void set_speeds(Json& json, const std::string& name, const std::optional<double>& speed_m_s);

/// Sets the end of a span on the clock, `end_gps` and `end_utc`, where it has one.
void set_end(Json& json, const WindowSpan& span);

/// The unit in which the rule is written.
const SpeedUnit& rule_unit(const Profile& profile);

/// One speed, to be shown in every unit.
struct SpeedRow {
    enum Kind {
        measured,     ///< with the decimals of the measured speed, rounded down
        uncertainty,  ///< with two significant digits, rounded up
        limit,        ///< with the decimals of the measured speed, rounded up
        stated        ///< not measured: with the decimals usual for its unit
    };
    std::string label;
    std::optional<double> speed_m_s;
    Kind kind = measured;
};

/// Rows of one speed each, in every unit, the rule's own first, where figures are those of the
/// headline. Rows without a speed are left out.
Json speed_table(const std::vector<SpeedRow>& rows, const Profile& profile,
                 std::optional<double> uncertainty_m_s);

}  // namespace runcert
