#include "reports/words/recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace runcert {

std::string processing_text(const Processing& processing) {
    std::string text = "solved";
    if (!processing.program.empty()) text += " by " + processing.program;
    if (!processing.files.empty())
        text += fmt::format(" from {}", fmt::join(processing.files, ", "));
    return text + ", as the recording's header says";
}

}  // namespace runcert
