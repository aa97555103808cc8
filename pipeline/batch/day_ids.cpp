#include "batch/day_ids.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/prose.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr std::size_t longest_id = 64;

/// The sources of the others, "heats/b.yaml and day.yaml:14", not more than three.
std::string others(const std::vector<DayAttempt*>& alike, const DayAttempt* one) {
    constexpr std::size_t most = 3;
    std::vector<std::string> sources;
    for (const DayAttempt* other : alike)
        if (other != one && sources.size() < most)
            sources.push_back(other->source +
                              (other->id == one->id ? "" : " (as \"" + other->id + "\")"));
    if (alike.size() - 1 > most) sources.push_back(fmt::format("{} more", alike.size() - 1 - most));
    return listed(sources);
}

void refuse_alike(const std::vector<DayAttempt*>& alike) {
    for (DayAttempt* attempt : alike) {
        const bool same = std::all_of(alike.begin(), alike.end(), [&](const DayAttempt* other) {
            return other->id == attempt->id;
        });
        attempt->refused.emplace(
            attempt->source,
            fmt::format("the id \"{}\" is that of {} too{}", attempt->id, others(alike, attempt),
                        same ? "" : ", but for the case of letters, which not every disk knows"),
            "Give each attempt an id of its own: it names the run folder");
    }
}

}  // namespace

std::string id_from_name(std::string_view name) {
    std::string id;
    for (const char c : name) {
        const bool inside_character = (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
        if (inside_character) continue;
        const bool kept = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '-' || c == '_';
        if (id.size() < longest_id && !(id.empty() && (!kept || c == '-'))) id += kept ? c : '-';
    }
    return id.empty() ? "run" : id;
}

std::vector<DayAttempt> with_own_ids(std::vector<ListedAttempt> listed_attempts) {
    std::map<std::string, std::vector<DayAttempt*>> by_id;
    for (ListedAttempt& each : listed_attempts)
        if (each.has_id) by_id[lower_case(each.attempt.id)].push_back(&each.attempt);
    for (const auto& [id, alike] : by_id)
        if (alike.size() > 1) refuse_alike(alike);

    std::set<std::string> taken;
    for (const auto& [id, alike] : by_id)
        taken.insert(id);
    std::vector<DayAttempt> attempts;
    for (ListedAttempt& each : listed_attempts) {
        DayAttempt& attempt = each.attempt;
        const std::string label = attempt.id;
        for (int n = 2; !each.has_id && !taken.insert(lower_case(attempt.id)).second; ++n) {
            const std::string number = fmt::format("-{}", n);
            attempt.id = label.substr(0, longest_id - number.size()) + number;
        }
        attempts.push_back(std::move(attempt));
    }
    return attempts;
}

}  // namespace runcert
