#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <thread>
#include <vector>

#include "core/random.h"
#include "make/memory_budget.h"
#include "simulation/recording_text.h"
#include "store/atomic_file.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace std::chrono_literals;

/// A run that asks to be let in, in a thread of its own.
class Asking {
  public:
    Asking(MemoryBudget& budget, std::uint64_t bytes, const std::stop_token& stop = {})
        : answer_(std::async(std::launch::async,
                             [&budget, bytes, stop] { return budget.acquire(bytes, stop); })) {}
    bool waits() const { return answer_.wait_for(30ms) == std::future_status::timeout; }
    bool answer() { return answer_.get(); }

  private:
    std::future<bool> answer_;
};

TEST(MemoryBudget, LetsInWhatFitsTogether) {
    MemoryBudget budget(100);
    EXPECT_TRUE(budget.acquire(60, {}));
    EXPECT_TRUE(budget.acquire(40, {}));
    Asking third(budget, 1);
    EXPECT_TRUE(third.waits());
    budget.release(40);
    EXPECT_TRUE(third.answer());
}

TEST(MemoryBudget, ARunBeyondItRunsAlone) {
    MemoryBudget budget(100);
    EXPECT_TRUE(budget.acquire(10, {}));
    Asking large(budget, 1000);
    EXPECT_TRUE(large.waits());
    budget.release(10);
    EXPECT_TRUE(large.answer());
    Asking small(budget, 1);
    EXPECT_TRUE(small.waits());
    budget.release(1000);
    EXPECT_TRUE(small.answer());
}

TEST(MemoryBudget, ALargeRunIsNotPassedBySmallOnes) {
    MemoryBudget budget(100);
    EXPECT_TRUE(budget.acquire(50, {}));
    Asking large(budget, 80);
    EXPECT_TRUE(large.waits());
    Asking small(budget, 10);
    EXPECT_TRUE(small.waits());
    budget.release(50);
    EXPECT_TRUE(large.answer());
    EXPECT_TRUE(small.answer());
}

TEST(MemoryBudget, AStopEndsTheWaitAndLetsOthersPass) {
    MemoryBudget budget(100);
    EXPECT_TRUE(budget.acquire(50, {}));
    std::stop_source stop;
    Asking large(budget, 80, stop.get_token());
    EXPECT_TRUE(large.waits());
    Asking small(budget, 10);
    EXPECT_TRUE(small.waits());
    stop.request_stop();
    EXPECT_FALSE(large.answer());
    EXPECT_TRUE(small.answer());
}

TEST(MemoryBudget, NeverExceedsItUnlessAlone) {
    constexpr std::uint64_t bytes = 100;
    MemoryBudget budget(bytes);
    std::mutex mutex;
    std::uint64_t used = 0, let_in = 0;
    int running = 0, most = 0, beyond = 0;
    const auto run = [&](std::uint64_t seed) {
        RandomGenerator random(seed);
        for (int i = 0; i < 300; ++i) {
            const auto need = static_cast<std::uint64_t>(1.0 + 120.0 * random.uniform());
            ASSERT_TRUE(budget.acquire(need, {}));
            {
                const std::scoped_lock lock(mutex);
                used += need;
                most = std::max(most, ++running);
                ++let_in;
                if (used > bytes && running > 1) ++beyond;
            }
            std::this_thread::yield();
            {
                const std::scoped_lock lock(mutex);
                used -= need;
                --running;
            }
            budget.release(need);
        }
    };
    {
        std::vector<std::jthread> threads;
        for (std::uint64_t seed = 1; seed <= 8; ++seed)
            threads.emplace_back(run, seed);
    }
    EXPECT_EQ(let_in, 8U * 300U);
    EXPECT_EQ(beyond, 0);
    EXPECT_GT(most, 1) << "nothing ran side by side";
}

TEST(ExpectedMemory, IsAboveWhatWasMeasuredAndNotFarAbove) {
    struct Measured {
        std::uint64_t epochs;
        double mebibytes;
    };
    // The largest process of each run, pages included, from the table of `expected_memory`.
    for (const Measured& run : {Measured{451, 116}, Measured{3000, 117}, Measured{28'200, 377},
                                Measured{28'200, 293}, Measured{100'000, 878}}) {
        const double expected = static_cast<double>(expected_memory(run.epochs)) / (1 << 20);
        EXPECT_GT(expected, run.mebibytes) << run.epochs;
        EXPECT_LT(expected, 2.5 * run.mebibytes) << run.epochs;
    }
}

TEST(AvailableMemory, IsPartOfWhatTheComputerHas) {
    std::ifstream info("/proc/meminfo");
    std::string key;
    std::uint64_t total_kibibytes = 0;
    info >> key >> total_kibibytes;
    ASSERT_EQ(key, "MemTotal:");
    EXPECT_GT(available_memory(), 0U);
    EXPECT_LT(available_memory(), total_kibibytes * 1024 / 5 * 4);
}

SimulationSpec simulation() {
    SimulationSpec spec;
    spec.run.duration_s = 29.9;  // 300 epochs
    spec.place =
        Geodetic{.latitude = Angle::from_degrees(-31.6), .longitude = Angle::from_degrees(136.0)};
    spec.start_gps = parse_gps_iso("2026-03-14T03:20:18.000");
    return spec;
}

TEST(EstimatedEpochs, AreTheLinesOfATableAndAFewMore) {
    const SimulationSpec spec = simulation();
    const auto epochs = simulate(spec);
    for (const std::string& text : {rtklib_pos_text(spec, epochs), plane_csv_text(spec, epochs)}) {
        EXPECT_GE(estimated_epochs(text), 300U);
        EXPECT_LE(estimated_epochs(text), 320U);
    }
}

TEST(EstimatedEpochs, AreCountedByWhatMarksThem) {
    std::string nmea, ubx("\xb5\x62\x0a\x04", 4), gpx = "<gpx>";
    for (int i = 0; i < 50; ++i) {
        nmea += "$GNGGA,1*00\r\n$GNGST,1*00\r\n$GPGSV,1*00\r\n$GPGSV,2*00\r\n$GNRMC,1*00\r\n";
        ubx.append("\xb5\x62\x01\x07", 4).append(96, '\0');
        ubx.append("\xb5\x62\x02\x15", 4).append(900, '\1');
        gpx += "<trkpt lat=\"1\" lon=\"2\"/>";
    }
    EXPECT_EQ(estimated_epochs(nmea), 50U);
    EXPECT_EQ(estimated_epochs(ubx), 50U);
    EXPECT_EQ(estimated_epochs(gpx), 51U);
    EXPECT_EQ(estimated_epochs(std::string(64 + 32 * 50, '\0')), 53U);
    EXPECT_EQ(estimated_epochs(""), 1U);
}

// How many epochs `runcert inspect` finds in real recordings.
TEST(EstimatedEpochs, AreNotFarFromThoseOfRealRecordings) {
    const char* data = std::getenv("RUNCERT_DATA");
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    struct Known {
        const char* file;
        std::uint64_t epochs;
    };
    for (const Known& known :
         {Known{"ubx_walk/rover.ubx", 536}, Known{"race_car_vbo/run_a.vbo", 5675},
          Known{"nmea_gst/static_skytraq.nmea", 96},
          Known{"windsurf_loggers/head_left.oao", 56'055},
          Known{"speed_skydive/flysight2_track.csv", 16'022}}) {
        const auto estimated =
            estimated_epochs(read_file(std::filesystem::path(data) / known.file));
        EXPECT_GE(estimated, known.epochs) << known.file;
        EXPECT_LE(estimated, 2 * known.epochs) << known.file;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
