// The readers of raw measurements, each a target. What is read goes through the whole of what is
// done with it: orbits, places, slips, displacements.

#include <algorithm>
#include <cmath>

#include "fuzz_target.h"
#include "satellites/ephemeris.h"
#include "stages/import/phase_table.h"
#include "stages/import/rinex/rinex.h"
#include "stages/import/ubx/raw.h"
#include "store/atomic_file.h"
#include "witness/phase_rows.h"
#include "witness/phase_witness.h"

namespace runcert::fuzz {
namespace {

/// Screening is quadratic in nothing, but its tests are dear: longer inputs say no more.
constexpr std::size_t most_rows = 4000;

void check_ephemerides(const std::vector<Ephemeris>& all) {
    for (const Ephemeris& each : all) {
        require(is_plausible(each), "an ephemeris is one");
        for (const std::int64_t after_s : {-7200, 0, 7200}) {
            const SatelliteState state =
                satellite_state(each, each.reference.plus_nanoseconds(after_s * 1'000'000'000));
            require(state.position_m.allFinite() && std::isfinite(state.clock_s),
                    "a satellite is somewhere");
        }
    }
}

/// A navigation file whose one satellite is that of the seeds.
const std::string& navigation() {
    static const std::string text = read_file(RUNCERT_SOURCE_DIR "/examples/phase/broadcast.nav");
    return text;
}

void check_phases(std::string_view bytes, bool with_navigation) {
    Receiver receiver;
    receiver.id = "primary";
    receiver.place = "attempt.yaml:5:5";
    std::vector<RecordingBytes> navigations;
    if (with_navigation) navigations.push_back({.name = "nav", .bytes = navigation()});
    const StreamedPhases phases =
        import_phases(receiver, {.name = "raw", .bytes = bytes}, navigations);
    PhaseRecordBuilder builder(phases.head);
    std::size_t rows = 0;
    phases.give([&](const PhaseRow& row) {
        require(!row.phase_cycles || std::isfinite(*row.phase_cycles), "phases are finite");
        require(!row.satellite_x_m || std::isfinite(*row.satellite_x_m), "places are finite");
        if (rows++ < most_rows) builder.add(row);
    });
    require(rows == static_cast<std::size_t>(phases.rows), "as many rows as are said");
    PhaseRecord record = std::move(builder).take();
    locate_by_pseudoranges(record);
    PhaseScreeningConfig config;
    config.repair = bytes.size() % 2 == 1;
    const PhaseScreening screening = screen_phases(record, config);
    require(screening.findings.size() == record.signals.size(), "a finding for each signal");
    require(std::ranges::is_sorted(screening.slips, {}, &PhaseSlip::signal), "slips in order");
    if (record.epochs.size() > 1)
        if (const auto moved = displacement_between(record, screening, 0, record.epochs.size() - 1))
            require(moved->enu_m.allFinite(), "a displacement is finite");
}

}  // namespace

void read_input(std::string_view bytes) {
    if (target_name() == "rinex_navigation") {
        check_ephemerides(rinex::read_navigation({.name = "nav", .bytes = bytes}).ephemerides);
    } else if (target_name() == "sfrbx") {
        // Messages of up to 8 bytes of head and ten words, one after the other.
        ubx::NavigationCollector collector;
        const GpsTime near = GpsTime::from_week(2381, 400'000'000'000'000);
        for (std::size_t at = 0; at < bytes.size(); at += 48)
            (void)collector.take(bytes.substr(at, 48), static_cast<std::int64_t>(at), near);
        check_ephemerides(collector.ephemerides());
    } else {
        check_phases(bytes, target_name() == "rinex_observation" || bytes.size() % 4 < 2);
    }
}

}  // namespace runcert::fuzz
