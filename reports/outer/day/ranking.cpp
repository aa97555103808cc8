#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "reports/day/day.h"

namespace runcert {
namespace {

constexpr std::array outcome_order{Outcome::beaten, Outcome::not_proven, Outcome::not_beaten,
                                   Outcome::not_certifiable};

struct Entry {
    std::string_view id;
    const DayResult* result;

    auto outcome() const { return std::ranges::find(outcome_order, result->outcome); }
    double speed() const { return result->speed_m_s.value_or(0.0); }
    double uncertainty() const { return result->expanded_uncertainty_m_s.value_or(0.0); }
    bool is_ranked() const {
        return result->speed_m_s.has_value() && result->outcome != Outcome::not_certifiable;
    }
    /// The smaller is ahead.
    auto merit() const {
        return std::tuple(outcome(), !result->speed_m_s.has_value(), -speed(), uncertainty());
    }
};

bool differ_significantly(const Entry& a, const Entry& b) {
    return !(std::abs(a.speed() - b.speed()) < std::hypot(a.uncertainty(), b.uncertainty()));
}

/// The last rank, going by `step` (1 or -1), that one is not told apart from; nothing but its own.
std::optional<std::int64_t> tied_rank(const std::vector<Entry>& entries,
                                      const std::vector<DayPlace>& places, std::size_t from,
                                      std::ptrdiff_t step) {
    std::optional<std::int64_t> last;
    for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(from) + step;
         i >= 0 && i < std::ssize(entries); i += step) {
        const auto other = static_cast<std::size_t>(i);
        if (!places[other].rank) break;
        if (places[other].rank == places[from].rank) continue;
        if (differ_significantly(entries[from], entries[other])) break;
        last = places[other].rank;
    }
    return last;
}

}  // namespace

std::vector<DayPlace> ranking_by(std::string_view profile,
                                 const std::vector<AttemptResult>& attempts) {
    std::vector<Entry> entries;
    for (const AttemptResult& attempt : attempts)
        if (const DayResult* result = result_by(attempt, profile))
            entries.push_back({attempt.id, result});
    std::ranges::stable_sort(entries, [](const Entry& a, const Entry& b) {
        return std::tuple(a.merit(), a.id) < std::tuple(b.merit(), b.id);
    });
    std::vector<DayPlace> places;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        DayPlace place{.rank = std::nullopt, .id = std::string(entries[i].id)};
        if (entries[i].is_ranked()) {
            const bool tied = i > 0 && entries[i].merit() == entries[i - 1].merit();
            place.rank = tied ? places[i - 1].rank : static_cast<std::int64_t>(i) + 1;
        }
        places.push_back(std::move(place));
    }
    for (std::size_t i = 0; i < entries.size(); ++i)
        if (places[i].rank) {
            places[i].tied_up_to_rank = tied_rank(entries, places, i, -1);
            places[i].tied_down_to_rank = tied_rank(entries, places, i, 1);
        }
    return places;
}

std::optional<BestOfDay> best_by(std::string_view profile,
                                 const std::vector<AttemptResult>& attempts,
                                 const std::vector<DayPlace>& ranking) {
    if (ranking.empty()) return std::nullopt;
    const auto first = std::ranges::find_if(attempts, [&](const AttemptResult& attempt) {
        return attempt.id == ranking.front().id && result_by(attempt, profile);
    });
    const DayResult& result = *result_by(*first, profile);
    if (result.outcome != Outcome::beaten || !result.probability || !result.level)
        return std::nullopt;
    const double risk = (1.0 - *result.level) * static_cast<double>(result.attempts_made);
    BestOfDay best{.id = ranking.front().id,
                   .attempts = std::ssize(ranking),
                   .probability = *result.probability};
    for (const AttemptResult& attempt : attempts)
        if (const DayResult* other = result_by(attempt, profile))
            best.attempts = std::max(best.attempts, other->attempts_made);
    best.level = 1.0 - risk / static_cast<double>(best.attempts);
    best.beaten = best.probability >= best.level;
    return best;
}

OutcomeCounts outcomes_by(std::string_view profile, const std::vector<AttemptResult>& attempts) {
    OutcomeCounts counts;
    for (const AttemptResult& attempt : attempts) {
        const DayResult* result = result_by(attempt, profile);
        if (!result) continue;
        if (result->outcome == Outcome::beaten) ++counts.beaten;
        if (result->outcome == Outcome::not_proven) ++counts.not_proven;
        if (result->outcome == Outcome::not_beaten) ++counts.not_beaten;
        if (result->outcome == Outcome::not_certifiable) ++counts.not_certifiable;
    }
    return counts;
}

DayCounts counts_of(const std::vector<AttemptResult>& attempts) {
    const auto of_state = [&](std::string_view state) {
        return std::ranges::count(attempts, state, &AttemptResult::state);
    };
    return {.attempts = std::ssize(attempts),
            .done = of_state("done"),
            .failed = of_state("failed"),
            .not_processed = of_state("not_processed"),
            .beaten = std::ranges::count_if(attempts, [](const AttemptResult& attempt) {
                return std::ranges::count(attempt.results, Outcome::beaten, &DayResult::outcome) >
                       0;
            })};
}

}  // namespace runcert
