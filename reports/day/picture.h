#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace runcert {

/// One line of the picture of a ranking.
struct PictureLine {
    std::string label;   ///< "1  sail-3"
    std::string figure;  ///< "202.91 ± 0.32"
    std::string tone;    ///< as OutcomeWords
    double speed = 0.0;  ///< all three in one unit
    double expanded_uncertainty = 0.0;
    std::optional<double> required_speed = {};
};

struct Picture {
    std::string title;  ///< for those who do not see it
    std::string unit;
    std::vector<PictureLine> lines;
};

/// Speeds with their uncertainties as bars, line by line, and the speeds to reach: SVG for a page
/// whose style has the classes of `template/day.css`. As wide as where it stands, in letters that
/// keep their size.
std::string picture_svg(const Picture& picture);

}  // namespace runcert
