#include "schemas/windows/windows.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "schemas/common/document.h"
#include "schemas/common/members.h"

namespace runcert {

std::string_view windows_schema_text(std::string_view name);

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
inline constexpr auto members<ErrorBound> =
    std::tuple{Member{"tau_min_s", &ErrorBound::tau_min_s},
               Member{"tau_max_s", &ErrorBound::tau_max_s},
               Member{"sigma_m", &ErrorBound::sigma_m},
               Member{"fitted_m", &ErrorBound::fitted_m},
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
               Member{"bias_m_s", &SelectionBias::bias_mps},
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
    Member{"fitted", &CertifiableWindow::fitted},
    Member{"bound", &CertifiableWindow::bound},
    Member{"robust", &CertifiableWindow::robust},
    Member{"selection", &CertifiableWindow::selection},
    Member{"budget", &CertifiableWindow::budget},
    Member{"monte_carlo", &CertifiableWindow::monte_carlo},
    Member{"repaired_steps", &CertifiableWindow::repaired_steps},
    Member{"detection_power", &CertifiableWindow::detection_power},
    Member{"reliability", &CertifiableWindow::reliability},
    Member{"displacement_m", &CertifiableWindow::displacement_m},
    Member{"position_r95_m", &CertifiableWindow::position_r95_m},
    Member{"definitions", &CertifiableWindow::definitions},
    Member{"methods", &CertifiableWindow::methods}};

namespace {

const DocumentSchema& windows_schema() {
    static const DocumentSchema schema = DocumentSchema::parse(
        windows_schema_text("v1.yaml"), "schemas/windows/v1.yaml", &header_schema());
    return schema;
}

Json best_json(const CertifiableWindow& best) {
    Json json = window_span_json(best.span);
    json.update(members_json(best));
    return json;
}

CertifiableWindow read_best(const YamlValue& value) {
    CertifiableWindow best = read_members<CertifiableWindow>(value);
    best.span = read_window_span(value);
    return best;
}

Json indicated_json(const IndicatedWindow& indicated) {
    Json json = window_span_json(indicated.span);
    json["speed_m_s"] = indicated.speed_mps;
    json["certifiable"] = indicated.refusals.empty();
    json["refusals"] = indicated.refusals;
    return json;
}

IndicatedWindow read_indicated(const YamlValue& value) {
    IndicatedWindow indicated{
        .span = read_window_span(value), .speed_mps = value["speed_m_s"].real(), .refusals = {}};
    for (const YamlValue& refusal : value["refusals"].list())
        indicated.refusals.push_back(refusal.text());
    return indicated;
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

std::string write_windows(const Windows& windows) {
    Json json = header_json(windows.header);
    json["receiver"] = windows.receiver;
    if (windows.first_epoch) json["first_epoch_gps"] = to_iso(*windows.first_epoch, 9);
    json["georeferenced"] = windows.georeferenced;
    json["profiles"] = Json::array();
    for (const ProfileWindows& profile : windows.profiles) {
        Json entry{{"profile", profile.profile},
                   {"duration_s", profile.duration_s},
                   {"definition", profile.definition},
                   {"candidates", profile.candidates}};
        if (profile.best) entry["best"] = best_json(*profile.best);
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
                               .duration_s = entry["duration_s"].real(),
                               .definition = entry["definition"].text(),
                               .candidates = entry["candidates"].integer(),
                               .best = std::nullopt,
                               .indicated = std::nullopt};
        if (entry["best"].exists()) profile.best = read_best(entry["best"]);
        if (entry["indicated"].exists()) profile.indicated = read_indicated(entry["indicated"]);
        windows.profiles.push_back(std::move(profile));
    }
    return windows;
}

}  // namespace runcert
