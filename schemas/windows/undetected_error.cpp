#include "schemas/windows/undetected_error.h"

#include <fmt/format.h>

#include "core/figures.h"

namespace runcert {

std::string tested_error_text(Hypothesis hypothesis) {
    switch (hypothesis) {
        case Hypothesis::outlier:
            return "outlier of one epoch";
        case Hypothesis::burst:
            return "outlier of several epochs";
        case Hypothesis::step:
            return "step of the positions";
        case Hypothesis::ramp:
            return "drift of the positions";
        default:
            return std::string(words_of(hypothesis));
    }
}

std::string where_text(const UndetectedError& error) {
    if (error.epoch != error.last_epoch)
        return fmt::format("at epochs {} to {}", error.epoch, error.last_epoch);
    switch (error.hypothesis) {
        case Hypothesis::outlier:
        case Hypothesis::burst:
            return fmt::format("at epoch {}", error.epoch);
        case Hypothesis::ramp:
            return fmt::format("from epoch {} on", error.epoch);
        default:
            return fmt::format("before epoch {}", error.epoch);
    }
}

std::string size_text(const UndetectedError& error) {
    return fmt::format("{} {}", significant_text(error.size, 2),
                       error.unit == "m / s" ? "m/s" : error.unit);
}

bool is_harmless(const UndetectedError& error) {
    return !(error.speed_m_s > 0.0);
}

bool is_unlimited(const UndetectedError& error) {
    constexpr double without_limit = 1e6;  // stands in the file for one without limit
    return error.size >= without_limit || error.speed_m_s >= without_limit;
}

}  // namespace runcert
