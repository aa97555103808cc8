#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "schemas/enu/declared.h"
#include "schemas/observations/observations.h"
#include "schemas/trajectory/declared.h"
#include "stages/import/format.h"
#include "stages/import/import.h"
#include "store/sha256.h"

// How fast tables and recordings become rows and rows become tables, on one core, in MB (10^6
// bytes) of text for each second of processor time; beside it what the machine does with the same
// text or numbers by memcpy, by strtod on each number, and by printf of each number.

namespace runcert::RUNCERT_FILE {
namespace {

constexpr std::int64_t epochs = 200'000;

/// A slow curve at 20 Hz, with every column of a table with covariances filled.
EnuTable enu_table() {
    EnuTable table;
    table.facts.receiver = "primary";
    table.facts.nominal_interval_s = 0.05;
    for (std::int64_t i = 0; i < epochs; ++i) {
        const double turn = static_cast<double>(i) * 1e-4;
        EnuEpoch row;
        row.epoch = i + 1;
        row.time.nanoseconds = i * 50'000'000;
        row.east_m = 2000.0 * std::cos(turn);
        row.north_m = 2000.0 * std::sin(turn);
        row.up_m = 3.0 + std::sin(3.0 * turn);
        row.sigma_east_m = 0.008 + 0.001 * std::sin(turn);
        row.sigma_north_m = 0.009 + 0.001 * std::cos(turn);
        row.sigma_up_m = 0.02 + 0.002 * std::sin(turn);
        row.correlation_east_north = 0.1 * std::sin(turn);
        row.correlation_east_up = 0.2 * std::cos(turn);
        row.correlation_north_up = -0.1 * std::cos(turn);
        row.fix = FixType::fixed;
        row.satellites = std::int16_t{18};
        row.age_s = 0.5;
        row.ratio = 25.1;
        row.source_line = static_cast<std::int32_t>(i + 3);
        row.source_byte = 141 * (i + 3);
        table.rows.push_back(row);
    }
    return table;
}

TrajectoryTable trajectory_table() {
    TrajectoryTable table;
    table.facts.receiver = "primary";
    for (const EnuEpoch& from : enu_table().rows) {
        const double turn = from.time.seconds() * 2e-3;
        TrajectoryEpoch row;
        row.epoch = from.epoch;
        row.time = from.time;
        row.east_m = row.robust_east_m = from.east_m;
        row.north_m = row.robust_north_m = from.north_m;
        row.up_m = from.up_m;
        row.velocity_east_m_s = 60.0 * std::sin(turn);
        row.velocity_north_m_s = 60.0 * std::cos(turn);
        row.velocity_up_m_s = 0.1 * std::sin(turn);
        row.acceleration_east_m_s2 = 0.1 * std::cos(turn);
        row.acceleration_north_m_s2 = -0.1 * std::sin(turn);
        row.acceleration_up_m_s2 = 0.01 * std::sin(turn);
        row.speed_m_s = row.speed_batch_m_s = row.speed_v1_m_s = row.speed_kalman_m_s =
            60.0 + std::sin(turn);
        row.sigma_east_m = row.sigma_north_m = 0.003 + 0.001 * std::sin(turn);
        row.sigma_up_m = 0.007;
        row.sigma_velocity_east_m_s = row.sigma_velocity_north_m_s = row.sigma_speed_m_s =
            0.01 + 0.001 * std::cos(turn);
        row.robust_weight = 0.9;
        row.arc = 1;
        row.usable = true;
        table.rows.push_back(row);
    }
    return table;
}

std::string pos_text() {
    std::string text =
        "%  GPST                   latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   "
        "sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const double turn = static_cast<double>(i) * 1e-4;
        const std::int64_t ms = i * 50;
        text += fmt::format(
            "2026/03/14 {:02}:{:02}:{:02}.{:03} {:14.9f} {:14.9f} {:10.4f}   1  14   0.0040   "
            "0.0030   0.0100   0.0010  -0.0010   0.0020   0.50   25.1\n",
            ms / 3'600'000, ms / 60'000 % 60, ms / 1000 % 60, ms % 1000,
            -31.6 + 0.02 * std::sin(turn), 136.0 + 0.02 * std::cos(turn),
            110.0 + std::sin(3.0 * turn));
    }
    return text;
}

Receiver receiver() {
    Receiver any;
    any.id = "primary";
    any.format = "rtklib-pos";
    return any;
}

/// Runs `call` as often as asked; says how much of such a text it does each second.
template <class Call>
void measure(benchmark::State& state, std::size_t bytes, const Call& call) {
    for (auto _ : state)
        benchmark::DoNotOptimize(call());
    state.counters["MB_per_s"] = benchmark::Counter(
        1e-6 * static_cast<double>(bytes) * static_cast<double>(state.iterations()),
        benchmark::Counter::kIsRate);
}

void read_pos(benchmark::State& state) {
    const std::string text = pos_text();
    measure(state, text.size(),
            [&] { return import_recording(receiver(), {.name = "f", .bytes = text}).rows.size(); });
}

void read_pos_streamed(benchmark::State& state) {  // of which a part is reading it twice
    const std::string text = pos_text();
    measure(state, text.size(), [&] {
        std::int64_t rows = 0;
        find_format("rtklib-pos")
            ->read_streamed(receiver(), {.name = "f", .bytes = text})
            .give([&rows](const Observation&) { ++rows; });
        return rows;
    });
}

void read_ecsv(benchmark::State& state) {
    const std::string text = write_enu(enu_table());
    measure(state, text.size(), [&] { return read_enu(text, "f").rows.size(); });
}

void read_ecsv_streamed(benchmark::State& state) {
    const std::string text = write_enu(enu_table());
    measure(state, text.size(), [&] {
        auto table = open_enu(text, "f");
        std::int64_t rows = 0;
        for (EnuEpoch row; table.rows.next(row);)
            ++rows;
        return rows;
    });
}

void write_ecsv(benchmark::State& state) {
    const EnuTable table = enu_table();
    measure(state, write_enu(table).size(), [&] { return write_enu(table).size(); });
}

void write_ecsv_streamed(benchmark::State& state) {
    const EnuTable table = enu_table();
    measure(state, write_enu(table).size(), [&] {
        std::size_t bytes = 0;
        TableWriter<EnuEpoch> out =
            begin_enu(table, [&bytes](std::string_view piece) { bytes += piece.size(); });
        for (const EnuEpoch& row : table.rows)
            out.write(row);
        out.finish();
        return bytes;
    });
}

void read_wide_ecsv(benchmark::State& state) {
    const std::string text = write_trajectory(trajectory_table());
    measure(state, text.size(), [&] { return read_trajectory(text, "f").rows.size(); });
}

void write_wide_ecsv(benchmark::State& state) {
    const TrajectoryTable table = trajectory_table();
    measure(state, write_trajectory(table).size(), [&] { return write_trajectory(table).size(); });
}

void hash(benchmark::State& state) {
    const std::string text = write_enu(enu_table());
    measure(state, text.size(), [&] { return sha256_hex(text).size(); });
}

void by_memcpy(benchmark::State& state) {
    const std::string text = write_enu(enu_table());
    std::string copy(text.size(), ' ');
    measure(state, text.size(), [&] {
        std::memcpy(copy.data(), text.data(), text.size());
        return copy.back();
    });
}

/// Every number of the table's rows by strtod, and nothing else of it.
void by_strtod(benchmark::State& state) {
    const std::string text = write_enu(enu_table());
    measure(state, text.size(), [&] {
        double sum = 0.0;
        for (const char* at = text.c_str(); *at;) {
            char* end = nullptr;
            const double value = std::strtod(at, &end);
            sum += end == at ? 0.0 : value;
            at = end == at ? at + 1 : end;
        }
        return sum;
    });
}

/// As many bytes as the table has, by snprintf of its eleven decimals in each row.
void by_printf(benchmark::State& state) {
    const EnuTable table = enu_table();
    std::string line(400, ' ');
    std::size_t bytes = 0;
    const auto write_all = [&] {
        bytes = 0;
        for (const EnuEpoch& row : table.rows)
            bytes += static_cast<std::size_t>(std::snprintf(
                line.data(), line.size(),
                "%lld,%.9f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,,,,,,,%s,%d,%.2f,%.1f,%d,"
                "%lld,\n",
                static_cast<long long>(row.epoch), row.time.seconds(), *row.east_m, *row.north_m,
                *row.up_m, *row.sigma_east_m, *row.sigma_north_m, *row.sigma_up_m,
                *row.correlation_east_north, *row.correlation_east_up, *row.correlation_north_up,
                "fixed", *row.satellites, *row.age_s, *row.ratio, *row.source_line,
                static_cast<long long>(*row.source_byte)));
        return bytes;
    };
    measure(state, write_all(), write_all);
}

BENCHMARK(read_pos)->Unit(benchmark::kMillisecond);
BENCHMARK(read_pos_streamed)->Unit(benchmark::kMillisecond);
BENCHMARK(read_ecsv)->Unit(benchmark::kMillisecond);
BENCHMARK(read_ecsv_streamed)->Unit(benchmark::kMillisecond);
BENCHMARK(read_wide_ecsv)->Unit(benchmark::kMillisecond);
BENCHMARK(by_strtod)->Unit(benchmark::kMillisecond);
BENCHMARK(write_ecsv)->Unit(benchmark::kMillisecond);
BENCHMARK(write_ecsv_streamed)->Unit(benchmark::kMillisecond);
BENCHMARK(write_wide_ecsv)->Unit(benchmark::kMillisecond);
BENCHMARK(by_printf)->Unit(benchmark::kMillisecond);
BENCHMARK(hash)->Unit(benchmark::kMillisecond);
BENCHMARK(by_memcpy)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace runcert::RUNCERT_FILE
