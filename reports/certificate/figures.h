#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace runcert {

/// Draws the figures that a report holds, each as the text of an SVG, with gnuplot and from nothing
/// but the report; empty for a figure whose points the report does not hold. The same report gives
/// the same bytes. Failure where gnuplot is missing or fails.
std::vector<std::string> draw_figures(const nlohmann::ordered_json& predicate);

}  // namespace runcert
