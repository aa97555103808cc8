#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace runcert {

/// The part of a gnuplot script that draws one of the report's figures into the file named. Texts
/// are quoted, so that none of them is taken for an instruction.
std::string gnuplot_script(const nlohmann::ordered_json& figure, const std::string& svg_file);

}  // namespace runcert
