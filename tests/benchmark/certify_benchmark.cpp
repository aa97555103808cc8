#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "core/failure.h"
#include "core/random.h"
#include "motion/chain.h"
#include "simulated_arc.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "witness/arcs.h"

// `runcert certify --no-render` of what people hand in: a race car's VBO at 25 Hz and a skydiver's
// logger (of RUNCERT_DATA), each joined to itself, times going on, to 31,500 epochs. Run in turns
// with the same recording whose stamps come uneven by some milliseconds, as many loggers write them
// (`uneven_times`: how much longer that takes), and with one pass of filter and smoother over as
// many epochs (`passes`: how many of those it costs).

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t epochs = 31'500;
constexpr std::int64_t day_ms = 86'400'000;

double seconds_of(const auto& run) {
    const auto start = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A recording of one row an epoch; the time of day stands `place` bytes into a row, with `between`
/// between its parts and decimals up to `end`.
struct Form {
    const char* file;
    const char* last_line_of_head;
    std::size_t place;
    const char* between;
    char end;
    const char* receiver;
    const char* craft;
    const char* profile;

    std::size_t end_of_time(const std::string& row) const { return row.find(end, place); }

    std::int64_t time_ms(const std::string& row) const {
        const std::size_t apart = 2 + std::string_view(between).size();
        const auto part = [&](std::size_t i) {
            return std::stoll(row.substr(place + i * apart, 2));
        };
        const std::size_t seconds = place + 2 * apart;
        const double s = std::stod(row.substr(seconds, end_of_time(row) - seconds));
        return (part(0) * 60 + part(1)) * 60'000 + std::llround(1000.0 * s);
    }

    std::string with_time(const std::string& row, std::int64_t ms) const {
        if (ms < 0 || ms >= day_ms)
            throw Failure(file, "joined to itself it goes past midnight", "Join fewer epochs");
        return row.substr(0, place) +
               fmt::format("{:02}{}{:02}{}{:02}.{:03}", ms / 3'600'000, between, ms / 60'000 % 60,
                           between, ms / 1000 % 60, ms % 1000) +
               row.substr(end_of_time(row));
    }
};

constexpr Form race_car{.file = "race_car_vbo/run_a.vbo",
                        .last_line_of_head = "[data]",
                        .place = 4,
                        .between = "",
                        .end = ' ',
                        .receiver =
                            "solution: single, accuracy: {horizontal_m: 1.0, vertical_m: "
                            "2.0, velocity_mps: 0.1}",
                        .craft = "car",
                        .profile = "gps-speed-sailing-10s"};
constexpr Form skydiver{.file = "speed_skydive/flysight1_good.csv",
                        .last_line_of_head = ",(deg)",
                        .place = 11,
                        .between = ":",
                        .end = 'Z',
                        .receiver = "name: logger",
                        .craft = "skydiver",
                        .profile = "fai-speed-skydiving-2026"};

/// The recording joined to itself; its stamps up to `uneven_ms` off the even ones.
std::string joined(const std::string& recorded, const Form& form, std::int64_t uneven_ms) {
    std::string text;
    std::vector<std::string> rows;
    bool in_head = true;
    std::istringstream lines(recorded);
    for (std::string line; std::getline(lines, line);) {
        if (in_head)
            text += line + "\n";
        else if (line.size() > form.place)
            rows.push_back(line);
        in_head = in_head && !line.starts_with(form.last_line_of_head);
    }
    const std::int64_t first = form.time_ms(rows.front());
    const std::int64_t interval =
        form.time_ms(rows[rows.size() / 2 + 1]) - form.time_ms(rows[rows.size() / 2]);
    const std::int64_t length = form.time_ms(rows.back()) - first + interval;
    RandomGenerator random(3);
    for (std::size_t k = 0; k < epochs; ++k) {
        const std::string& row = rows[k % rows.size()];
        const auto round = static_cast<std::int64_t>(k / rows.size());
        const auto off =
            std::llround((2.0 * random.uniform() - 1.0) * static_cast<double>(uneven_ms));
        text += form.with_time(row, form.time_ms(row) + round * length + off) + "\n";
    }
    return text;
}

void certify(const fs::path& folder) {
    const ProcessResult result = run_process({(fs::path(RUNCERT_PROGRAMS) / "runcert").string(),
                                              "certify", (folder / "attempt.yaml").string(),
                                              "--out", (folder / "run").string(), "--no-render"});
    if (result.exit_status > 1)
        throw Failure(folder.string(), "it failed: " + result.errors, "Run it by hand");
    fs::remove_all(folder / "run");
}

void write_attempt(const fs::path& folder, const Form& form, const std::string& recording) {
    fs::create_directories(folder);
    const std::string name = fs::path(form.file).filename().string();
    write_file_atomically(folder / name, recording);
    write_file_atomically(
        folder / "attempt.yaml",
        fmt::format("schema: attempt/1.0\nid: long\ncraft: {{name: x, class: {}}}\nreceivers:\n"
                    "  - {{id: primary, recording: {}, {}}}\n"
                    "record: {{speed: 10, unit: km/h, source: none}}\nprofiles: [{}]\n",
                    form.craft, name, form.receiver, form.profile));
}

void Certify(benchmark::State& state, const Form& form) {
    const char* data = std::getenv("RUNCERT_DATA");
    if (!data) return state.SkipWithError("RUNCERT_DATA is not set");
    const TemporaryFolder folder;
    const std::string recorded = read_file(fs::path(data) / form.file);
    constexpr std::int64_t uneven_ms = 6;
    write_attempt(folder.path() / "even", form, joined(recorded, form, 0));
    write_attempt(folder.path() / "uneven", form, joined(recorded, form, uneven_ms));
    StudyRun run;
    run.length_s = static_cast<double>(epochs - 1) / run.rate_hz;
    run.return_time_s = 10.0;
    run.shuttle = true;
    const auto arcs = arcs_of<2>(simulate_recording(run, 1).screened);
    double even = 0.0, uneven = 0.0, pass = 0.0;
    for (auto _ : state) {
        const double seconds = seconds_of([&] { certify(folder.path() / "even"); });
        state.SetIterationTime(seconds);
        even += seconds;
        uneven += seconds_of([&] { certify(folder.path() / "uneven"); });
        pass += seconds_of(
            [&] { benchmark::DoNotOptimize(Chain<2>(arcs.front().epochs, EstimationModel{})); });
    }
    state.counters["uneven_times"] = uneven / even;
    state.counters["passes"] = even / pass;
}
BENCHMARK_CAPTURE(Certify, race_car, race_car)
    ->UseManualTime()
    ->Unit(benchmark::kSecond)
    ->Iterations(5);
BENCHMARK_CAPTURE(Certify, skydiver, skydiver)
    ->UseManualTime()
    ->Unit(benchmark::kSecond)
    ->Iterations(5);

}  // namespace
}  // namespace runcert::RUNCERT_FILE
