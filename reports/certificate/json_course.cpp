#include "reports/certificate/json_course.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_rule.h"
#include "reports/certificate/json_window.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

Json quantity_json(const Figure& figure) {
    Json json = members_json(figure);
    json["quantity_text"] = figure_value_text(figure);
    return json;
}

std::string began_words(RunEdge began) {
    const char* preposition = began == RunEdge::recording  ? "with"
                              : began == RunEdge::standing ? "from"
                                                           : "after";
    return fmt::format("{} {}", preposition, words_of(began));
}

std::string ended_words(RunEdge ended) {
    return fmt::format("{} {}", ended == RunEdge::recording ? "with" : "at", words_of(ended));
}

bool holds(const WindowSpan& run, const std::optional<WindowSpan>& window) {
    const auto end_ns = [](const WindowSpan& span) {
        return span.start.nanoseconds + span.duration.nanoseconds;
    };
    return window && run.start.nanoseconds <= window->start.nanoseconds &&
           end_ns(*window) <= end_ns(run);
}

Json run_json(const RunSummary& run, std::size_t number, const ProfileVerdict& verdict,
              const SpeedUnit& unit) {
    Json json{{"run", number}};
    json.update(members_json(run));
    set_end(json, run.span);
    json["holds_window"] = holds(run.span, verdict.window);
    json["run_start"] = seconds_text(run.span.start);
    json["run_time"] = seconds_text(run.span.duration);
    json["run_length"] = format_fixed(run.length_m, 1) + " m";
    json["run_speed"] =
        fmt::format("{} {}", speed_text(run.top_speed_m_s, std::nullopt, unit), unit.name);
    json["run_heading"] = format_fixed(run.heading_deg, 1) + "°";
    json["run_words"] =
        fmt::format("begins {}, ends {}", began_words(run.began), ended_words(run.ended));
    return json;
}

}  // namespace

Json quantities_json(const std::vector<Figure>& figures) {
    Json list = Json::array();
    for (const Figure& figure : figures)
        list.push_back(quantity_json(figure));
    return list;
}

void set_course(Json& json, const ProfileVerdict& verdict, const Profile& profile) {
    if (!verdict.course.empty()) json["course"] = quantities_json(verdict.course);
    for (std::size_t i = 0; i < verdict.runs.size(); ++i)
        json["runs"].push_back(run_json(verdict.runs[i], i + 1, verdict, rule_unit(profile)));
}

}  // namespace runcert
