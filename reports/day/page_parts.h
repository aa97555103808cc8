#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/day/day.h"
#include "schemas/document/document.h"
#include "schemas/verdict/outcome.h"

namespace runcert {

/// One rule: its counts, its pictures and its ranking.
struct RankingPart {
    Section section;
    std::vector<std::string> pictures;  ///< of that number and the next ones
};
RankingPart ranking_part(const DayProfile& profile, const AttemptsById& attempts,
                         const WindowCurves& curves, std::size_t number);

/// What the title of a result speaks of.
OutcomeState state_of(const DayResult& result);

/// "2022-03-18 08:51:22.300 UTC", "12.340 s after the first epoch"; empty without a window.
std::string window_words(const DayResult& result);

/// "cannot be separated from rank 2", "... from ranks 1 to 4"; empty where both neighbours are.
/// `above` and `below` are the ranks next to its own.
std::string told_apart_words(const DayPlace& place, std::optional<std::int64_t> above,
                             std::optional<std::int64_t> below);

/// What the best of the day's attempts is as the best of so many, in a sentence.
std::string best_words(const BestOfDay& best);

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
    std::string unit = {};
    std::vector<PictureLine> lines = {};
};

/// Speeds with their uncertainties as bars, and required speeds: SVG for a page with the classes of
/// `template/day.css`, as wide as where it stands, in letters that keep their size.
std::string picture_svg(const Picture& picture);

/// Windows laid over one another from their starts, with the labels of their runs.
struct Overlay {
    struct Run {
        std::string label;  ///< "1 · sail-3"
        const WindowCurve* curve = nullptr;
    };
    std::string title;           ///< for those who do not see it
    std::vector<Run> runs = {};  ///< of one quantity
};

/// So many runs differ in colour and dashes.
inline constexpr std::size_t overlaid_at_most = 6;

/// The speeds around the windows over time: bold within each window. SVG as `picture_svg`.
std::string overlay_svg(const Overlay& overlay);

/// Where the lines of an axis stand: 1, 2 or 5 times a power of ten, three to six of them.
double tick_step(double span);

/// Text as SVG has it.
std::string svg_text(const std::string& text);

}  // namespace runcert
