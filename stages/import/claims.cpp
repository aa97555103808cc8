#include "stages/import/claims.h"

#include "stages/import/format.h"

namespace runcert {
void note_origins_of_head(const Receiver& receiver, Observations& head) {
    const Format* format = find_format(head.format);
    head.time_origin = format ? format->time_origin : "";
    head.facts.time_source = format && format->of_satellites        ? "satellites"
                             : receiver.time_source == "satellites" ? "attempt"
                                                                    : "unknown";
    head.solution_source = SolutionSource::recording;
}

void note_origins(const Receiver& receiver, Observations& observations) {
    note_origins_of_head(receiver, observations);
    FixType claimed = FixType::unknown;
    from_text(receiver.solution, claimed);
    bool stated = false;
    bool missing = false;
    for (Observation& row : observations.rows) {
        if (row.fix != FixType::unknown) {
            stated = true;
            continue;
        }
        missing = true;
        row.fix = claimed;
    }
    if (missing)
        observations.solution_source = claimed != FixType::unknown ? SolutionSource::attempt
                                       : stated                    ? SolutionSource::partly
                                                                   : SolutionSource::unknown;
}

}  // namespace runcert
