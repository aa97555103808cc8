#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include "import_test_support.h"
#include "satellites/phase_record.h"
#include "stages/import/phase_table.h"
#include "witness/phase_rows.h"

namespace runcert::import_test {

struct Phases {
    PhaseTable head;
    PhaseRecord record;
};

/// Raw measurements of the recorded data, with its navigation file ("" for none), as a record.
inline Phases recorded_phases(const std::string& observed, const std::string& navigation) {
    const auto text = recorded(observed);
    const std::string broadcast = navigation.empty() ? "" : *recorded(navigation);
    Receiver receiver = pos_receiver();
    std::vector<RecordingBytes> navigations;
    if (!navigation.empty()) navigations.push_back({.name = navigation, .bytes = broadcast});
    const StreamedPhases phases =
        import_phases(receiver, {.name = observed, .bytes = *text}, navigations);
    PhaseRecordBuilder builder(phases.head);
    phases.give([&](const PhaseRow& row) { builder.add(row); });
    return {phases.head, std::move(builder).take()};
}

}  // namespace runcert::import_test
