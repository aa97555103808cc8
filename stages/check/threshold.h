#pragma once

#include <optional>

#include "schemas/profile/declared.h"

namespace runcert {

enum class RoundingMode { truncate, nearest, up };

/// A body's rounding of a speed to decimals of its unit. Of two figures equally near, `nearest`
/// takes the upper one.
struct DecimalRounding {
    RoundingMode mode = RoundingMode::nearest;
    double unit_m_s = 1.0;  ///< metres per second in the unit
    int decimals = 0;       ///< 0 to 9
};

struct MarginRule {
    MarginKind kind = MarginKind::absolute;
    double value = 0.0;       ///< m/s (absolute), a fraction (relative), s (elapsed_time)
    double distance_m = 0.0;  ///< elapsed_time: length of the course
    /// The margin is taken above the record's upper limit, its value plus its expanded uncertainty.
    bool above_upper_limit = false;
    std::optional<DecimalRounding> rounding = std::nullopt;
};

struct StandingRecord {
    double speed_m_s = 0.0;
    double expanded_uncertainty_m_s = 0.0;  ///< k = 2; 0 where none is stated
};

/// The required speed.
struct Threshold {
    double speed_m_s = 0.0;
    /// From the record's own; 0 where it has none or its upper limit was taken.
    double standard_uncertainty_m_s = 0.0;
};

/// The required speed over a record r (its upper limit, where the rule says so): r + value,
/// r (1 + value), or over a course of length D, which the record took t = D / r, D / (t - value);
/// then rounded as the body rounds it. The uncertainty of r is propagated by the derivative of the
/// speed before rounding ([GUM] 5.1). Failure (at "margin") for numbers that are not finite, a
/// record or course not above 0, a negative margin or uncertainty, a time to gain that is not
/// below the record's, or a rounding as below.
Threshold threshold_of(const MarginRule& rule, const StandingRecord& record);

/// A speed (m/s, 0 or more) rounded to decimals of a unit, in m/s.
///
/// A figure that is a decimal one but for binary fractions is that decimal figure: 100 km/h + 0.2 %
/// is 100.20 km/h, which no mode moves. Binary fractions are held to be what is left within 2e-12
/// of the figure (the errors of conversion and margin are some 1e-15), but never more than 5e-7 of
/// the last place. The result is the decimal figure's nearest double times the unit, so that the
/// same figure read from text and converted is equal to it. Failure (at "rounding") for numbers
/// that are not finite, a negative speed, a unit not above 0, decimals outside 0 to 9, or a figure
/// of more than 15 digits.
double rounded_speed(double speed_m_s, const DecimalRounding& rounding);

}  // namespace runcert
