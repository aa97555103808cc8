#include "schemas/screened/witness_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

#include "core/prose.h"
#include "core/rounding.h"
#include "core/text.h"

namespace runcert {

std::string delay_words(double delay_s) {
    return fmt::format("{:.3g} s {}", std::abs(delay_s), delay_s < 0.0 ? "ahead of" : "behind");
}

std::string other_moments_text(const VelocityComparison& velocity) {
    constexpr std::size_t named = 3;
    std::vector<std::string> stretches;
    std::size_t beyond = 0;
    for (const VelocityDelay& one : velocity.delays) {
        if (!one.beyond || ++beyond > named) continue;
        stretches.push_back(fmt::format(
            "over epochs {} to {} they are {} the positions (the speeds differ by {} m/s, at that "
            "delay by {} m/s)",
            one.first_epoch, one.last_epoch, delay_words(one.delay_s),
            format_fixed(one.difference_within_m_s, 2), format_fixed(one.difference_m_s, 2)));
    }
    if (beyond > named) stretches.push_back(fmt::format("so over {} more", beyond - named));
    return fmt::format("{}", fmt::join(stretches, ", "));
}

std::string unfit_text(const VelocityComparison& velocity) {
    if (!velocity.unfit) return {};
    return fmt::format("they contradict the positions at {:.3g} % of the epochs",
                       100.0 * velocity.contradicted_share);
}

std::string displacement_comparison_text(const DisplacementComparison& comparison) {
    const std::string name =
        comparison.receiver.empty()
            ? capitalised(words_of(comparison.kind))
            : fmt::format("Displacements by receiver “{}”", comparison.receiver);
    if (comparison.spreads.empty())
        return name + ": too few spans have both to compare the displacements";
    const VelocitySpread& spread = comparison.spreads.front();
    return fmt::format("{}: over {:g} s they differ by {} m per axis ({}) and contradict {}", name,
                       spread.span_s, format_fixed(spread.sd_m, 3), counted(spread.spans, "span"),
                       counted(comparison.rejected, "epoch"));
}

}  // namespace runcert
