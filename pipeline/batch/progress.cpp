#include "batch/progress.h"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include "batch/progress_styles.h"

namespace runcert {
namespace {

bool terminal_is_dumb() {
    const char* type = std::getenv("TERM");
    return type == nullptr || *type == '\0' || std::string_view(type) == "dumb";
}

}  // namespace

std::unique_ptr<Progress> make_progress(const ProgressOptions& options) {
    switch (options.style) {
        case ProgressStyle::json:
            return make_json_progress(options);
        case ProgressStyle::terminal:
            if (!terminal_is_dumb()) return make_terminal_progress(options);
            break;
        case ProgressStyle::plain:
        case ProgressStyle::quiet:
            break;
    }
    return make_plain_progress(options);
}

ProgressStyle progress_style_for(std::FILE* to) {
    return isatty(fileno(to)) != 0 ? ProgressStyle::terminal : ProgressStyle::plain;
}

}  // namespace runcert
