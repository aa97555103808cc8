#pragma once

#include <nlohmann/json.hpp>

#include "reports/certificate/report_data.h"

namespace runcert {

/// The parts of the predicate, `reports/certificate/v1.yaml`, as members of that name.
nlohmann::ordered_json attempt_json(const Attempt& attempt, const Verdict& verdict);
nlohmann::ordered_json frame_json(const ReportInputs& inputs);
nlohmann::ordered_json receiver_json(const ReceiverResults& results, const Receiver& receiver);
nlohmann::ordered_json method_json(const ReportInputs& inputs);
/// Of the profile of that index in the verdict.
nlohmann::ordered_json profile_json(const ReportInputs& inputs, std::size_t index);
/// What is to be drawn. `profiles` are the above.
nlohmann::ordered_json figures_json(const ReportInputs& inputs,
                                    const nlohmann::ordered_json& profiles);

}  // namespace runcert
