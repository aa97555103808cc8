#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace runcert {

/// The results of run(0) to run(runs - 1), in this order, by so many threads (0: as many as the
/// machine has). A run may depend on its number alone, so that the results are the same with any
/// number of threads. The first exception of a run is thrown again here.
template <class Run>
auto results_of(std::int64_t runs, unsigned threads, const Run& run) {
    std::vector<decltype(run(std::int64_t{}))> results(static_cast<std::size_t>(runs));
    std::atomic<std::int64_t> next = 0;
    std::exception_ptr failure;
    std::mutex failing;
    const auto work = [&] {
        for (std::int64_t i = next++; i < runs; i = next++) {
            try {
                results[static_cast<std::size_t>(i)] = run(i);
            } catch (...) {
                const std::lock_guard lock(failing);
                if (!failure) failure = std::current_exception();
                next = runs;
            }
        }
    };
    std::vector<std::jthread> others;
    const unsigned wanted =
        threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
    for (unsigned i = 1; i < wanted; ++i)
        others.emplace_back(work);
    work();
    others.clear();
    if (failure) std::rethrow_exception(failure);
    return results;
}

}  // namespace runcert
