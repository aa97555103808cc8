#include <fmt/format.h>

#include <algorithm>

#include "core/speed_unit.h"
#include "reports/explain/parts.h"
#include "reports/explain/words.h"

namespace runcert {

std::string margin_words(const Profile& profile) {
    const std::string above = profile.margin_above == MarginBase::upper_limit
                                  ? "the record's upper limit, its value plus its own expanded "
                                    "uncertainty"
                                  : "the record";
    if (profile.margin_kind == MarginKind::relative)
        return fmt::format("{:.6g} % above {}", profile.margin * 100.0, above);
    if (profile.margin_kind == MarginKind::elapsed_time)
        return fmt::format("a time over the course that is shorter than that of {} by {}", above,
                           number_text(profile.margin, "s"));
    const std::string& unit = profile.margin_unit;
    return fmt::format(
        "{} above {}",
        number_text(profile.margin / (unit.empty() ? 1.0 : metres_per_second(unit)), unit), above);
}

std::string rounding_words(const Profile& profile) {
    if (!profile.rounding) return "the required speed is not rounded";
    return fmt::format("the required speed is {} to {} of {}, as the body does",
                       profile.rounding->mode == DecimalMode::truncate
                           ? "cut off"
                           : "rounded to the nearest figure",
                       counted(profile.rounding->decimals, "decimal"), profile.rounding->unit);
}

std::string unit_of(const ProfileView& view) {
    return view.verdict.shown ? view.verdict.shown->unit : rule_unit_name(view.profile);
}

std::string speed_shown(const ProfileView& view) {
    if (!view.verdict.speed_m_s) return {};
    return measured_speed_text(shown_of(view.verdict, unit_of(view)), view.verdict.coverage_factor);
}

std::vector<std::string> override_words(const ProfileVerdict& verdict,
                                        const std::vector<std::string>& names) {
    std::vector<std::string> words;
    for (const Override& figure : verdict.overrides)
        if (names.empty() || std::ranges::find(names, figure.figure) != names.end())
            words.push_back(fmt::format(
                "{} is {} in place of the rule's {}. {}", figure.figure,
                number_text(figure.used, figure.unit), number_text(figure.rule, figure.unit),
                figure.reason.empty() ? "The attempt gives no reason."
                                      : sentence("Reason: " + figure.reason)));
    return words;
}

std::vector<std::string> notes_of(const ProfileVerdict& verdict) {
    std::vector<std::string> notes = verdict.notes;
    std::erase_if(notes, [&](const std::string& note) {
        return std::ranges::any_of(verdict.overrides, [&](const Override& figure) {
            return note.find(figure.figure) != std::string::npos;
        });
    });
    return notes;
}

}  // namespace runcert
