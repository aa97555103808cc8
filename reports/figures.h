#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace runcert {

/// A drawn figure, ready to stand in a page: an <svg> element whose ids no other figure has.
struct DrawnFigure {
    std::string title;
    std::string caption;
    std::string svg;
};

/// Draws the figures that a report lists, with gnuplot, straight from the tables of the judged
/// receiver in the run folder. The same tables give the same bytes. Failure where gnuplot is
/// missing or fails, and where a table is not the one that the report vouches for.
std::vector<DrawnFigure> draw_figures(const std::filesystem::path& run_folder,
                                      const nlohmann::ordered_json& predicate);

}  // namespace runcert
