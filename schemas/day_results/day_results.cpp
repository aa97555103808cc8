#include "schemas/day_results/day_results.h"

#include <algorithm>

#include "schemas/common/document.h"
#include "schemas/common/members.h"

namespace runcert {

YamlNode day_results_field_table_node();

using Json = nlohmann::ordered_json;

// Members as `schemas/day_results/v1.yaml` names them.

template <>
inline constexpr auto members<DayFailure> =
    std::tuple{Member{"step", &DayFailure::step}, Member{"problem", &DayFailure::problem},
               Member{"where", &DayFailure::where}, Member{"remedy", &DayFailure::remedy}};

template <>
inline constexpr auto members<DayShown> =
    std::tuple{Member{"unit", &DayShown::unit}, Member{"speed", &DayShown::speed},
               Member{"expanded_uncertainty", &DayShown::expanded_uncertainty},
               Member{"target", &DayShown::target}};

template <>
inline constexpr auto members<DayCraft> =
    std::tuple{Member{"name", &DayCraft::name}, Member{"class", &DayCraft::craft_class}};

template <>
inline constexpr auto members<DayResult> =
    std::tuple{Member{"profile", &DayResult::profile},
               Member{"outcome", &DayResult::outcome},
               Member{"reason", &DayResult::reason},
               Member{"speed_m_s", &DayResult::speed_mps},
               Member{"expanded_uncertainty_m_s", &DayResult::expanded_uncertainty_mps},
               Member{"coverage_factor", &DayResult::coverage_factor},
               Member{"target_m_s", &DayResult::target_mps},
               Member{"shown", &DayResult::shown},
               Member{"start_utc", &DayResult::start_utc},
               Member{"start_time_s", &DayResult::start_time_s},
               Member{"duration_s", &DayResult::duration_s},
               Member{"replaced", &DayResult::replaced},
               Member{"probability", &DayResult::probability},
               Member{"level", &DayResult::level},
               Member{"attempts_made", &DayResult::attempts_made}};

template <>
inline constexpr auto members<BestOfDay> =
    std::tuple{Member{"id", &BestOfDay::id}, Member{"attempts", &BestOfDay::attempts},
               Member{"probability", &BestOfDay::probability}, Member{"level", &BestOfDay::level},
               Member{"beaten", &BestOfDay::beaten}};

template <>
inline constexpr auto members<AttemptResult> =
    std::tuple{Member{"id", &AttemptResult::id},
               Member{"source", &AttemptResult::source},
               Member{"state", &AttemptResult::state},
               Member{"failure", &AttemptResult::failure},
               Member{"reason", &AttemptResult::reason},
               Member{"craft", &AttemptResult::craft},
               Member{"report_id", &AttemptResult::report_id},
               Member{"report", &AttemptResult::report},
               Member{"pages", &AttemptResult::pages},
               Member{"notes", &AttemptResult::notes},
               Member{"results", &AttemptResult::results}};

template <>
inline constexpr auto members<DayPlace> =
    std::tuple{Member{"rank", &DayPlace::rank}, Member{"id", &DayPlace::id},
               Member{"not_told_apart_up_to", &DayPlace::not_told_apart_up_to},
               Member{"not_told_apart_down_to", &DayPlace::not_told_apart_down_to}};

template <>
inline constexpr auto members<OutcomeCounts> = std::tuple{
    Member{"beaten", &OutcomeCounts::beaten}, Member{"not_proven", &OutcomeCounts::not_proven},
    Member{"not_beaten", &OutcomeCounts::not_beaten},
    Member{"not_certifiable", &OutcomeCounts::not_certifiable}};

template <>
inline constexpr auto members<DayProfile> =
    std::tuple{Member{"profile", &DayProfile::profile}, Member{"body", &DayProfile::body},
               Member{"title", &DayProfile::title},     Member{"counts", &DayProfile::counts},
               Member{"ranking", &DayProfile::ranking}, Member{"best", &DayProfile::best}};

template <>
inline constexpr auto members<DayCounts> = std::tuple{
    Member{"attempts", &DayCounts::attempts}, Member{"done", &DayCounts::done},
    Member{"failed", &DayCounts::failed}, Member{"not_processed", &DayCounts::not_processed},
    Member{"beaten", &DayCounts::beaten}};

template <>
inline constexpr auto members<DayResults> =
    std::tuple{Member{"day", &DayResults::day}, Member{"counts", &DayResults::counts},
               Member{"attempts", &DayResults::attempts}, Member{"profiles", &DayResults::profiles},
               Member{"notes", &DayResults::notes}};

namespace {

const DocumentSchema& day_results_schema() {
    static const DocumentSchema schema = DocumentSchema::read(
        day_results_field_table_node(), "schemas/day_results/v1.yaml", &header_schema());
    return schema;
}

}  // namespace

const DayResult* AttemptResult::by(std::string_view profile) const {
    const auto found = std::ranges::find(results, profile, &DayResult::profile);
    return found == results.end() ? nullptr : &*found;
}

std::string write_day_results(const DayResults& results) {
    Json json = header_json(results.header);
    json.update(members_json(results));
    return write_document(std::move(json), day_results_schema());
}

DayResults read_day_results(std::string_view text, const std::string& where) {
    const YamlValue document = read_document(text, where, day_results_schema());
    DayResults results = read_members<DayResults>(document);
    results.header = read_header(document);
    return results;
}

}  // namespace runcert
