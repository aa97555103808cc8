#include "reports/day/page_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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

std::string apart_of(const DayProfile& profile, std::size_t i) {
    return separation_words(profile.ranking[i], next_rank(profile.ranking, i, -1),
                            next_rank(profile.ranking, i, 1));
}

/// "1", "2= ≈": shared with another, and not told apart from a neighbour.
std::string rank_text(const DayProfile& profile, std::size_t i) {
    const DayPlace& place = profile.ranking[i];
    if (!place.rank) return "–";
    return fmt::format("{}{}{}", *place.rank, shares_rank(profile.ranking, i) ? "=" : "",
                       apart_of(profile, i).empty() ? "" : " ≈");
}

std::string speed_text(const DayResult& result) {
    return result.shown ? measured_speed_text(*result.shown) : "–";
}

void add_place(Block& ranking, const DayProfile& profile, std::size_t i,
               const AttemptResult& attempt) {
    const DayResult& result = *result_by(attempt, profile.profile);
    const OutcomeWords outcome = outcome_words(state_of(result));
    const std::string apart = apart_of(profile, i);
    const std::string window = window_words(result);
    const std::string rank = rank_text(profile, i);
    TableRow& row = add_row(ranking,
                            {attempt.id, rank, craft_words(attempt.craft.value_or(DayCraft{})),
                             fmt::format("{} {}", outcome.mark, outcome.title), speed_text(result),
                             window.empty() ? "–" : window},
                            outcome.tone);
    row.link = main_page(attempt);
    row.further = further_of(result, apart);
}

std::string place_label(const DayPlace& place) {
    return place.rank ? fmt::format("{} · {}", *place.rank, place.id) : "– · " + place.id;
}

/// A bar for each outcome: how its words are called, and its colour.
struct Tone {
    std::string_view tone;
    const char *name, *colour;
};
constexpr std::array<Tone, 4> tones{{{"yes", "above the record", "green"},
                                     {"open", "not proven", "orange"},
                                     {"no", "not beaten", "grey"},
                                     {"refused", "not certifiable", "vermilion"}}};

/// The speeds of a ranking with their expanded uncertainties, of the first places that have one.
Plots speeds_of(const DayProfile& profile, const AttemptsById& attempts) {
    Plot plot{.kind = "speeds",
              .title = "Speeds by " + profile.profile,
              .caption = "Each with its expanded uncertainty, in the order of the ranking."};
    std::array<Curve, tones.size()> bars, middles;
    Curve required{"required speed", "outline", "blue"};
    for (std::size_t k = 0; k < tones.size(); ++k) {
        bars[k] = {tones[k].name, "outline", tones[k].colour, 4};
        middles[k] = {tones[k].name, "points", tones[k].colour, 4};
    }
    Range speeds;
    std::string unit;
    std::size_t with_speed = 0;
    for (const DayPlace& place : profile.ranking) {
        const DayResult& result = *result_by(*attempts.at(place.id), profile.profile);
        const auto& shown = result.shown;
        if (!shown || ++with_speed > drawn_at_most) continue;
        if (unit.empty()) unit = shown->unit;
        const double unit_m_s = metres_per_second(unit), row = -static_cast<double>(with_speed);
        const double speed = *result.speed_m_s / unit_m_s;
        const double half = result.expanded_uncertainty_m_s.value_or(0.0) / unit_m_s;
        const auto tone =
            std::ranges::find(tones, outcome_words(state_of(result)).tone, &Tone::tone);
        const auto k = tone == tones.end() ? 0 : static_cast<std::size_t>(tone - tones.begin());
        plot.rows.push_back({place_label(place), row,
                             fmt::format("{} ± {}{}", shown->speed, shown->expanded_uncertainty,
                                         shown->unit == unit ? "" : " " + shown->unit)});
        const auto line = [&](Curve& curve, double from, double to, double low, double high) {
            curve.interrupt();
            curve.add(from, row + low);
            curve.add(to, row + high);
            speeds.widen(from);
            speeds.widen(to);
        };
        line(bars[k], speed - half, speed + half, 0.0, 0.0);
        for (const double end : {speed - half, speed + half})
            line(bars[k], end, end, -0.12, 0.12);
        middles[k].add(speed, row);
        if (result.required_speed_m_s)
            line(required, *result.required_speed_m_s / unit_m_s,
                 *result.required_speed_m_s / unit_m_s, -0.3, 0.3);
    }
    if (plot.rows.empty()) return {};
    if (with_speed > drawn_at_most)
        plot.caption += fmt::format(" The first {} of {} speeds are drawn; the table has them all.",
                                    drawn_at_most, with_speed);
    for (auto* const curves : {&bars, &middles})
        for (Curve& curve : *curves)
            plot.add(std::move(curve));
    plot.add(std::move(required));
    plot.x_label = unit;
    const double room = std::max(0.04 * speeds.span(), 1e-3);
    speeds.widen(*speeds.least - room);
    speeds.widen(*speeds.most + room);
    plot.set_axes(speeds, {});
    plot.y_min = -static_cast<double>(plot.rows.size()) - 0.5;
    plot.y_max = -0.5;
    return {std::move(plot)};
}

