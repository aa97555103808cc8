#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "core/text.h"
#include "reports/day/day.h"

namespace runcert {
namespace {

constexpr std::string_view columns =
    "attempt,source,state,craft,class,profile,rank,tied_up_to_rank,tied_down_to_rank,outcome,to_be_"
    "attested,signatures_required,speed_m_s,expanded_uncertainty_m_s,coverage_factor,required_"
    "speed_m_s,shown_unit,shown_speed,shown_expanded_uncertainty,shown_required_speed,window_start_"
    "utc,window_start_time_s,window_duration_s,reason,replaced_figures,failed_step,problem,where,"
    "remedy,notes,report_id,report,own_arithmetic\n";

/// Places by attempt.
using Places = std::map<std::string_view, const DayPlace*>;

std::string cell(const std::optional<double>& value, int decimals) {
    return value ? format_fixed(*value, decimals) : "";
}

std::string cell(const std::optional<std::int64_t>& value) {
    return value ? fmt::format("{}", *value) : "";
}

/// The columns of one rule, from `profile` to `window_duration_s`.
std::string result_cells(const DayResult& result, const DayPlace& place) {
    const ShownFigures shown = result.shown.value_or(ShownFigures{});
    return fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", csv_cell(result.profile),
        cell(place.rank), cell(place.tied_up_to_rank), cell(place.tied_down_to_rank),
        to_text(result.outcome), result.standing.attestations, result.standing.signatures,
        cell(result.speed_m_s, 6), cell(result.expanded_uncertainty_m_s, 6),
        format_fixed(result.coverage_factor, 6), cell(result.required_speed_m_s, 6), shown.unit,
        csv_cell(shown.speed), csv_cell(shown.expanded_uncertainty), csv_cell(shown.required_speed),
        csv_cell(result.start_utc), cell(result.start_time_s, 9), cell(result.duration_s, 9));
}

std::string row(const AttemptResult& attempt, const DayResult* result, const DayPlace* place) {
    const DayCraft craft = attempt.craft.value_or(DayCraft{});
    const DayFailure failure = attempt.failure.value_or(DayFailure{});
    constexpr std::string_view no_result = ",,,,,,,,,,,,,,,,,";
    const std::vector<std::string> none;
    return fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_cell(attempt.id),
        csv_cell(attempt.source), attempt.state, csv_cell(craft.name), csv_cell(craft.craft_class),
        result ? result_cells(*result, *place) : std::string(no_result),
        csv_cell(result ? result->reason : attempt.reason),
        csv_cell(fmt::format("{}", fmt::join(result ? result->replaced : none, "; "))),
        csv_cell(failure.step), csv_cell(plain_text(failure.problem)),
        csv_cell(plain_text(failure.where)), csv_cell(plain_text(failure.remedy)),
        csv_cell(fmt::format("{}", fmt::join(attempt.notes, "; "))), attempt.report_id,
        csv_cell(attempt.report), csv_cell(result ? result->own_arithmetic : ""));
}

}  // namespace

std::string day_csv(const DayResults& results) {
    std::map<std::string_view, Places> places;
    for (const DayProfile& profile : results.profiles)
        for (const DayPlace& place : profile.ranking)
            places[profile.profile][place.id] = &place;
    std::string csv(columns);
    for (const AttemptResult& attempt : results.attempts) {
        if (attempt.results.empty()) csv += row(attempt, nullptr, nullptr);
        for (const DayResult& result : attempt.results)
            csv += row(attempt, &result, places.at(result.profile).at(attempt.id));
    }
    return csv;
}

}  // namespace runcert
