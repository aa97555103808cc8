#include "run/run_times.h"

#include <nlohmann/json.hpp>

#include "core/rounding.h"
#include "files/program.h"
#include "files/yaml_output.h"

namespace runcert {

std::string run_times_text(std::time_t started, const std::vector<StageDone>& stages) {
    nlohmann::ordered_json record;
    record["program"] = program_version();
    record["source_revision"] = source_revision();
    record["started_unix_s"] = started;
    for (const StageDone& stage : stages)
        record["stages"].push_back(
            {{"stage", stage.name}, {"seconds", rounded(stage.seconds, 3)}, {"said", stage.said}});
    return to_yaml_text(record);
}

}  // namespace runcert
