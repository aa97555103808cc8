#include "batch/step_settings.h"

#include <nlohmann/json.hpp>

namespace runcert {

HeldJson settings_of_step(std::string_view step, const Attempt& attempt,
                          const std::vector<YamlValue>& profiles, const ReportChoice& choice) {
    if (step == "sign") return nlohmann::ordered_json{{"signer", choice.signer}};
    if (step == "render") return nlohmann::ordered_json{{"pdf", choice.pdf}};
    if (!reads_part(step)) return HeldJson();
    HeldJson settings = part_of_stage(attempt, step).settings;
    if (settings->contains("profiles")) settings["profiles"] = profiles_of_stage(profiles, step);
    return settings;
}

}  // namespace runcert
