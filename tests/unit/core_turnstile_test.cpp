#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "core/parallel.h"

namespace runcert::RUNCERT_FILE {
namespace {

TEST(Turnstile, RunsPassInTheOrderOfTheirNumbersWithAnyNumberOfThreads) {
    for (const unsigned threads : {1U, 2U, 7U}) {
        Turnstile turnstile;
        std::int64_t drawn = 0;  // a common stream
        const auto numbers = results_of(500, threads, [&](std::int64_t i) {
            return turnstile.pass(i, [&] { return drawn++; });
        });
        for (std::size_t i = 0; i < numbers.size(); ++i)
            ASSERT_EQ(numbers[i], static_cast<std::int64_t>(i)) << threads;
    }
}

TEST(Turnstile, APartThatFailsLetsTheOthersOn) {
    for (const unsigned threads : {1U, 2U, 4U}) {
        Turnstile turnstile;
        EXPECT_THROW(for_each_run(100, threads,
                                  [&](std::int64_t i) {
                                      turnstile.pass(i, [&] {
                                          if (i == 50) throw std::runtime_error("50");
                                          return 0;
                                      });
                                  }),
                     std::runtime_error);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
