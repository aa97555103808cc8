#include "reports/day/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/product_files.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* again = "Certify the attempt again: `runcert batch` with --force and --only";

DayResult result_of(const ProfileVerdict& verdict) {
    DayResult result{.profile = verdict.profile,
                     .outcome = verdict.outcome,
                     .standing = verdict.standing,
                     .reason = verdict.reason,
                     .speed_m_s = verdict.speed_m_s,
                     .expanded_uncertainty_m_s = verdict.expanded_uncertainty_m_s,
                     .coverage_factor = verdict.coverage_factor,
                     .required_speed_m_s = verdict.required_speed_m_s,
                     .shown = verdict.shown,
                     .rule_origin = verdict.rule.origin};
    result.own_arithmetic = verdict.own_arithmetic.shown;
    if (verdict.window) {
        if (verdict.window->start_gps) result.start_utc = to_utc_iso(*verdict.window->start_gps, 3);
        result.start_time_s = verdict.window->start.seconds();
        result.duration_s = verdict.window->duration.seconds();
    }
    if (verdict.decision) {
        result.probability = verdict.decision->probability;
        result.level = verdict.decision->level;
        result.attempts_made = verdict.decision->attempts_made;
    }
    for (const Override& figure : verdict.overrides)
        result.replaced.push_back(figure.figure);
    return result;
}

/// Keeps of a report, which holds every curve of its figures, what is read below.
bool is_kept(int depth, Json::parse_event_t event, const Json& parsed) {
    static const std::set<std::string> of_statement{"predicate", "subject"};
    static const std::set<std::string> of_predicate{"report_id", "attempt", "figures"};
    if (event == Json::parse_event_t::object_end && depth == 3 && parsed.contains("curves"))
        return parsed.contains("figure_profile");
    if (event != Json::parse_event_t::key || depth > 2) return true;
    const std::string key = parsed.get<std::string>();
    return (depth == 1 ? of_statement : of_predicate).contains(key);
}

/// The smoothed speed around the window of each rule: of the result's figure, else of the window's.
std::vector<WindowCurve> curves_of(const Plots& plots) {
    std::vector<WindowCurve> curves;
    for (const Plot& plot : plots) {
        const auto smoothed = std::ranges::find_if(
            plot.curves, [](const Curve& curve) { return curve.name.starts_with("smoothed"); });
        const bool counts = std::ranges::find(plot.curves, "outline", &Curve::kind) !=
                            plot.curves.end();  // of a rule of another speed nothing is drawn
        if (plot.spans.empty() || !counts || smoothed == plot.curves.end() ||
            std::ranges::find(curves, plot.rule, &WindowCurve::profile) != curves.end())
            continue;
        const PlotSpan& window = plot.spans.front();
        curves.push_back({plot.rule, plot.y_label, window.to - window.from, *smoothed});
        for (double& time_s : curves.back().speed.x)
            time_s -= window.from;
    }
    return curves;
}

}  // namespace

ReportIdentity read_report_identity(std::string_view text, const std::string& where) {
    try {
        const Json report = Json::parse(text, is_kept);
        const Json& predicate = report.at("predicate");
        const Json& attempt = predicate.at("attempt");
        ReportIdentity identity{.report_id = predicate.at("report_id").get<std::string>(),
                                .attempt = attempt.at("id").get<std::string>(),
                                .craft_name = attempt.at("craft_name").get<std::string>(),
                                .craft_class = attempt.at("craft_class").get<std::string>(),
                                .curves = curves_of(read_plots(predicate.at("figures"), where))};
        for (const Json& subject : report.at("subject"))
            if (subject.at("name") == products::verdict_file)
                identity.verdict_sha256 = subject.at("digest").at("sha256").get<std::string>();
        return identity;
    } catch (const Json::exception& fault) {
        throw Failure(where,
                      fmt::format("this is not a measurement report: {}",
                                  escape_for_message(fault.what(), 200)),
                      again);
    }
}

AttemptResult summary_of(const DayOutcome& of, const Verdict& verdict,
                         const std::string& verdict_sha256, const ReportIdentity& report) {
    const std::string& id = of.attempt.id;
    if (verdict.attempt != id)
        throw Failure(id + "/" + std::string(products::verdict_file),
                      fmt::format("the verdict is on the attempt \"{}\", not on \"{}\"",
                                  escape_for_message(verdict.attempt), id),
                      again);
    if (report.attempt != id || report.verdict_sha256 != verdict_sha256)
        throw Failure(
            id + "/report.json",
            fmt::format("the report is not on the verdict {}/{}", id, products::verdict_file),
            again);
    AttemptResult attempt{.id = id,
                          .source = of.attempt.source,
                          .state = of.outcome.state,
                          .craft = DayCraft{report.craft_name, report.craft_class},
                          .report_id = report.report_id,
                          .report = id + "/report.json"};
    for (const ProfileVerdict& profile : verdict.profiles)
        attempt.results.push_back(result_of(profile));
    return attempt;
}

AttemptResult summary_of(const DayOutcome& of) {
    AttemptResult attempt{.id = of.attempt.id,
                          .source = of.attempt.source,
                          .state = of.outcome.state,
                          .reason = of.outcome.reason};
    if (const auto& failure = of.outcome.failure)
        attempt.failure = DayFailure{.step = failure->step,
                                     .problem = failure->problem,
                                     .where = failure->where,
                                     .remedy = failure->remedy};
    return attempt;
}

void add_rules(std::vector<DayProfile>& profiles, const Verdict& verdict) {
    for (const ProfileVerdict& rule : verdict.profiles)
        if (std::ranges::find(profiles, rule.profile, &DayProfile::profile) == profiles.end())
            profiles.push_back({.profile = rule.profile, .body = rule.body, .title = rule.title});
}

}  // namespace runcert
