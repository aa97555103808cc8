#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"

namespace runcert {

/// The steps in which a run is made, in their order: "claim" brings in the attempt and what it
/// names beside recordings; then the stages; then "report" (report.json), "sign", and "render" (the
/// pages).
const std::vector<std::string>& step_names();

/// The program that does a step, "runcert-smooth"; empty for those that no program of their own
/// does ("claim", "sign").
std::string program_of_step(std::string_view step);

/// How a run is reported.
struct ReportChoice {
    bool render = true;
    bool pdf = true;
    std::string signer = {};  ///< key id and role; empty for no signature
};

/// Whether the step is part of a run that is reported so.
bool is_step_of(std::string_view step, const ReportChoice& choice);

/// The files of the run folder that a step reads and that earlier steps wrote. Recordings, and what
/// else import and claim read from outside, are among what these two write.
std::vector<std::string> inputs_of_step(std::string_view step, const Attempt& attempt);

/// The files that a step writes; of "sign" none, whose name is known when it is written.
std::vector<std::string> outputs_of_step(std::string_view step, const Attempt& attempt,
                                         const ReportChoice& choice);

/// What of the attempt and its profiles, given as written, a step uses beside its input files.
///
/// A key of the attempt or of a profile that this function does not know counts as used by every
/// step, so that forgetting one costs time and not a right result.
nlohmann::ordered_json settings_of_step(std::string_view step, const Attempt& attempt,
                                        const nlohmann::ordered_json& attempt_document,
                                        const std::vector<nlohmann::ordered_json>& profiles,
                                        const ReportChoice& choice);

}  // namespace runcert
