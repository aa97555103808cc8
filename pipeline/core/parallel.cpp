#include "core/parallel.h"

#include <charconv>
#include <cstdlib>
#include <string_view>

namespace runcert {

unsigned threads_allowed() {
    if (const char* const said = std::getenv("RUNCERT_THREADS")) {
        const std::string_view text(said);
        unsigned threads = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
        if (error == std::errc{} && end == text.data() + text.size() && threads >= 1 &&
            threads <= 1024)
            return threads;
    }
    return std::max(1U, std::thread::hardware_concurrency());
}

}  // namespace runcert
