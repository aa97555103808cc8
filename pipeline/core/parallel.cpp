#include "core/parallel.h"

#include <sched.h>

#include <charconv>
#include <cstdlib>
#include <string_view>

namespace runcert {
namespace {

std::atomic<unsigned> further_threads = 0;

}  // namespace

unsigned threads_allowed() {
    if (const char* const said = std::getenv("RUNCERT_THREADS")) {
        const std::string_view text(said);
        unsigned threads = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
        if (error == std::errc{} && end == text.data() + text.size() && threads >= 1 &&
            threads <= 1024)
            return threads;
    }
    cpu_set_t processors;
    if (sched_getaffinity(0, sizeof processors, &processors) == 0)
        return std::max(1U, static_cast<unsigned>(CPU_COUNT(&processors)));
    return std::max(1U, std::thread::hardware_concurrency());
}

FurtherThread::FurtherThread(unsigned threads) {
    taken_ = further_threads.fetch_add(1) + 1 < threads;
    if (!taken_) --further_threads;
}

FurtherThread::~FurtherThread() {
    if (taken_) --further_threads;
}

}  // namespace runcert
