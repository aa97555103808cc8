#include "stages/check/against_limit.h"

#include <fmt/format.h>

#include "reports/words/figures.h"

namespace runcert {
namespace {

std::string words_of(const Compared& figure, const std::string& unit) {
    return fmt::format("{} {}", figure.name,
                       quantity_text(figure.value, figure.expanded_uncertainty, unit));
}

}  // namespace

Finding against_limit(const Compared& figure, const Clause& clause) {
    const bool at_most = limit_of(clause.decided_by).at_most;
    const double limit = clause.limit.value();
    const double reach = figure.expanded_uncertainty.value_or(0.0);
    const double sign = at_most ? 1.0 : -1.0;
    const double worst = sign * figure.value + reach;
    const double best = sign * figure.value - reach;
    const RequirementStatus status = worst <= sign * limit ? RequirementStatus::met
                                     : best > sign * limit ? RequirementStatus::not_met
                                                           : RequirementStatus::attest;
    std::string evidence = fmt::format(
        "{}, {} {}{}", words_of(figure, clause.unit), at_most ? "at most" : "at least",
        quantity_text(limit, std::nullopt, clause.unit),
        status == RequirementStatus::attest
            ? ": the limit lies within the uncertainty, not decidable from the recording"
            : "");
    if (!figure.note.empty()) evidence += "; " + figure.note;
    return {status,
            std::move(evidence),
            {{.name = figure.name,
              .value = figure.value,
              .unit = clause.unit,
              .expanded_uncertainty = figure.expanded_uncertainty,
              .note = figure.note}}};
}

Finding unknown(std::string why) {
    return {RequirementStatus::attest, "not decidable from the recording: " + std::move(why)};
}

}  // namespace runcert
