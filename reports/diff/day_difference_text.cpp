#include <fmt/format.h>

#include <algorithm>

#include "core/plain_text.h"
#include "core/prose.h"
#include "core/text.h"
#include "reports/diff/day_difference.h"
#include "reports/diff/run_difference.h"

namespace runcert {
namespace {

constexpr std::size_t listed_at_most = 20;
constexpr std::size_t hash_digits = 12;

/// A title and its items, cut unless `all`.
std::string group(const std::string& title, const std::vector<std::string>& items, bool all) {
    if (items.empty()) return {};
    std::string text = wrapped(fmt::format("{}: {}", title, counted(std::ssize(items))));
    const std::size_t shown = all ? items.size() : std::min(items.size(), listed_at_most);
    for (std::size_t i = 0; i < shown; ++i)
        text += list_item(items[i]);
    if (shown < items.size())
        text += list_item(fmt::format("and {} more; --json has them all",
                                      counted(static_cast<std::int64_t>(items.size() - shown))));
    return text;
}

std::string state_words(const std::string& state, const std::optional<DayFailure>& failure) {
    if (state == "done") return "processed";
    if (state == "not_processed") return "left out";
    return failure ? fmt::format("failed at {} ({})", failure->step, failure->problem) : "failed";
}

std::string outcome_text(const std::optional<DayResult>& result) {
    return result ? std::string(words_of(result->outcome)) : "not claimed";
}

/// The figures with the digits of the file, not those to be read: what moved may be small.
std::string speed_words(const DayResult& result) {
    if (!result.speed_m_s) return "no speed";
    std::string text = format_fixed(*result.speed_m_s, 6) + " m/s";
    if (result.expanded_uncertainty_m_s)
        text += fmt::format(" ± {} m/s", format_fixed(*result.expanded_uncertainty_m_s, 6));
    return text;
}

std::string moved_words(const ResultChange& change) {
    if (!change.speed_moved && !change.uncertainty_moved) return {};
    std::string text =
        fmt::format("{} -> {}", speed_words(*change.old_result), speed_words(*change.new_result));
    if (change.moved_by)
        text += fmt::format(", {:+.3g} of its standard uncertainty", *change.moved_by);
    return text;
}

std::vector<std::string> items_of(const DayComparison& comparison, bool outcomes) {
    std::vector<std::string> items;
    for (const ResultChange& change : comparison.results) {
        if (change.outcome_changed != outcomes) continue;
        std::string text = fmt::format("{}, {}: ", change.id, change.profile);
        if (outcomes)
            text += fmt::format("{} -> {}", outcome_text(change.old_result),
                                outcome_text(change.new_result));
        const std::string moved = moved_words(change);
        items.push_back(text + (outcomes && !moved.empty() ? "; " : "") + moved);
    }
    return items;
}

bool is_hash(const std::string& text) {
    return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// A hash by its first digits.
std::string short_value(const std::string& text) {
    return is_hash(text) ? text.substr(0, hash_digits) : text;
}

void add_causes(std::vector<std::string>& lines, const char* kind,
                const std::vector<Change>& changes) {
    for (const Change& change : changes)
        lines.push_back(fmt::format("{} {}: {} -> {}", kind, change.what, short_value(change.a),
                                    short_value(change.b)));
}

std::vector<std::string> lines_of(const ChangeCauses& causes) {
    if (!causes.unknown.empty()) return {"not known, " + causes.unknown};
    std::vector<std::string> lines;
    add_causes(lines, "input", causes.causes.inputs);
    add_causes(lines, "parameter", causes.causes.parameters);
    add_causes(lines, "attempt", causes.causes.attempt);
    add_causes(lines, "program of", causes.causes.programs);
    if (lines.empty())
        lines.emplace_back(
            "programs, inputs, parameters and attempt are the same: another processor or compiler, "
            "or a file was changed; `runcert verify RUN --recompute` tells");
    return lines;
}

/// Attempts that changed for the same reasons, together, in the order of their first.
std::string causes_text(const DayComparison& comparison, bool all) {
    std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> reasons;
    for (const ChangeCauses& causes : comparison.causes) {
        const std::vector<std::string> lines = lines_of(causes);
        const auto known = std::ranges::find_if(
            reasons, [&](const auto& reason) { return reason.first == lines; });
        if (known == reasons.end())
            reasons.push_back({lines, {causes.id}});
        else
            known->second.push_back(causes.id);
    }
    std::string text;
    for (const auto& [lines, ids] : reasons) {
        std::vector<std::string> named = ids;
        if (!all && named.size() > listed_at_most) {
            named.resize(listed_at_most);
            named.push_back(counted(static_cast<std::int64_t>(ids.size() - listed_at_most)) +
                            " more");
        }
        text += wrapped(plain_text("Why, of " + listed(named) + ":"));
        for (const std::string& line : lines)
            text += list_item(line);
    }
    return text;
}

}  // namespace

std::string comparison_text(const DayComparison& comparison, const std::filesystem::path& old_out,
                            const std::filesystem::path& new_out, bool all) {
    std::string text = wrapped(plain_text(fmt::format("Old: {}", old_out.string()))) +
                       wrapped(plain_text(fmt::format("New: {}", new_out.string())));
    text += wrapped(fmt::format(
        "The same: {} of {} in both (state and outcomes; speeds to a tenth of their standard "
        "uncertainty, the smaller of the two; uncertainties to a tenth of themselves).",
        counted(comparison.unchanged), counted(comparison.in_both, "attempt")));
    text += group("Only in the old day", comparison.only_old, all);
    text += group("Only in the new day", comparison.only_new, all);
    std::vector<std::string> states;
    for (const StateChange& change : comparison.states)
        states.push_back(fmt::format("{}: {} -> {}", change.id,
                                     state_words(change.old_state, change.old_failure),
                                     state_words(change.new_state, change.new_failure)));
    text += group("Processed otherwise", states, all);
    text += group("Outcomes that changed", items_of(comparison, true), all);
    text += group("Speeds and uncertainties that moved", items_of(comparison, false), all);
    text += causes_text(comparison, all);
    return text + (comparison.equal() ? "Nothing changed.\n" : "");
}

}  // namespace runcert
