#include "stages/screen/screen.h"

#include "stages/screen/epoch_checks.h"
#include "stages/screen/innovation_test.h"

namespace runcert {

ScreenConfig screen_config(const Attempt& attempt) {
    const nlohmann::ordered_json& parameters = attempt.parameters.at("screen");
    ScreenConfig config;
    for (const auto& word : parameters.at("allowed_fixes")) {
        FixKind fix{};
        from_text(word.get<std::string>(), fix);
        config.allowed_fixes.insert(fix);
    }
    config.accuracy_min_m = parameters.at("accuracy_min_m");
    config.accuracy_max_m = parameters.at("accuracy_max_m");
    config.gap_factor = parameters.at("gap_factor");
    config.false_alarm_rate = parameters.at("false_alarm_rate");
    config.restart_after = parameters.at("restart_after");
    config.min_arc_epochs = parameters.at("min_arc_epochs");
    config.model.motion.jerk_density = parameters.at("jerk_density");
    return config;
}

ScreenedTable screen(const EnuTable& table, const ScreenConfig& config) {
    ScreenedTable screened;
    screened.facts = table.facts;
    screened.origin = table.origin;
    screened.rows.reserve(table.rows.size());
    for (const EnuEpoch& row : table.rows)
        static_cast<EnuEpoch&>(screened.rows.emplace_back()) = row;

    const bool vertical = table.facts.vertical_measured;
    check_epochs(screened.rows, vertical, config);
    number_arcs(screened.rows, table.facts.nominal_interval_s, config);
    screened.variance_factor = robust_variance_factor(screened.rows, vertical, config);
    test_innovations(screened.rows, vertical, screened.variance_factor, config);
    drop_short_arcs(screened.rows, config);
    return screened;
}

}  // namespace runcert
