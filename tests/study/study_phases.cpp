#include "study_phases.h"

#include <fstream>
#include <iterator>

#include "core/failure.h"
#include "stages/import/phase_table.h"
#include "stages/import/rinex/rinex.h"
#include "stages/screen/phases.h"
#include "witness/phase_rows.h"

namespace runcert {
namespace {

const std::string& broadcast() {
    static const std::string text = [] {
        std::ifstream file(std::string(RUNCERT_SOURCE_DIR) + "/examples/phase/broadcast.nav",
                           std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    }();
    return text;
}

}  // namespace

FrameOrigin study_origin() {
    FrameOrigin origin;
    origin.position = {.latitude = Angle::from_degrees(-31.6),
                       .longitude = Angle::from_degrees(136.0),
                       .height_m = 110.0};
    return origin;
}

GpsTime study_start() {
    return parse_gps_iso("2026-03-14T03:20:18.000");
}

StudyPhases study_phases(std::span<const SimulatedEpoch> epochs, double phase_noise_m,
                         double phase_multipath_m, std::uint64_t seed, const EnuTable& positions) {
    static const std::vector<Ephemeris> ephemerides =
        rinex::read_navigation({.name = "broadcast.nav", .bytes = broadcast()}).ephemerides;
    SimulationSpec spec;
    spec.place = study_origin().position;
    spec.start_gps = study_start();
    spec.seed = static_cast<std::int64_t>(seed);
    if (epochs.size() > 1) spec.run.rate_hz = 1000 / (epochs[1].time_ms - epochs[0].time_ms);
    RawSpec raw;
    raw.bands = 1;
    raw.phase_noise_m = phase_noise_m;
    raw.phase_multipath_m = phase_multipath_m;
    raw.doppler_noise_hz = 100.0;
    raw.clock_drift = 3e-7;
    const std::string text = rinex_observations_text(spec, raw, epochs, ephemerides);
    Receiver receiver;
    receiver.id = "primary";
    const StreamedPhases imported =
        import_phases(receiver, {.name = "raw.obs", .bytes = text},
                      {{.name = "broadcast.nav", .bytes = broadcast()}});
    PhaseRecordBuilder builder(imported.head);
    imported.give([&](const PhaseRow& row) { builder.add(row); });
    const ScreenedPhases screened =
        screen_receiver_phases(imported.head, std::move(builder).take(), positions, {});
    return {.phases = screened.phases, .first_epoch = screened.head.first_epoch};
}

}  // namespace runcert
