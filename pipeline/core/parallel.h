#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace runcert {

/// How many threads this process may use: the environment variable RUNCERT_THREADS (1 to 1024).
/// Without a valid value, the number of processors that it may run on. No result depends on it.
unsigned threads_allowed();

/// A thread of this process beside its first, for as long as this lives.
class FurtherThread {
  public:
    /// Whether the process had fewer than `threads` threads at work, so that there may be one more.
    explicit FurtherThread(unsigned threads);
    FurtherThread(FurtherThread&& other) noexcept : taken_(std::exchange(other.taken_, false)) {}
    ~FurtherThread();
    explicit operator bool() const { return taken_; }

  private:
    bool taken_ = false;
};

/// Calls run(0) to run(runs - 1) on `threads` threads (0: `threads_allowed()`). Within a run of
/// another such call, the threads of both together are no more than `threads`. After a run throws,
/// no further runs start. If several throw, the exception of the lowest-numbered run is rethrown
/// here, whichever came first in time.
template <class Run>
void for_each_run(std::int64_t runs, unsigned threads, const Run& run) {
    std::atomic<std::int64_t> next = 0;
    std::exception_ptr failure;
    std::int64_t failed = runs;
    std::mutex failing;
    const auto work = [&] {
        for (std::int64_t i = next++; i < runs; i = next++) {
            try {
                run(i);
            } catch (...) {
                const std::lock_guard lock(failing);
                if (i < failed) {
                    failed = i;
                    failure = std::current_exception();
                }
                next = runs;
            }
        }
    };
    std::vector<std::jthread> others;
    if (threads == 0) threads = threads_allowed();
    for (std::int64_t i = 1; i < runs; ++i) {
        FurtherThread one(threads);
        if (!one) break;
        others.emplace_back([&work, taken = std::move(one)] { work(); });
    }
    work();
    others.clear();
    if (failure) std::rethrow_exception(failure);
}

/// The results of run(0) to run(runs - 1), in this order, on `threads` threads. A run may depend
/// only on its number, so that the results are the same with any number of threads.
template <class Run>
auto results_of(std::int64_t runs, unsigned threads, const Run& run) {
    std::vector<decltype(run(std::int64_t{}))> results(static_cast<std::size_t>(runs));
    for_each_run(runs, threads,
                 [&](std::int64_t i) { results[static_cast<std::size_t>(i)] = run(i); });
    return results;
}

/// Runs independent tasks, in parallel where more than one thread is allowed. Exceptions as for
/// `for_each_run`.
template <class... Task>
void do_together(const Task&... task) {
    const std::array<std::function<void()>, sizeof...(Task)> tasks{std::cref(task)...};
    for_each_run(std::ssize(tasks), threads_allowed(),
                 [&](std::int64_t i) { tasks[static_cast<std::size_t>(i)](); });
}

/// Makes the runs of `for_each_run` do part of their work one after the other, in order of their
/// numbers from 0, whatever thread they are on. What they take from a common stream, such as one of
/// random numbers, is then the same with any number of threads.
class Turnstile {
  public:
    /// Calls `part` once all lower-numbered runs have done theirs, and returns its result. Every
    /// run must call this, and before doing anything that can fail.
    template <class Part>
    auto pass(std::int64_t run, const Part& part) {
        std::unique_lock lock(passing_);
        passed_.wait(lock, [&] { return next_ == run; });
        const LetOn let_on{*this};  // also if `part` throws
        return part();
    }

  private:
    struct LetOn {
        Turnstile& turnstile;
        ~LetOn() {
            ++turnstile.next_;
            turnstile.passed_.notify_all();
        }
    };

    std::mutex passing_;
    std::condition_variable passed_;
    std::int64_t next_ = 0;
};

}  // namespace runcert
