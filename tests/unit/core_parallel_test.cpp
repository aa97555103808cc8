#include <gtest/gtest.h>
#include <sched.h>

#include <chrono>
#include <cstdlib>
#include <numeric>
#include <stdexcept>
#include <string>

#include "core/parallel.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// The environment's RUNCERT_THREADS for the time of a test.
class Threads {
  public:
    explicit Threads(const char* said) { setenv("RUNCERT_THREADS", said, 1); }
    ~Threads() { unsetenv("RUNCERT_THREADS"); }
};

TEST(Parallel, ResultsStandInTheOrderOfTheRunsWithAnyNumberOfThreads) {
    std::vector<std::int64_t> squares(1000);
    std::iota(squares.begin(), squares.end(), 0);
    for (std::int64_t& i : squares)
        i *= i;
    for (const unsigned threads : {0U, 1U, 2U, 7U})
        EXPECT_EQ(results_of(1000, threads, [](std::int64_t i) { return i * i; }), squares);
    EXPECT_TRUE(results_of(0, 2, [](std::int64_t i) { return i; }).empty());
}

TEST(Parallel, AnExceptionOfARunIsThrownAgainAndLaterRunsAreNotBegun) {
    std::atomic<std::int64_t> begun = 0;
    const auto run = [&](std::int64_t i) {
        ++begun;
        if (i == 3) throw std::runtime_error("run 3");
    };
    EXPECT_THROW(for_each_run(1'000'000, 2, run), std::runtime_error);
    EXPECT_LT(begun, 1'000'000);
}

TEST(Parallel, OfSeveralExceptionsThatOfTheLowestNumberIsThrown) {
    for (int times = 0; times < 20; ++times) {
        std::atomic<bool> second_failed = false;
        try {
            for_each_run(2, 2, [&](std::int64_t i) {
                if (i == 0)
                    for (int waits = 0; waits < 1000 && !second_failed; ++waits)
                        std::this_thread::sleep_for(std::chrono::milliseconds(1));
                second_failed = i == 1;
                throw std::runtime_error(std::to_string(i));
            });
            FAIL();
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "0");
        }
    }
}

TEST(Parallel, TasksAreAllDoneOnOneThreadOrMore) {
    for (const char* const threads : {"1", "2", "64"}) {
        const Threads said(threads);
        int first = 0;
        int second = 0;
        int third = 0;
        do_together([&] { first = 1; }, [&] { second = 2; }, [&] { third = 3; });
        EXPECT_EQ(first + second + third, 6);
    }
}

TEST(Parallel, RunsWithinRunsHaveNoMoreThreadsThanAllowed) {
    for (const unsigned allowed : {1U, 2U, 3U}) {
        const Threads said(std::to_string(allowed).c_str());
        std::atomic<unsigned> at_work = 0, most = 0;
        const auto task = [&] {
            for (int parts = 0; parts < 20; ++parts)
                for_each_run(4, threads_allowed(), [&](std::int64_t) {
                    const unsigned now = ++at_work;
                    for (unsigned seen = most; seen < now && !most.compare_exchange_weak(seen, now);)
                        ;
                    std::this_thread::sleep_for(std::chrono::microseconds(200));
                    --at_work;
                });
        };
        do_together(task, task, task);
        EXPECT_LE(most, allowed);
        EXPECT_GE(most, 1U);
    }
}

TEST(Parallel, OnlyProcessorsThatTheProcessMayRunOnAreCounted) {
    unsetenv("RUNCERT_THREADS");
    cpu_set_t all, one;
    ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
    int first = 0;
    while (!CPU_ISSET(first, &all))
        ++first;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(threads_allowed(), 1U);
    ASSERT_EQ(sched_setaffinity(0, sizeof all, &all), 0);
    EXPECT_EQ(threads_allowed(), static_cast<unsigned>(CPU_COUNT(&all)));
}

TEST(Parallel, TheEnvironmentSaysHowManyThreadsAndNonsenseIsNotHeard) {
    unsetenv("RUNCERT_THREADS");
    const unsigned processors = threads_allowed();
    for (const char* const nonsense : {"", "0", "-1", "two", "3 ", "99999999999"})
        EXPECT_EQ((Threads(nonsense), threads_allowed()), processors) << nonsense;
    EXPECT_EQ((Threads("3"), threads_allowed()), 3U);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
