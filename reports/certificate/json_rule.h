#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "reports/certificate/json_facts.h"
#include "reports/certificate/report_data.h"

namespace runcert {

/// The unit in which the rule is written.
const SpeedUnit& rule_unit(const Profile& profile);

/// A rule's definition of speed in words.
std::string definition_words(SpeedDefinition definition);

/// Which speed the rule counts: "Speed over 3 s, by the definition: Displacement over time."
std::string rule_words(const Profile& profile);

/// Sets what the profile looks for, as far as it is not a time, horizontally, from positions.
void set_rule(nlohmann::ordered_json& json, const Profile& profile);

/// The record to beat, with its speed in each unit and in words.
nlohmann::ordered_json record_json(const RecordToBeat& record);

/// Sets the record, how the outcome was decided, and the rule of decision in words.
void set_decision(nlohmann::ordered_json& json, const ProfileVerdict& verdict,
                  const Profile& profile);

/// Sets what must be read with the verdict: notes, replaced figures, clauses that could not be
/// confirmed. Nothing where there are none.
void set_reservations(nlohmann::ordered_json& json, const ProfileVerdict& verdict);

}  // namespace runcert
