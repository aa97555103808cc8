#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace runcert {

/// Lets the runs of `for_each_run` do a part of their work one after the other, in the order of
/// their numbers from 0 on, whatever thread they are on: what they take from a common stream, such
/// as one of random numbers, is then the same with any number of threads.
class Turnstile {
  public:
    /// Does `part` after all runs with a lower number have done theirs, and returns its result.
    /// Every run must come by here, before it does anything that can fail.
    template <class Part>
    auto pass(std::int64_t run, const Part& part) {
        std::unique_lock lock(passing_);
        passed_.wait(lock, [&] { return next_ == run; });
        const LetOn let_on{*this};  // also if the part fails
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
