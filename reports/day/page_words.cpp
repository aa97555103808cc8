#include "reports/day/page_words.h"

#include <fmt/format.h>

#include "core/prose.h"
#include "core/text.h"

namespace runcert {

OutcomeState state_of(const DayResult& result) {
    return {.outcome = result.outcome,
            .standing = result.standing,
            .record_named = result.required_speed_m_s.has_value(),
            .rule_altered = !result.replaced.empty() || result.rule_origin != RuleOrigin::built_in};
}

std::string window_words(const DayResult& result) {
    if (!result.start_utc.empty()) {
        std::string text = result.start_utc;
        if (const std::size_t t = text.find('T'); t != std::string::npos) text[t] = ' ';
        if (text.ends_with('Z')) text.pop_back();
        return text + " UTC";
    }
    if (!result.start_time_s) return {};
    return format_fixed(*result.start_time_s, 3) + " s after the first epoch";
}

std::string told_apart_words(const DayPlace& place, std::optional<std::int64_t> above,
                             std::optional<std::int64_t> below) {
    const auto& up = place.tied_up_to_rank;
    const auto& down = place.tied_down_to_rank;
    if (!up && !down) return {};
    const auto range = [](std::int64_t first, std::int64_t last) {
        return first == last ? fmt::format("rank {}", first)
                             : fmt::format("ranks {} to {}", first, last);
    };
    const std::string begin = "cannot be separated from ";
    if (up && down) {
        if (up == above && down == below) return begin + fmt::format("ranks {} and {}", *up, *down);
        return begin + range(*up, *down);
    }
    return begin + (up ? range(*up, above.value_or(*up)) : range(below.value_or(*down), *down));
}

std::string best_words(const BestOfDay& best) {
    const bool alone = best.attempts == 1;
    return fmt::format(
        "{} a conformance probability of at least {}. {} has {}: {}.",
        alone ? std::string("One attempt was made; it requires")
              : fmt::format("{} attempts were made; the best of that many requires", best.attempts),
        level_text(best.level), best.id, probability_text(best.probability),
        !best.beaten
            ? "it may be the luckiest of them, so as the best of that many it is not proven"
        : alone ? "it exceeds the record"
                : "as the best of that many it exceeds the record too");
}

std::string link_to(std::string_view file) {
    std::string link;
    for (const char c : file) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') ||
                           std::string_view("-._~/").find(c) != std::string_view::npos;
        link += plain
                    ? std::string(1, c)
                    : fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    }
    return link;
}

}  // namespace runcert
