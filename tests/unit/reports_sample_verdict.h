#pragma once

#include "schemas/verdict/declared.h"

// The verdict of the made-up run of reports_sample.h.

namespace runcert::sample {

inline std::vector<Figure> requirement_figures(Computation decided_by) {
    if (decided_by == Computation::accuracy)
        return {{.name = "expanded uncertainty",
                 .value = 0.018367,
                 .unit = "km/h",
                 .expanded_uncertainty = std::nullopt,
                 .note = "of the budget"},
                {.name = "limit", .value = 0.8, .unit = "km/h"}};
    if (decided_by == Computation::secondary_method)
        return {{.name = "normalised error", .value = 0.37, .unit = {}}};
    return {};
}

inline std::vector<RunSummary> runs(const WindowSpan& whole, const WindowSpan& window) {
    WindowSpan first = whole;
    first.last_epoch = window.first_epoch - 200;
    first.duration.nanoseconds = 18'700'000'000;
    WindowSpan second = whole;
    second.first_epoch = first.last_epoch;
    second.start = {first.duration.nanoseconds};
    if (whole.start_gps)
        second.start_gps = whole.start_gps->plus_nanoseconds(second.start.nanoseconds);
    second.duration.nanoseconds -= first.duration.nanoseconds;
    return {{.span = first,
             .length_m = 312.4567,
             .top_speed_m_s = 41.234567,
             .heading_deg = 225.125,
             .began = RunEdge::recording,
             .ended = RunEdge::turn},
            {.span = second,
             .length_m = 1501.25,
             .top_speed_m_s = 60.012345,
             .heading_deg = 44.9871,
             .began = RunEdge::turn,
             .ended = RunEdge::standing}};
}

inline void fill_verdict(ProfileVerdict& verdict, const RecordToBeat& record,
                         const WindowSpan& whole) {
    verdict.record = record;
    verdict.record->expanded_uncertainty = 0.05;
    verdict.own_arithmetic.text = "The scorers take the displacement. It gives no speed.";
    verdict.notes = {"The wind was not measured by this recording."};
    verdict.overrides = {
        {.figure = "margin.value",
         .rule = 1.0,
         .used = 1.25,
         .unit = "mph",
         .reason = "agreed with the <board>"},
        {.figure = "decision.probability", .rule = 0.975, .used = 0.95, .unit = {}, .reason = {}}};
    for (Requirement& requirement : verdict.requirements)
        requirement.figures = requirement_figures(requirement.decided_by);
    if (!verdict.window) return;
    verdict.decision = Decision{.probability = 0.9999876,
                                .level = 0.95,
                                .required_speed_standard_uncertainty_m_s = 0.006944,
                                .acceptance_limit_m_s = 56.8201,
                                .risk = 1.24e-5};
    verdict.shown = ShownFigures{.unit = "km/h",
                                 .speed = "216.00",
                                 .expanded_uncertainty = "0.019",
                                 .required_speed = "204.51"};
    verdict.course = {{.name = "height difference of the run",
                       .value = 0.421234,
                       .unit = "m",
                       .expanded_uncertainty = 0.0783,
                       .note = "highest less lowest smoothed height"},
                      {.name = "heading", .value = 45.0, .unit = "deg"}};
    verdict.runs = runs(whole, *verdict.window);
}

}  // namespace runcert::sample
