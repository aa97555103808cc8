#include <benchmark/benchmark.h>

#include "satellites/phase_screening.h"
#include "simulation/raw_measurements.h"
#include "stages/import/phase_table.h"
#include "stages/import/rinex/rinex.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "witness/phase_rows.h"
#include "witness/phase_witness.h"

// The parts of carrier phases, each beside the SHA-256 of the file that it reads or writes, which
// every file of a run is hashed by in any case: a signal at an epoch is an item.
namespace runcert {
namespace {

constexpr double seconds = 282.0;  // 2,820 epochs, a tenth of an afternoon

const std::string& phase_navigation() {
    static const std::string text = read_file(RUNCERT_SOURCE_DIR "/examples/phase/broadcast.nav");
    return text;
}

const std::string& raw_text() {
    static const std::string text = [] {
        SimulationSpec spec;
        spec.run = {.top_speed_m_s = 60.0, .start_speed_m_s = 1.0, .half_speed_time_s = 20.0};
        spec.run.duration_s = seconds - 0.1;
        spec.place = Geodetic{.latitude = Angle::from_degrees(-31.6),
                              .longitude = Angle::from_degrees(136.0),
                              .height_m = 110.0};
        spec.start_gps = parse_gps_iso("2026-03-14T03:20:18.000");
        RawSpec raw;
        raw.mask_deg = 15.0;
        return rinex_observations_text(
            spec, raw, simulate(spec),
            rinex::read_navigation({.name = "n", .bytes = phase_navigation()}).ephemerides);
    }();
    return text;
}

StreamedPhases read_raw_text() {
    Receiver receiver;
    receiver.id = "primary";
    return import_phases(receiver, {.name = "raw.obs", .bytes = raw_text()},
                         {{.name = "nav", .bytes = phase_navigation()}});
}

const std::string& phase_table_text() {
    static const std::string text = [] {
        const StreamedPhases phases = read_raw_text();
        std::string all;
        TableWriter<PhaseRow> table =
            begin_phase(phases.head, [&](std::string_view piece) { all += piece; });
        phases.give([&](const PhaseRow& row) { table.write(row); });
        table.finish();
        return all;
    }();
    return text;
}

PhaseRecord record_of_table() {
    auto table = open_phase(phase_table_text(), "1-phase.ecsv");
    PhaseRecordBuilder builder(table.head);
    for (PhaseRow row; table.rows.next(row);)
        builder.add(row);
    return std::move(builder).take();
}

const PhaseRecord& located_record() {
    static const PhaseRecord record = [] {
        PhaseRecord made = record_of_table();
        locate_by_pseudoranges(made);
        return made;
    }();
    return record;
}

void count(benchmark::State& state, std::size_t bytes) {
    state.SetItemsProcessed(state.iterations() *
                            static_cast<std::int64_t>(located_record().signals.size()));
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

void phases_hashed(benchmark::State& state) {
    (void)located_record();
    for (auto _ : state)
        benchmark::DoNotOptimize(sha256_hex(raw_text()));
    count(state, raw_text().size());
}
BENCHMARK(phases_hashed)->Name("phases/raw file hashed")->Unit(benchmark::kMillisecond);

void phases_read(benchmark::State& state) {
    (void)located_record();
    for (auto _ : state)
        benchmark::DoNotOptimize(read_raw_text().rows);
    count(state, raw_text().size());
}
BENCHMARK(phases_read)->Name("phases/raw file read")->Unit(benchmark::kMillisecond);

void phases_written(benchmark::State& state) {
    (void)located_record();
    const StreamedPhases phases = read_raw_text();
    for (auto _ : state) {
        std::size_t size = 0;
        TableWriter<PhaseRow> table =
            begin_phase(phases.head, [&](std::string_view piece) { size += piece.size(); });
        phases.give([&](const PhaseRow& row) { table.write(row); });
        table.finish();
        benchmark::DoNotOptimize(size);
    }
    count(state, phase_table_text().size());
}
BENCHMARK(phases_written)->Name("phases/orbits and table")->Unit(benchmark::kMillisecond);

void phases_table_read(benchmark::State& state) {
    (void)located_record();
    for (auto _ : state)
        benchmark::DoNotOptimize(record_of_table().signals.size());
    count(state, phase_table_text().size());
}
BENCHMARK(phases_table_read)->Name("phases/table read")->Unit(benchmark::kMillisecond);

void phases_screened(benchmark::State& state) {
    for (auto _ : state)
        benchmark::DoNotOptimize(screen_phases(located_record(), {}).pairs);
    count(state, phase_table_text().size());
}
BENCHMARK(phases_screened)->Name("phases/screened")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace runcert
