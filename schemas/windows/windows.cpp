#include "schemas/windows/windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/uncertainty.h"
#include "schemas/common/document.h"
#include "schemas/common/members.h"

namespace runcert {

YamlNode windows_field_table_node();

using Json = nlohmann::ordered_json;

// The members of a window's maps, as `schemas/windows/v1.yaml` names them.

template <>
inline constexpr auto members<BudgetRow> =
    std::tuple{Member{"symbol", &BudgetRow::symbol},
               Member{"source", &BudgetRow::source},
               Member{"estimate", &BudgetRow::estimate},
               Member{"unit", &BudgetRow::unit},
               Member{"standard_uncertainty", &BudgetRow::standard_uncertainty},
               Member{"type", &BudgetRow::type},
               Member{"distribution", &BudgetRow::distribution},
               Member{"degrees_of_freedom", &BudgetRow::degrees_of_freedom},
               Member{"sensitivity", &BudgetRow::sensitivity},
               Member{"contribution_m_s", &BudgetRow::contribution_mps},
               Member{"correlation", &BudgetRow::correlation},
               Member{"note", &BudgetRow::note}};

template <>
inline constexpr auto members<FittedSpeed> =
    std::tuple{Member{"speed_m_s", &FittedSpeed::speed_mps},
               Member{"standard_uncertainty_m_s", &FittedSpeed::standard_uncertainty_mps},
               Member{"models", &FittedSpeed::models}};

template <>
inline constexpr auto members<OtherEstimates> = std::tuple{
    Member{"chord_m_s", &OtherEstimates::chord_mps},
    Member{"chord_difference_uncertainty_m_s", &OtherEstimates::chord_difference_uncertainty_mps},
    Member{"stiffer_m_s", &OtherEstimates::stiffer_mps},
    Member{"softer_m_s", &OtherEstimates::softer_mps},
    Member{"whole_m_s", &OtherEstimates::whole_mps},
    Member{"half_width_m_s", &OtherEstimates::half_width_mps}};

template <>
inline constexpr auto members<ErrorBound> =
    std::tuple{Member{"tau_min_s", &ErrorBound::tau_min_s},
               Member{"tau_max_s", &ErrorBound::tau_max_s},
               Member{"sigma_m", &ErrorBound::sigma_m},
               Member{"fitted_m", &ErrorBound::fitted_m},
               Member{"along", &ErrorBound::along},
               Member{"stated_m", &ErrorBound::stated_m},
               Member{"floor_m", &ErrorBound::floor_m},
               Member{"floor_fix", &ErrorBound::floor_fix},
               Member{"decided_by", &ErrorBound::decided_by},
               Member{"standard_uncertainty_m_s", &ErrorBound::standard_uncertainty_mps}};

template <>
inline constexpr auto members<RobustSpeed> =
    std::tuple{Member{"speed_m_s", &RobustSpeed::speed_mps},
               Member{"difference_m_s", &RobustSpeed::difference_mps},
               Member{"limit_m_s", &RobustSpeed::limit_mps}, Member{"agrees", &RobustSpeed::agrees},
               Member{"downweighted", &RobustSpeed::downweighted}};

template <>
inline constexpr auto members<SelectionBias> =
    std::tuple{Member{"candidates", &SelectionBias::candidates},
               Member{"chosen_mean_m_s", &SelectionBias::chosen_mean_mps},
               Member{"chosen_sd_m_s", &SelectionBias::chosen_sd_mps},
               Member{"best_mean_m_s", &SelectionBias::best_mean_mps},
               Member{"best_sd_m_s", &SelectionBias::best_sd_mps},
               Member{"fitted_bias_m_s", &SelectionBias::fitted_bias_mps},
               Member{"bounded_bias_m_s", &SelectionBias::bounded_bias_mps},
               Member{"bias_m_s", &SelectionBias::bias_mps},
               Member{"bias_half_range_m_s", &SelectionBias::bias_half_range_mps},
               Member{"bias_uncertainty_m_s", &SelectionBias::bias_uncertainty_mps},
               Member{"treatment", &SelectionBias::treatment},
               Member{"samples", &SelectionBias::samples},
               Member{"seed", &SelectionBias::seed}};

template <>
inline constexpr auto members<MonteCarloCheck> =
    std::tuple{Member{"seed", &MonteCarloCheck::seed},
               Member{"trials", &MonteCarloCheck::trials},
               Member{"mean_m_s", &MonteCarloCheck::mean_mps},
               Member{"standard_uncertainty_m_s", &MonteCarloCheck::standard_uncertainty_mps},
               Member{"lower_m_s", &MonteCarloCheck::lower_mps},
               Member{"upper_m_s", &MonteCarloCheck::upper_mps},
               Member{"tolerance_m_s", &MonteCarloCheck::tolerance_mps},
               Member{"converged", &MonteCarloCheck::converged}};

template <>
inline constexpr auto members<UndetectedError> =
    std::tuple{Member{"hypothesis", &UndetectedError::hypothesis},
               Member{"epoch", &UndetectedError::epoch},
               Member{"last_epoch", &UndetectedError::last_epoch},
               Member{"size", &UndetectedError::size},
               Member{"unit", &UndetectedError::unit},
               Member{"speed_m_s", &UndetectedError::speed_mps}};

template <>
inline constexpr auto members<SpeedDefinitions> =
    std::tuple{Member{"displacement_m_s", &SpeedDefinitions::displacement_mps},
               Member{"path_length_m_s", &SpeedDefinitions::path_length_mps},
               Member{"mean_n_plus_1_m_s", &SpeedDefinitions::mean_n_plus_1_mps},
               Member{"mean_n_m_s", &SpeedDefinitions::mean_n_mps}};

template <>
inline constexpr auto members<MethodMeans> = std::tuple{
    Member{"smoothed_m_s", &MethodMeans::smoothed_mps},
    Member{"batch_m_s", &MethodMeans::batch_mps}, Member{"v1_m_s", &MethodMeans::v1_mps},
    Member{"v2_m_s", &MethodMeans::v2_mps}, Member{"kalman_m_s", &MethodMeans::kalman_mps}};

template <>
inline constexpr auto members<CertifiableWindow> = std::tuple{
    Member{"arc", &CertifiableWindow::arc},
    Member{"speed_m_s", &CertifiableWindow::speed_mps},
    Member{"standard_uncertainty_m_s", &CertifiableWindow::standard_uncertainty_mps},
    Member{"effective_degrees_of_freedom", &CertifiableWindow::effective_degrees_of_freedom},
    Member{"own_standard_uncertainty_m_s", &CertifiableWindow::own_standard_uncertainty_mps},
    Member{"bias_limit_m_s", &CertifiableWindow::bias_limit_mps},
    Member{"fitted", &CertifiableWindow::fitted},
    Member{"estimates", &CertifiableWindow::estimates},
    Member{"bound", &CertifiableWindow::bound},
    Member{"robust", &CertifiableWindow::robust},
    Member{"selection", &CertifiableWindow::selection},
    Member{"budget", &CertifiableWindow::budget},
    Member{"monte_carlo", &CertifiableWindow::monte_carlo},
    Member{"repaired_steps", &CertifiableWindow::repaired_steps},
    Member{"detection_power", &CertifiableWindow::detection_power},
    Member{"reliability", &CertifiableWindow::reliability},
    Member{"length_m", &CertifiableWindow::length_m},
    Member{"displacement_m", &CertifiableWindow::displacement_m},
    Member{"position_r95_m", &CertifiableWindow::position_r95_m},
    Member{"definitions", &CertifiableWindow::definitions},
    Member{"methods", &CertifiableWindow::methods}};

template <>
inline constexpr auto members<FurtherWindow> =
    std::tuple{Member{"arc", &FurtherWindow::arc}, Member{"speed_m_s", &FurtherWindow::speed_mps},
               Member{"standard_uncertainty_m_s", &FurtherWindow::standard_uncertainty_mps},
               Member{"bias_limit_m_s", &FurtherWindow::bias_limit_mps},
               Member{"robust", &FurtherWindow::robust}};

namespace {

const DocumentSchema& windows_schema() {
    static const DocumentSchema schema = DocumentSchema::read(
        windows_field_table_node(), "schemas/windows/v1.yaml", &header_schema());
    return schema;
}

/// A window's span and members in one map, and back.
template <class Window>
Json window_json(const Window& window) {
    Json json = window_span_json(window.span);
    json.update(members_json(window));
    return json;
}

template <class Window>
Window read_window(const YamlValue& value) {
    Window window = read_members<Window>(value);
    window.span = read_window_span(value);
    return window;
}

Json indicated_json(const IndicatedWindow& indicated) {
    Json json = window_span_json(indicated.span);
    json["speed_m_s"] = indicated.speed_mps;
    set_optional(json, "mean_m_s", indicated.mean_mps);
    json["certifiable"] = indicated.refusals.empty();
    json["refusals"] = indicated.refusals;
    return json;
}

IndicatedWindow read_indicated(const YamlValue& value) {
    IndicatedWindow indicated{.span = read_window_span(value),
                              .speed_mps = value["speed_m_s"].real(),
                              .mean_mps = value["mean_m_s"].optional_real(),
                              .refusals = {}};
    for (const YamlValue& refusal : value["refusals"].list())
        indicated.refusals.push_back(refusal.text());
    return indicated;
}

void write_rule(Json& json, const WindowRule& rule) {
    json["kind"] = rule.kind;
    if (rule.kind == "time")
        json["duration_s"] = rule.duration_s;
    else
        json["distance_m"] = rule.distance_m;
    json["definition"] = rule.definition;
    json["dimension"] = rule.dimension;
    json["source"] = rule.source;
    json["ends"] = rule.ends;
    json["exact"] = rule.exact;
    json["count"] = rule.count;
    json["opposite_runs"] = rule.opposite_runs;
}

WindowRule read_rule(const YamlValue& entry) {
    const WindowRule before;  // revision 1.3, which named them
    return {.kind = entry["kind"].text_or(before.kind),
            .duration_s = entry["duration_s"].optional_real().value_or(0.0),
            .distance_m = entry["distance_m"].optional_real().value_or(0.0),
            .definition = entry["definition"].text(),
            .dimension = entry["dimension"].text_or(before.dimension),
            .source = entry["source"].text_or(before.source),
            .ends = entry["ends"].text_or(before.ends),
            .exact = entry["exact"].exists() && entry["exact"].boolean(),
            .count = entry["count"].optional_integer().value_or(before.count),
            .opposite_runs = entry["opposite_runs"].exists() && entry["opposite_runs"].boolean()};
}

}  // namespace

double SpeedDefinitions::by_name(std::string_view name) const {
    if (name == "displacement") return displacement_mps;
    if (name == "path_length") return path_length_mps;
    if (name == "mean_n_plus_1") return mean_n_plus_1_mps;
    if (name == "mean_n") return mean_n_mps;
    throw Failure("definition of speed", fmt::format("\"{}\" is not known", name),
                  "Use displacement, path_length, mean_n_plus_1 or mean_n");
}

LinearisationJudgement judge_linearisation(const CertifiableWindow& window) {
    constexpr double probability = 0.95;
    const MonteCarloCheck& check = window.monte_carlo.value();
    const double half_width_mps =
        coverage_factor(probability, window.effective_degrees_of_freedom) *
        window.standard_uncertainty_mps;
    const auto agree = [&](double drawn, double propagated) {
        return std::abs(drawn - propagated) <= check.tolerance_mps;
    };
    LinearisationJudgement judged{.lower_mps = window.speed_mps - half_width_mps,
                                  .upper_mps = window.speed_mps + half_width_mps};
    judged.uncertainty_agrees =
        agree(check.standard_uncertainty_mps, window.standard_uncertainty_mps);
    judged.interval_agrees =
        agree(check.lower_mps, judged.lower_mps) && agree(check.upper_mps, judged.upper_mps);
    judged.interval_holds =
        judged.lower_mps <= check.lower_mps && judged.upper_mps >= check.upper_mps;
    return judged;
}

double expanded_uncertainty_by_rule_mps(const CertifiableWindow& window, double rule_factor) {
    return expanded_uncertainty_mps(
        window, equivalent_coverage_factor(rule_factor, window.effective_degrees_of_freedom));
}

double expanded_uncertainty_by_rule_mps(const RuleFigure& figure, double rule_factor) {
    return expanded_uncertainty_mps(
        figure, equivalent_coverage_factor(rule_factor, figure.effective_degrees_of_freedom));
}

std::optional<RuleFigure> ProfileWindows::figure() const {
    const std::size_t wanted = rule.opposite_runs ? 2 : static_cast<std::size_t>(rule.count);
    if (!best || further.size() + 1 < wanted) return std::nullopt;
    RuleFigure figure{.speed_mps = best->speed_mps,
                      .standard_uncertainty_mps = best->standard_uncertainty_mps,
                      .effective_degrees_of_freedom = best->effective_degrees_of_freedom,
                      .bias_limit_mps = best->bias_limit_mps};
    for (const FurtherWindow& one : further) {
        figure.speed_mps += one.speed_mps;
        figure.standard_uncertainty_mps += one.standard_uncertainty_mps;
        figure.bias_limit_mps += one.bias_limit_mps;
    }
    const auto count = static_cast<double>(further.size() + 1);
    figure.speed_mps /= count;
    figure.standard_uncertainty_mps /= count;
    figure.bias_limit_mps /= count;
    return figure;
}

const ProfileWindows* Windows::of(std::string_view profile) const {
    const auto found = std::ranges::find(profiles, profile, &ProfileWindows::profile);
    return found == profiles.end() ? nullptr : &*found;
}

std::string write_windows(const Windows& windows) {
    Json json = header_json(windows.header);
    json["receiver"] = windows.receiver;
    if (windows.first_epoch) json["first_epoch_gps"] = to_iso(*windows.first_epoch, 9);
    json["georeferenced"] = windows.georeferenced;
    json["profiles"] = Json::array();
    for (const ProfileWindows& profile : windows.profiles) {
        Json entry{{"profile", profile.profile}};
        write_rule(entry, profile.rule);
        entry["candidates"] = profile.candidates;
        if (!profile.missing.empty()) entry["missing"] = profile.missing;
        if (profile.best) entry["best"] = window_json(*profile.best);
        if (!profile.further.empty()) entry["further"] = Json::array();
        for (const FurtherWindow& further : profile.further)
            entry["further"].push_back(window_json(further));
        if (profile.indicated) entry["indicated"] = indicated_json(*profile.indicated);
        json["profiles"].push_back(std::move(entry));
    }
    return write_document(std::move(json), windows_schema());
}

Windows read_windows(std::string_view text, const std::string& where) {
    const YamlValue document = read_document(text, where, windows_schema());
    Windows windows;
    windows.header = read_header(document);
    windows.receiver = document["receiver"].text();
    windows.first_epoch = read_gps_time(document["first_epoch_gps"]);
    windows.georeferenced = document["georeferenced"].boolean();
    for (const YamlValue& entry : document["profiles"].list()) {
        ProfileWindows profile{.profile = entry["profile"].text(),
                               .rule = read_rule(entry),
                               .candidates = entry["candidates"].integer(),
                               .missing = entry["missing"].text_or(""),
                               .best = std::nullopt,
                               .indicated = std::nullopt};
        if (entry["best"].exists()) profile.best = read_window<CertifiableWindow>(entry["best"]);
        if (entry["further"].exists())
            for (const YamlValue& further : entry["further"].list())
                profile.further.push_back(read_window<FurtherWindow>(further));
        if (entry["indicated"].exists()) profile.indicated = read_indicated(entry["indicated"]);
        windows.profiles.push_back(std::move(profile));
    }
    return windows;
}

}  // namespace runcert
