#include <nlohmann/json.hpp>

#include "reports/diff/day_difference.h"
#include "reports/diff/run_difference.h"

namespace runcert {

using Json = nlohmann::ordered_json;

Json difference_json(const RunDifference& difference) {
    Json json{{"schema", "run-difference/1.0"}};
    json.update(members_json(difference));
    return json;
}

Json comparison_json(const DayComparison& comparison) {
    Json json{{"schema", "day-comparison/1.0"}};
    json.update(members_json(comparison));
    // Of days it is the old and the new.
    for (Json& causes : json["causes"])
        for (const char* kind : {"programs", "inputs", "parameters", "attempt"})
            for (Json& change : causes[kind])
                change = {{"what", change["what"]}, {"old", change["a"]}, {"new", change["b"]}};
    return json;
}

}  // namespace runcert
