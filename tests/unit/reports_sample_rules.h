#pragma once

#include <string_view>

// The rules of the made-up run of reports_sample.h: two profiles.

namespace runcert::sample {

// clang-format off
inline constexpr std::string_view nalsa_rule = R"yaml(schema: profile/1.0
id: nalsa
body: North American Land Sailing Association
title: top speed of a wind-powered land craft
window: {duration_s: 3, definition: displacement}
accuracy: {limit: 0.8, unit: km/h, coverage_factor: 2}
margin: {kind: absolute, value: 1, unit: mph}
uncertainty: {correlation_time_min_s: 0.5, correlation_time_max_s: 10, selection_bias: covered}
clauses:
  - id: average-over-3-s
    text: Top speed is the average over three consecutive seconds.
    source: "NALSA 2009, quoted in Deakin, Holden & Daddo 2022"
    certainty: quoted
    decided_by: window_complete
  - id: accuracy
    text: "The primary method is accurate to 0.5 mph (0.8 km/h) or better, accuracy being twice the combined measurement uncertainty."
    source: "NALSA 2009, quoted in Deakin, Holden & Daddo 2022"
    certainty: quoted
    decided_by: accuracy
  - id: margin
    text: The new speed exceeds the standing record by at least 1 mph.
    source: press reports of ratified records
    certainty: secondary
    decided_by: margin
  - id: positions-on-the-earth
    text: "The positions are on the Earth, so that their unit is the true metre; where they are engineering coordinates, somebody must answer for the plane's scale."
    source: this program's own requirement
    certainty: quoted
    decided_by: georeferenced
  - id: secondary-method
    text: A secondary method of measurement confirms the primary one.
    source: headings of a published NALSA report
    certainty: secondary
    decided_by: secondary_method
  - id: flat-course
    text: The course is flat within 1 m of elevation.
    source: headings of a published NALSA report
    certainty: secondary
    decided_by: attest
  - id: own-start
    text: The craft starts by itself.
    source: headings of a published NALSA report
    certainty: secondary
    decided_by: attest
  - id: wind-power-only
    text: The craft is powered by the wind only, with no stored energy, and its controls are operated by the pilot.
    source: headings of a published NALSA report
    certainty: secondary
    decided_by: attest
  - id: observers
    text: The observers are named.
    source: headings of a published NALSA report
    certainty: secondary
    decided_by: attest
  - id: measurement-plan
    text: The measurement plan was approved beforehand.
    source: headings of a published NALSA report
    certainty: secondary
    decided_by: attest
)yaml";

inline constexpr std::string_view fisly_rule = R"yaml(schema: profile/1.0
id: fisly
body: International Federation of Sand and Land Yachting (FISLY)
title: top speed of a land yacht
window: {duration_s: 2, definition: displacement}
margin: {kind: relative, value: 0.002}
rounding: {mode: truncate, unit: km/h, decimals: 2}
uncertainty: {correlation_time_min_s: 0.5, correlation_time_max_s: 10, selection_bias: covered}
clauses:
  - id: average-over-2-s
    text: "The speed is taken over 2 s: 21 positions at 10 Hz, both ends included."
    source: press reports of the ratification of December 2022
    certainty: secondary
    decided_by: window_complete
  - id: margin
    text: "The new speed exceeds the standing record by 0.2 %, the required speed being truncated to 0.01 km/h (222.43 gave 222.87)."
    source: press reports of the ratification of December 2022
    certainty: secondary
    decided_by: margin
  - id: positions-on-the-earth
    text: "The positions are on the Earth, so that their unit is the true metre; where they are engineering coordinates, somebody must answer for the plane's scale."
    source: this program's own requirement
    certainty: quoted
    decided_by: georeferenced
  - id: accuracy
    text: A limit of the measurement's uncertainty; none was found in what could be consulted.
    source: not found
    certainty: unconfirmed
    decided_by: attest
  - id: judge-on-site
    text: A judge is on site.
    source: press reports of the ratification of December 2022
    certainty: secondary
    decided_by: attest
  - id: data-within-48-h
    text: The data are handed in within 48 hours.
    source: press reports of the ratification of December 2022
    certainty: secondary
    decided_by: attest
)yaml";
// clang-format on

inline std::string_view rule(std::string_view name) {
    return name == "nalsa" ? nalsa_rule : fisly_rule;
}

}  // namespace runcert::sample
