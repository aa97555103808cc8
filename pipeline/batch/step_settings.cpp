#include "batch/step_settings.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "run/attempt_files.h"
#include "run/steps.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

/// Keys of an attempt whose effect is in what follows by other ways: the first group is read by
/// "claim", "check" and "report" alone, which depend on the whole text; the second by the steps
/// that name them below.
constexpr std::array attempt_elsewhere{
    "schema", "id",     "craft",   "place",    "date",       "officials",     "signatures",
    "amends", "record", "records", "wind",     "current",    "secondary",     "receivers",
    "origin", "course", "rules",   "profiles", "parameters", "attempts_made", "wheel",
    "gates"};

/// Keys of a profile that only "check" and "report" read, but for what `proof_figures` takes.
constexpr std::array profile_of_check{"schema",   "revision", "body",       "title",
                                      "accuracy", "margin",   "rounding",   "result",
                                      "decision", "current",  "signatures", "clauses"};

/// Figures of a profile that the attempt may replace and that only "check" and "report" read.
bool is_figure_of_check(const std::string& figure) {
    return figure.starts_with("margin.") || figure == "accuracy.limit" ||
           figure.starts_with("decision.");
}

/// What the choice of a window takes of what is otherwise the verdict's: the coverage factor, and
/// the rate of epochs that a clause asks for.
Json proof_figures(const Json& profile) {
    Json figures{{"coverage_factor",
                  profile.value("accuracy", Json::object()).value("coverage_factor", Json())},
                 {"clauses", Json::array()}};
    for (const Json& clause : profile.value("clauses", Json::array()))
        if (clause.value("decided_by", "") == "sampling_rate")
            figures["clauses"].push_back(clause.value("limit", Json()));
    return figures;
}

Json without(Json document, auto&& keys) {
    for (const char* key : keys)
        document.erase(key);
    return document;
}

Json files_of(const Receiver& receiver) {
    Json files = Json::array();
    for (const AttemptFile& file : files_of_receiver(receiver))
        files.push_back(file.original);
    return files;
}

/// The receiver as import reads it.
Json import_settings(const Attempt& attempt, const Receiver& receiver) {
    return {{"id", receiver.id},
            {"files", files_of(receiver)},
            {"stated", *attempt.stated.at(receiver.id)}};
}

Json receiver_ids(const Attempt& attempt) {
    Json ids = Json::array();
    for (const Receiver& receiver : attempt.receivers)
        ids.push_back(receiver.id);
    return ids;
}

Json window_rules(const Json& document) {
    Json rules = Json::array();
    for (const Json& rule : document.value("rules", Json::array()))
        if (!is_figure_of_check(rule.value("figure", ""))) rules.push_back(rule);
    return rules;
}

void add_window_settings(Json& settings, const Json& document,
                         const std::vector<HeldJson>& profiles) {
    settings["course"] = document.value("course", Json());
    settings["rules"] = window_rules(document);
    for (const Json& receiver : document.at("receivers"))
        settings["antennas"].push_back(
            {{"lever_arm_m", receiver.value("lever_arm_m", Json())},
             {"rotation_bound_deg", receiver.value("rotation_bound_deg", Json())}});
    settings["profiles"] = Json::array();
    for (const HeldJson& profile : profiles) {
        settings["profiles"].push_back(without(profile, profile_of_check));
        settings["profiles"].back()["proof"] = proof_figures(*profile);
    }
}

}  // namespace

Json settings_of_step(std::string_view step, const Attempt& attempt, const Json& document,
                      const std::vector<HeldJson>& profiles, const ReportChoice& choice) {
    if (step == "claim" || step == "report") return Json::object();  // inputs are all they use
    if (step == "sign") return {{"signer", choice.signer}};
    if (step == "render") return {{"pdf", choice.pdf}};
    Json settings = without(document, attempt_elsewhere);
    if (step == "import") {
        for (const Receiver& receiver : attempt.receivers)
            settings["receivers"].push_back(import_settings(attempt, receiver));
        return settings;
    }
    settings["receivers"] = receiver_ids(attempt);
    if (step == "enu") settings["origin"] = document.value("origin", Json());
    const auto parameters = attempt.parameters.find(std::string(step));
    if (parameters != attempt.parameters.end()) settings["parameters"] = *parameters->second;
    for (const std::string_view series : step_named(step).hears)
        if (document.contains(series))
            settings[std::string(series)] =
                without(document.at(std::string(series)), std::array{"source"});
    if (step == "screen" || step == "window")
        for (const Receiver& receiver : attempt.receivers)
            settings["phases"].push_back(has_phases(receiver));
    if (step == "screen")
        for (const char* shared : {"error_time_min_s", "error_time_max_s"})
            settings["smooth"][shared] = attempt.parameters.at("smooth").at(shared);
    if (step == "window") {
        for (const char* shared : {"gap_max_s", "gap_factor", "phase_mask_deg"})
            settings["screen"][shared] = attempt.parameters.at("screen").at(shared);
        add_window_settings(settings, document, profiles);
    }
    return settings;
}

}  // namespace runcert
