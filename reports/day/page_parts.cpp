#include "reports/day/page_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/prose.h"
#include "core/speed_unit.h"
#include "core/text.h"

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

void set_speed(TemplateData& row, const DayResult& result) {
    const auto& shown = result.shown;
    row.set("has_speed", TemplateData(shown.has_value()));
    if (!result.own_arithmetic.empty()) set_text(row, "own_arithmetic", result.own_arithmetic);
    if (!shown) return;
    set_text(row, "speed", shown->speed);
    set_text(row, "uncertainty", shown->expanded_uncertainty);
    set_text(row, "unit", shown->unit);
    set_text(row, "required_speed", shown->required_speed);
}

TemplateData place_data(const DayProfile& profile, std::size_t i, const AttemptResult& attempt) {
    const DayPlace& place = profile.ranking[i];
    const DayResult& result = *result_by(attempt, profile.profile);
    const OutcomeWords outcome = outcome_words(state_of(result));
    TemplateData row = template_map();
    set_text(row, "rank", place.rank ? fmt::format("{}", *place.rank) : "");
    row.set("shared", TemplateData(shares_rank(profile.ranking, i)));
    set_text(row, "apart",
             told_apart_words(place, next_rank(profile.ranking, i, -1),
                              next_rank(profile.ranking, i, 1)));
    set_text(row, "id", attempt.id);
    row.set("link", link_to(main_page(attempt)));
    const DayCraft craft = attempt.craft.value_or(DayCraft{});
    set_text(row, "craft", craft.name);
    set_text(row, "class", craft.craft_class);
    set_text(row, "outcome", outcome.title);
    set_text(row, "sign", outcome.mark);
    set_text(row, "tone", outcome.tone);
    set_speed(row, result);
    set_text(row, "window", window_words(result));
    set_text(row, "reason", result.reason);
    set_text(row, "replaced", listed(result.replaced));
    row.set("answers", texts_of(result.answers));
    return row;
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
            .label = place.rank ? fmt::format("{} · {}", *place.rank, place.id) : "– · " + place.id,
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

void set_picture(TemplateData& data, const DayProfile& profile, const AttemptsById& attempts) {
    const Picture picture = picture_of(profile, attempts);
    data.set("has_picture", TemplateData(!picture.lines.empty()));
    data.set("picture", picture_svg(picture));
    const auto with_speed = std::ranges::count_if(profile.ranking, [&](const DayPlace& place) {
        return result_by(*attempts.at(place.id), profile.profile)->speed_m_s.has_value();
    });
    const auto drawn = std::ssize(picture.lines);
    set_text(data, "cut",
             drawn < with_speed
                 ? fmt::format("The first {} of {} speeds are drawn; the table below has them all.",
                               drawn, counted(with_speed))
                 : "");
}

void set_count(TemplateData& counts, const OutcomeState& state, const std::string& words,
               std::int64_t count) {
    if (count == 0) return;
    const OutcomeWords outcome = outcome_words(state);
    TemplateData entry = template_map();
    set_text(entry, "sign", outcome.mark);
    set_text(entry, "words", words);
    set_text(entry, "tone", outcome.tone);
    set_text(entry, "count", counted(count));
    counts.push_back(entry);
}

TemplateData tally_of(const DayProfile& profile, const AttemptsById& attempts) {
    const auto no_record = std::ranges::count_if(profile.ranking, [&](const DayPlace& place) {
        const DayResult& result = *result_by(*attempts.at(place.id), profile.profile);
        return result.outcome == Outcome::not_proven && !result.required_speed_m_s;
    });
    TemplateData counts = template_list();
    const auto add = [&](Outcome outcome, const std::string& words, std::int64_t count,
                         bool record_named = true) {
        set_count(counts, {.outcome = outcome, .record_named = record_named}, words, count);
    };
    add(Outcome::beaten, "above the record", profile.counts.beaten);
    add(Outcome::not_proven, "not proven", profile.counts.not_proven - no_record);
    add(Outcome::not_proven, "measured, no record named", no_record, false);
    add(Outcome::not_beaten, "not beaten", profile.counts.not_beaten);
    add(Outcome::not_certifiable, "not certifiable", profile.counts.not_certifiable);
    return counts;
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

TemplateData texts_of(const std::vector<std::string>& texts) {
    TemplateData data = template_list();
    for (const std::string& text : texts) {
        TemplateData item = template_map();
        set_text(item, "text", text);
        data.push_back(item);
    }
    return data;
}

AttemptsById attempts_by_id(const DayResults& results) {
    AttemptsById attempts;
    for (const AttemptResult& attempt : results.attempts)
        if (const auto [found, added] = attempts.try_emplace(attempt.id, &attempt);
            !added && attempt.state == "done")
            found->second = &attempt;
    return attempts;
}

TemplateData template_map() {
    return TemplateData{TemplateData::type::object};
}

TemplateData template_list() {
    return TemplateData{TemplateData::type::list};
}

void set_list(TemplateData& map, const std::string& name, TemplateData items, bool any) {
    map.set(name, std::move(items));
    map.set("has_" + name, TemplateData(any));
}

void set_text(TemplateData& map, const std::string& name, const std::string& text) {
    // An empty text is nothing to a template: a section of that name is left out.
    if (text.empty())
        map.set(name, TemplateData(false));
    else
        map.set(name, plain_text(text));
}

TemplateData profile_data(const DayProfile& profile, const AttemptsById& attempts,
                          std::size_t number) {
    TemplateData data = template_map();
    data.set("anchor", fmt::format("rule-{}", number));
    set_text(data, "profile", profile.profile);
    set_text(data, "body", profile.body);
    set_text(data, "title", profile.title);
    data.set("tally", tally_of(profile, attempts));
    set_text(data, "best", profile.best ? best_words(*profile.best) : "");
    set_picture(data, profile, attempts);
    TemplateData places = template_list();
    for (std::size_t i = 0; i < profile.ranking.size(); ++i)
        places.push_back(place_data(profile, i, *attempts.at(profile.ranking[i].id)));
    data.set("places", places);
    return data;
}

}  // namespace runcert
