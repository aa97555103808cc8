#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/gps_time.h"
#include "core/prose.h"
#include "core/rounding.h"
#include "schemas/verdict/declared.h"

// Figures and units as people read them: the one place that writes them. A measured speed is
// rounded down, an expanded uncertainty, a required speed and an acceptance limit up, so that what
// is shown never claims more than what was computed (`SpeedKind`).

namespace runcert {

/// A unit in which speeds are given.
struct SpeedUnit {
    std::string_view key;   ///< in the names of fields: "km_h"
    std::string_view name;  ///< as written: "km/h"
    double per_m_s = 1.0;   ///< so many of it are 1 m/s
    int decimals = 2;       ///< of a speed that is shown
    int decimals_kept = 4;  ///< of a speed in the report's fields
};

/// km/h, m/s, kn, mph (knot 1852 m/h, statute mile 1609.344 m, both exact).
const std::array<SpeedUnit, 4>& speed_units();

/// The one of that name ("km/h"), km/h where it is empty. Failure where it is not known.
const SpeedUnit& speed_unit(std::string_view name);

/// A standard uncertainty or another small size, rounded to two significant digits: "0.018".
std::string uncertainty_text(double uncertainty);

/// So many significant digits: "0.00058", "-72.0", "4100"; "0"; below 1e-6 as scientific_text;
/// "not determined" of what is no finite number.
std::string significant_text(double value, int digits);

/// A figure in its shortest form, with its unit where it has one: "202.9", "1000 m".
std::string number_text(double value, std::string_view unit = {});

/// A quantity with its expanded uncertainty, rounded up to two significant digits, and the unit
/// with both: "0.42 m ± 0.08 m"; without an uncertainty with six significant digits at most.
std::string quantity_text(double value, std::optional<double> expanded_uncertainty = std::nullopt,
                          std::string_view unit = {});

/// As the verdict shows the figure, else by `quantity_text`: "0.42 m ± 0.08 m (k = 2)".
std::string figure_value_text(const Figure& figure);

/// With its name and note: "height difference: 0.42 m ± 0.08 m (k = 2); above the ellipsoid".
std::string figure_text(const Figure& figure);

/// A coverage factor with at most two decimals: "2", "2.07".
std::string coverage_text(double coverage_factor);

/// A speed that is not the measured one, rounded to the nearest, with the decimals usual for its
/// unit or, where these are more, those of its uncertainty: "216.009".
std::string speed_text(double speed_m_s, std::optional<double> uncertainty_m_s,
                       const SpeedUnit& unit);

/// A speed with its expanded uncertainty, rounded to the safe side: "216.00 km/h ± 0.02 km/h".
std::string speed_with_uncertainty_text(double speed_m_s, double expanded_uncertainty_m_s,
                                        const SpeedUnit& unit);

/// What a speed that is shown is. It decides to which side it is rounded.
enum class SpeedKind {
    measured,     ///< down
    uncertainty,  ///< up: an expanded uncertainty, a guard band
    required,     ///< up
    limit,        ///< up: an acceptance limit
    plain         ///< to the nearest: a record, a current
};

/// Files keep speeds to 0.000001 m/s. A speed is shown as it is kept, so that it is the same
/// wherever it is shown; and one this near to a decimal figure of any unit counts as that figure:
/// 124.666667 m/s is 448.8000012 km/h, and 448.8 km/h was meant.
inline constexpr int speed_decimals_kept = 6;
inline constexpr double speed_guard_m_s = 0.6e-6;

/// A speed in a unit, with so many decimals. The one table by which speeds are rounded. Failure (at
/// "rounding") for one that is not finite.
std::string shown_speed(SpeedKind kind, double speed_m_s, int decimals, const SpeedUnit& unit);

/// A speed that is shown with figures of a verdict: with their decimals. In another unit than
/// theirs with those of the uncertainty's two digits there. A plain one has at least the decimals
/// that are usual for its unit.
std::string shown_speed(SpeedKind kind, double speed_m_s, const ShownFigures& beside,
                        const SpeedUnit& unit);

/// Speeds of one verdict that are shown beside one another, m/s.
struct SpeedsToShow {
    double speed_m_s = 0.0;
    double expanded_uncertainty_m_s = 0.0;
    std::optional<double> required_speed_m_s = std::nullopt;
    std::optional<double> acceptance_limit_m_s = std::nullopt;
};

/// The speeds in a unit as they are to be read, the uncertainty too: all with the same decimals,
/// those of the expanded uncertainty's two significant digits but no more than `rule_decimals`.
/// Failure (at "rounding") for a speed that is not finite.
ShownFigures shown_in(const SpeedsToShow& speeds, const SpeedUnit& unit,
                      std::optional<int> rule_decimals = std::nullopt);

/// The figures that a verdict, which has a speed, shows; else made of its numbers in that unit.
ShownFigures shown_of(const ProfileVerdict& verdict, std::string_view unit);

/// How many decimals a figure is written with.
int decimals_in(std::string_view figure);

/// One shown figure less another, with the decimals of the finer one: "0.05". A difference that is
/// shown is that of what is shown.
std::string shown_difference(std::string_view figure, std::string_view less);

/// The decimals of figures as they are shown in their own unit.
int decimals_of(const ShownFigures& shown);

/// A speed with the decimals of figures that are shown beside it, rounded to that side: "224.21".
std::string beside(const ShownFigures& shown, double speed_m_s, SafeSide side);

/// Another speed of the same rule, "224.18 km/h", with unit and decimals of the measured one,
/// rounded to that side; without a measured one with the unit's usual decimals.
std::string speed_beside(const ProfileVerdict& verdict, double speed_m_s, std::string_view unit,
                         SafeSide side = SafeSide::down);

/// What one shown figure is more than another, with its sign: "+0.02", "0.00".
std::string signed_difference(std::string_view figure, std::string_view less,
                              std::optional<int> decimals = std::nullopt);

/// A speed that another measurement gives, and the one that it is compared with, as they are shown:
/// the other with the decimals that its uncertainty justifies, and the one of the page as the page
/// has it, beside whatever it stands. The difference is that of what is shown.
struct ComparedSpeeds {
    std::string other;       ///< "216.07 km/h ± 0.15 km/h"
    std::string judged;      ///< "216.00 km/h"
    std::string difference;  ///< "+0.07 km/h": of the other, less the judged one
};
ComparedSpeeds compared_in(const SpeedUnit& unit, const SpeedsToShow& other, double judged_m_s,
                           const ShownFigures& page);

/// "232.17 km/h ± 0.17 km/h".
std::string measured_speed_text(const ShownFigures& shown);
/// The same with the coverage factor: "232.17 km/h ± 0.17 km/h (k = 2)".
std::string measured_speed_text(const ShownFigures& shown, double coverage_factor);

/// The speed by the rule's own arithmetic, how it is computed, and why the measured one differs.
std::string own_arithmetic_text(const OwnArithmetic& own);

/// "20.100 s": three decimals.
std::string seconds_text(ElapsedTime time);

/// "2022-03-18 08:51:04.300" of a GPS time, in UTC.
std::string utc_text(GpsTime time);

/// The same instant on the GPS time scale.
std::string gps_text(GpsTime time);

/// An instant of a recording by time of day, where it is known when it began: "at 14:03:22.1 UTC",
/// "53.8 s after the first epoch".
std::string instant_text(const std::optional<GpsTime>& first_epoch, ElapsedTime time);
/// When a window begins, in the same words.
std::string beginning_text(const WindowSpan& span);

/// A time as people say it, without an exponent however long: "3 s", "1.9 s", "1210 s".
std::string time_span_text(double duration_s);

/// "4.1e-09": two significant digits of a small figure.
std::string scientific_text(double value);

}  // namespace runcert
