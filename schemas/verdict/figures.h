#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/figures.h"
#include "schemas/verdict/declared.h"

// Speeds and other figures of a verdict, as all pages show them.

namespace runcert {

/// As the verdict shows the figure, else by `quantity_text`: "0.42 m ± 0.08 m (k = 2)".
std::string figure_value_text(const Figure& figure);

/// The limit that it is compared with: ", at most 1 m"; empty where there is none.
std::string limit_text(const Figure& figure);

/// With its name, limit and note: "height difference: 0.42 m ± 0.08 m (k = 2), at most 1 m; above
/// the ellipsoid".
std::string figure_text(const Figure& figure);

/// A speed with its expanded uncertainty, rounded to the safe side: "216.00 km/h ± 0.02 km/h".
std::string speed_with_uncertainty_text(double speed_m_s, double expanded_uncertainty_m_s,
                                        const SpeedUnit& unit);

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

/// The decimals of figures as they are shown in their own unit.
int decimals_of(const ShownFigures& shown);

/// A speed with the decimals of figures that are shown beside it, rounded to that side: "224.21".
std::string in_decimals_of(const ShownFigures& shown, double speed_m_s, SafeSide side);

/// Another speed of the same rule, "224.18 km/h", with unit and decimals of the measured one,
/// rounded to that side; without a measured one with the unit's usual decimals.
std::string speed_beside(const ProfileVerdict& verdict, double speed_m_s, std::string_view unit,
                         SafeSide side = SafeSide::down);

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

}  // namespace runcert
