#include <fmt/format.h>

#include "reports/audit/sections.h"

namespace runcert {

const std::vector<std::string>& audited_stages() {
    static const std::vector<std::string> stages{"import", "enu",    "screen",
                                                 "smooth", "window", "check"};
    return stages;
}

Walk walk_through(const RunRecord& record, const WalkOptions& options) {
    Walk walk{.title = fmt::format("Audit of the attempt {}", record.attempt.id), .sections = {}};
    if (options.stages.empty()) walk.sections.push_back(run_section(record, options));
    const auto is_asked = [&](const std::string& stage) {
        return options.stages.empty() || options.stages.contains(stage);
    };
    using Make = Section (*)(const RunRecord&, const ReceiverRecord&, bool);
    constexpr std::pair<const char*, Make> makers[] = {{"import", import_section},
                                                       {"enu", enu_section},
                                                       {"screen", screen_section},
                                                       {"smooth", smooth_section},
                                                       {"window", window_section}};
    for (const auto& [stage, make] : makers)
        for (const ReceiverRecord& one : record.receivers)
            if (is_asked(stage) &&
                (options.receiver.empty() || options.receiver == one.receiver.id))
                walk.sections.push_back(make(record, one, options.all));
    if (is_asked("check")) walk.sections.push_back(check_section(record, options.all));
    return walk;
}

}  // namespace runcert
