#include <benchmark/benchmark.h>

#include <chrono>

#include "core/failure.h"
#include "store/atomic_file.h"
#include "store/process.h"

// The report of a run of 28,200 epochs: report.json, the page, and the PDF, run in turns with
// WeasyPrint alone on the same page: the counter `weasyprints` is how many of those all of it
// costs.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

const fs::path programs = RUNCERT_PROGRAMS;

double seconds_of(const std::vector<std::string>& command) {
    const auto start = std::chrono::steady_clock::now();
    const ProcessResult result = run_process(command);
    if (result.exit_status > 1)
        throw Failure(command.front(), "it failed: " + result.errors, "Run it by hand");
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A run of 1,410 s at 20 Hz, certified but for its report.
class CertifiedRun {
  public:
    CertifiedRun() {
        write_file_atomically(
            folder_.path() / "spec.yaml",
            "schema: simulation/1.0\n"
            "run: {top_speed_m_s: 64.5, start_speed_m_s: 0.1, half_speed_time_s: 400, duration_s: "
            "1409.95, rate_hz: 20, bearing_deg: 160}\n"
            "place: {latitude_deg: -31.6, longitude_deg: 136.0, height_m: 110.0}\n"
            "start_gps: \"2026-03-14T03:20:18.000\"\nseed: 1\n"
            "white_noise: {horizontal_m: 0.003, vertical_m: 0.006}\n"
            "attempt: {id: long-run, craft: {name: land yacht, class: land-yacht}, record: {speed: "
            "222.43, unit: km/h, source: made up}, profiles: [nalsa, fisly]}\n");
        const std::string recorded = (folder_.path() / "recorded").string();
        seconds_of({(programs / "runcert").string(), "simulate",
                    (folder_.path() / "spec.yaml").string(), "--out", recorded});
        seconds_of({(programs / "runcert").string(), "certify", recorded + "/attempt.yaml", "--out",
                    run().string(), "--no-render"});
    }
    fs::path run() const { return folder_.path() / "run"; }
    double report(std::vector<std::string> more) const {
        more.insert(more.begin(), {(programs / "runcert-report").string(), "--attempt",
                                   (run() / "attempt.yaml").string(), "--run-dir", run().string()});
        return seconds_of(more);
    }

  private:
    TemporaryFolder folder_;
};

void Report(benchmark::State& state) {
    const CertifiedRun certified;
    double json = 0.0, page = 0.0, all = 0.0, alone = 0.0;
    for (auto _ : state) {
        json += certified.report({"--no-render"});
        page += certified.report({"--page", "report.html"});
        const double seconds = certified.report({});
        state.SetIterationTime(seconds);
        all += seconds;
        alone += seconds_of({"weasyprint", "--quiet", (certified.run() / "report.html").string(),
                             (certified.run() / "alone.pdf").string()});
    }
    const auto mean = [](double seconds) {
        return benchmark::Counter(seconds, benchmark::Counter::kAvgIterations);
    };
    state.counters["json_s"] = mean(json);
    state.counters["page_s"] = mean(page);
    state.counters["weasyprints"] = all / alone;
}
BENCHMARK(Report)->UseManualTime()->Unit(benchmark::kSecond)->Iterations(5);

}  // namespace
}  // namespace runcert::RUNCERT_FILE
