#include "reports/day/page_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/claimed_text.h"
#include "core/prose.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"

namespace runcert {
namespace {

constexpr std::size_t drawn_at_most = 24;

/// The page of a report to go to, or the report itself.
std::string main_page(const AttemptResult& attempt) {
    const auto html = std::ranges::find_if(
        attempt.pages, [](const std::string& page) { return page.ends_with(".html"); });
    return html == attempt.pages.end() ? attempt.report : *html;
}

/// The ranks next to one's own, of the place at `index`.
std::optional<std::int64_t> next_rank(const std::vector<DayPlace>& places, std::size_t index,
                                      std::ptrdiff_t step) {
    for (auto i = static_cast<std::ptrdiff_t>(index); i >= 0 && i < std::ssize(places); i += step) {
        const auto& rank = places[static_cast<std::size_t>(i)].rank;
        if (rank != places[index].rank) return rank;
    }
    return std::nullopt;
}

bool shares_rank(const std::vector<DayPlace>& places, std::size_t i) {
    const auto same = [&](std::size_t other) { return places[other].rank == places[i].rank; };
    return places[i].rank && ((i > 0 && same(i - 1)) || (i + 1 < places.size() && same(i + 1)));
}

/// What stands beneath a place of the ranking.
std::vector<std::string> further_of(const DayResult& result, const std::string& apart) {
    std::vector<std::string> lines;
    if (!apart.empty()) lines.push_back("≈ " + apart);
    if (!result.own_arithmetic.empty())
        lines.push_back("By the rule’s own arithmetic: " + result.own_arithmetic);
    if (!result.reason.empty()) lines.push_back(result.reason);
    if (!result.replaced.empty())
        lines.push_back(
            fmt::format("The attempt replaced figures of the rule: {}.", listed(result.replaced)));
    lines.insert(lines.end(), result.answers.begin(), result.answers.end());
    return lines;
}

/// "“Yacht B”, land-yacht".
std::string craft_words(const DayCraft& craft) {
    return craft.name.empty() || craft.craft_class.empty()
               ? claimed(craft.name) + craft.craft_class
               : fmt::format("{}, {}", claimed(craft.name), craft.craft_class);
}

void add_place(Block& ranking, const DayProfile& profile, std::size_t i,
               const AttemptResult& attempt) {
    const DayPlace& place = profile.ranking[i];
    const DayResult& result = *result_by(attempt, profile.profile);
    const OutcomeWords outcome = outcome_words(state_of(result));
    const std::string apart = told_apart_words(place, next_rank(profile.ranking, i, -1),
                                               next_rank(profile.ranking, i, 1));
    const std::string window = window_words(result);
    const std::string rank =
        place.rank ? fmt::format("{}{}{}", *place.rank, shares_rank(profile.ranking, i) ? "=" : "",
                                 apart.empty() ? "" : " ≈")
                   : "–";
    TableRow& row = add_row(
        ranking,
        {attempt.id, rank, craft_words(attempt.craft.value_or(DayCraft{})),
         fmt::format("{} {}", outcome.mark, outcome.title),
         result.shown ? measured_speed_text(*result.shown) : "–", window.empty() ? "–" : window},
        outcome.tone);
    row.link = main_page(attempt);
    row.further = further_of(result, apart);
}

std::string place_label(const DayPlace& place) {
    return place.rank ? fmt::format("{} · {}", *place.rank, place.id) : "– · " + place.id;
}

/// The speeds of a ranking, of the first places that have one.
Picture picture_of(const DayProfile& profile, const AttemptsById& attempts) {
    Picture picture{.title = fmt::format("Speeds by {} with their expanded uncertainties, in the "
                                         "order of the ranking; the table has the figures",
                                         profile.profile)};
    for (const DayPlace& place : profile.ranking) {
        const DayResult& result = *result_by(*attempts.at(place.id), profile.profile);
        const auto& shown = result.shown;
        if (!shown) continue;
        if (picture.lines.size() == drawn_at_most) break;
        if (picture.unit.empty()) picture.unit = shown->unit;
        const double unit_m_s = metres_per_second(picture.unit);
        PictureLine line{
            .label = place_label(place),
            .figure = fmt::format("{} ± {}", shown->speed, shown->expanded_uncertainty),
            .tone = outcome_words(state_of(result)).tone,
            .speed = *result.speed_m_s / unit_m_s,
            .expanded_uncertainty = result.expanded_uncertainty_m_s.value_or(0.0) / unit_m_s};
        if (result.required_speed_m_s) line.required_speed = *result.required_speed_m_s / unit_m_s;
        if (shown->unit != picture.unit) line.figure += " " + shown->unit;
        picture.lines.push_back(std::move(line));
    }
    return picture;
}

/// How many of the speeds are drawn, where not all are.
std::string cut_words(const DayProfile& profile, const AttemptsById& attempts,
                      const Picture& picture) {
    const auto with_speed = std::ranges::count_if(profile.ranking, [&](const DayPlace& place) {
        return result_by(*attempts.at(place.id), profile.profile)->speed_m_s.has_value();
    });
    const auto drawn = std::ssize(picture.lines);
    if (drawn == with_speed) return {};
    return fmt::format(" The first {} of {} speeds are drawn; the table below has them all.", drawn,
                       counted(with_speed));
}

/// The first windows of a ranking; those of another quantity than the first are left out.
Overlay overlay_of(const DayProfile& profile, const WindowCurves& curves) {
    Overlay overlay{.title = fmt::format("Smoothed speeds around the windows by {}, each from the "
                                         "start of its window on",
                                         profile.profile)};
    for (const DayPlace& place : profile.ranking) {
        const auto of_attempt = curves.find(place.id);
        if (of_attempt == curves.end() || overlay.runs.size() == overlaid_at_most) continue;
        for (const WindowCurve& curve : of_attempt->second)
            if (curve.profile == profile.profile &&
                (overlay.runs.empty() || overlay.runs.front().curve->quantity == curve.quantity))
                overlay.runs.push_back({.label = place_label(place), .curve = &curve});
    }
    return overlay;
}

Block tally_of(const DayProfile& profile, const AttemptsById& attempts) {
    const auto no_record = std::ranges::count_if(profile.ranking, [&](const DayPlace& place) {
        const DayResult& result = *result_by(*attempts.at(place.id), profile.profile);
        return result.outcome == Outcome::not_proven && !result.required_speed_m_s;
    });
    Block tally = facts({}, {}, "narrow");
    const auto add = [&](Outcome outcome, const char* words, std::int64_t count,
                         bool record_named = true) {
        const OutcomeState state{.outcome = outcome, .record_named = record_named};
        if (count > 0)
            add_fact(tally, fmt::format("{} {}", outcome_words(state).mark, words), counted(count));
    };
    add(Outcome::beaten, "above the record", profile.counts.beaten);
    add(Outcome::not_proven, "not proven", profile.counts.not_proven - no_record);
    add(Outcome::not_proven, "measured, no record named", no_record, false);
    add(Outcome::not_beaten, "not beaten", profile.counts.not_beaten);
    add(Outcome::not_certifiable, "not certifiable", profile.counts.not_certifiable);
    return tally;
}

}  // namespace

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

RankingPart ranking_part(const DayProfile& profile, const AttemptsById& attempts,
                         const WindowCurves& curves, std::size_t number) {
    const Picture picture = picture_of(profile, attempts);
    Section section{.anchor = fmt::format("rule-{}", number + 1),
                    .title = fmt::format("{} ({})", capitalised(profile.title), profile.profile),
                    .blocks = {paragraph(profile.body, "note"), tally_of(profile, attempts)}};
    if (profile.best) add(section, paragraph(best_words(*profile.best), "note"));
    if (!picture.lines.empty())
        add(section, plot(number, "Speeds",
                          "Each with its expanded uncertainty; the dashed line is the required "
                          "speed." +
                              cut_words(profile, attempts, picture)));
    RankingPart part{.section = {}, .pictures = {picture_svg(picture)}};
    const Overlay overlay = overlay_of(profile, curves);
    if (overlay.runs.size() > 1) {
        add(section, plot(number + 1, "Around the windows",
                          fmt::format("Smoothed speeds from the start of each window on, of the "
                                      "first {} of the ranking; bold: the window.",
                                      overlay.runs.size())));
        part.pictures.push_back(overlay_svg(overlay));
    }
    Block ranking = table(
        {"Attempt|16", ">Rank|7", "Craft|15", "Outcome|23", ">Speed ± U|23", "Window from|16"});
    for (std::size_t i = 0; i < profile.ranking.size(); ++i)
        add_place(ranking, profile, i, *attempts.at(profile.ranking[i].id));
    add(section, std::move(ranking));
    part.section = std::move(section);
    return part;
}

}  // namespace runcert
