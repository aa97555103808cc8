#include <fmt/format.h>

#include "reports/explain/parts.h"
#include "reports/explain/words.h"

namespace runcert {
namespace {

std::string window_complete_words(const Profile& profile) {
    const std::string ends = profile.ends == WindowEnds::any
                                 ? "beginning and ending at any instant"
                                 : "beginning and ending at measured epochs";
    return fmt::format(
        "Every stretch of {}, {}, is looked at. Those that hold a break of the recording or an "
        "epoch that screening left out are passed over. Met where {} left: the fastest {} the "
        "speed. No uncertainty enters.",
        window_words(profile),
        profile.window_kind == WindowKind::course ? "from one line to the other" : ends,
        profile.windows == 1
            ? std::string("one is")
            : fmt::format("{} that do not overlap are", counted(profile.windows, "stretch")),
        profile.windows == 1 ? "gives" : "give");
}

std::string accuracy_words(const ClauseView& view) {
    const Profile& profile = view.of.profile;
    return fmt::format(
        "The expanded uncertainty of the speed is {:.3g} times the combined standard uncertainty "
        "of its budget. What choosing the fastest window may have left in the speed is added. The "
        "factor is the rule's k = {:.3g}, or more where the budget has few degrees "
        "of freedom. Met where it is at most the limit.",
        view.of.verdict.coverage_factor, profile.coverage_factor);
}

std::string margin_clause_words(const Profile& profile) {
    return fmt::format(
        "The required speed is {}; {}. From the speed and its standard uncertainty, the record's "
        "own taken in where it has one, follows the probability that the true speed reaches it. "
        "Met where that is at least {}: this is the decision itself, which `decision` explains.",
        margin_words(profile), rounding_words(profile), level_text(profile.decision_probability));
}

std::string bound_words(Computation computation) {
    const ClauseLimit limit = limit_of(computation);
    if (limit.units.empty()) return {};
    return fmt::format(
        " Met where it is {0} the limit with all of its expanded uncertainty, not met where it is "
        "{1} the limit with all of it. In between the recording does not decide it, and an "
        "official must attest it.",
        limit.at_most ? "at most" : "at least", limit.at_most ? "above" : "below");
}

std::string how(const ClauseView& view) {
    const Profile& profile = view.of.profile;
    const Computation computation = view.requirement.decided_by;
    switch (computation) {
        case Computation::window_complete:
            return window_complete_words(profile);
        case Computation::accuracy:
            return accuracy_words(view);
        case Computation::margin:
            return margin_clause_words(profile);
        default:
            break;
    }
    std::string words(words_of(computation));
    words += bound_words(computation);
    if (computation == Computation::opposite_runs && profile.opposite_runs_within_s)
        words += fmt::format(" Met where both lie within {}.",
                             number_text(*profile.opposite_runs_within_s, "s"));
    return words;
}

}  // namespace

std::string computation_words(const ClauseView& view) {
    const Computation computation = view.requirement.decided_by;
    if (computation == Computation::attest) return std::string(words_of(computation));
    return fmt::format("{}. {}", to_text(computation), how(view));
}

}  // namespace runcert