/// The first windows of a ranking over one another from their starts; those of another quantity
/// than the first are left out.
Plots overlay_of(const DayProfile& profile, const WindowCurves& curves) {
    constexpr std::array colours{"blue", "vermilion", "green", "purple", "orange", "grey"};
    Plot plot{.kind = "overlay", .title = "Around the windows by " + profile.profile};
    plot.x_label = "time from the start of the window (s)";
    Range times, speeds;
    double longest_s = 0.0;
    std::size_t runs = 0;
    for (const DayPlace& place : profile.ranking) {
        const auto of_attempt = curves.find(place.id);
        if (of_attempt == curves.end()) continue;
        for (const WindowCurve& curve : of_attempt->second) {
            if (runs == colours.size() || curve.profile != profile.profile ||
                (runs > 0 && plot.y_label != curve.quantity))
                continue;
            plot.y_label = curve.quantity;
            longest_s = std::max(longest_s, curve.duration_s);
            Curve run{place_label(place), "line", colours[runs++]};
            run.x = curve.speed.x;
            run.y = curve.speed.y;
            for (const double time_s : run.x)
                times.widen(time_s);
            for (const double speed : run.y)
                speeds.widen(speed);
            plot.add(std::move(run));
        }
    }
    if (runs < 2) return {};
    plot.caption = fmt::format(
        "Smoothed speeds from the start of each window on, of the first {} of the ranking.", runs);
    plot.spans = {{"window", "window", 0.0, longest_s}};
    plot.set_axes(times, speeds);
    return {std::move(plot)};
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

std::string separation_words(const DayPlace& place, std::optional<std::int64_t> above,
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
    Section section{.anchor = fmt::format("rule-{}", number + 1),
                    .title = fmt::format("{} ({})", capitalised(profile.title), profile.profile),
                    .blocks = {paragraph(profile.body, "note"), tally_of(profile, attempts)}};
    if (profile.best) add(section, paragraph(best_words(*profile.best), "note"));
    RankingPart part{.section = {}, .plots = speeds_of(profile, attempts)};
    std::ranges::move(overlay_of(profile, curves), std::back_inserter(part.plots));
    for (const Plot& one : part.plots)
        add(section, plot(number++, one.title, one.caption));
    Block ranking = table(
        {"Attempt|16", ">Rank|7", "Craft|15", "Outcome|23", ">Speed ± U|23", "Window from|16"});
    for (std::size_t i = 0; i < profile.ranking.size(); ++i)
        add_place(ranking, profile, i, *attempts.at(profile.ranking[i].id));
    add(section, std::move(ranking));
    part.section = std::move(section);
    return part;
}

std::string ranking_text(const DayResults& results) {
    const AttemptsById attempts = attempts_by_id(results);
    std::string text;
    for (const DayProfile& profile : results.profiles) {
        std::vector<std::array<std::string, 4>> rows;
        std::array<std::size_t, 4> widths{};
        for (std::size_t i = 0; i < profile.ranking.size(); ++i) {
            const AttemptResult& attempt = *attempts.at(profile.ranking[i].id);
            const DayResult& result = *result_by(attempt, profile.profile);
            rows.push_back({rank_text(profile, i), attempt.id, speed_text(result),
                            outcome_words(state_of(result)).title});
            for (std::size_t k = 0; k < widths.size(); ++k)
                widths[k] = std::max(widths[k], characters_in(rows.back()[k]));
        }
        text += fmt::format("\n{}\n", profile.profile);
        for (const auto& row : rows) {
            text += " ";
            for (std::size_t k = 0; k < widths.size(); ++k)
                text +=
                    " " + row[k] +
                    (k + 1 < widths.size() ? std::string(widths[k] - characters_in(row[k]) + 1, ' ')
                                           : "");
            text += "\n";
        }
    }
    return text;
}

}  // namespace runcert
