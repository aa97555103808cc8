#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/prose.h"
#include "schemas/verdict/verdict.h"

// The words that the parts of an explanation share.

namespace runcert {

/// "  Its source        headings of a published report": a line of a block, with its label.
std::string labelled(std::string_view label, std::string_view text);

/// "NOT MET  nalsa/flat-course": the first line of a block, its outcome in capitals.
std::string heading(std::string_view outcome, std::string_view text);

/// A capital at the beginning and a full stop at the end.
std::string sentence(std::string text);

/// A plain figure in its shortest form: "0.8", "1000"; with its unit, where it has one.
std::string plain_figure(double value, std::string_view unit);

/// A quantity with its expanded uncertainty: "height difference: 0.42 m +/- 0.08 m (k = 2); why".
/// Decimals are those of two significant digits of the uncertainty; without one, six significant
/// digits at most.
std::string figure_words(const Figure& figure);

/// A speed with three decimals, in the rule's unit, and in km/h beside it where that is another.
std::string speed_words(double speed_m_s, std::string_view unit);
/// An uncertainty of a speed, with two significant digits, rounded up.
std::string uncertainty_words(double uncertainty_m_s, std::string_view unit);

}  // namespace runcert
