#pragma once

#include <span>
#include <vector>

#include "schemas/screened/screened.h"
#include "witness/recorded_velocities.h"
#include "witness/witnessed_spans.h"

// Positions and recorded velocities that differ all over a recording: a scale of the velocities, or
// a drift of the positions.

namespace runcert {

/// A prior of the scale of velocities: a normal distribution about 1 with a weight. 0.1 to 0.5 %
/// are what filters and spinning antennas leave; 2 % are of another instrument, or of wrong units.
struct ScalePrior {
    double weight = 0.0, sigma = 0.0;
};
inline constexpr ScalePrior scale_priors[] = {{0.95, 0.003}, {0.05, 0.02}};

/// The displacement by velocities compared with the positions' over one span, per second.
struct SpanComparison {
    double speed_m_s = 0.0;   ///< by the positions
    double change_m_s = 0.0;  ///< of the speed within the span, either way
    double along_m_s = 0.0;   ///< by how much the positions moved farther
    double across_m_s = 0.0;  ///< the same across the direction of travel; 0 of heights
};

/// The rules' usual window, s: the length of those spans.
inline constexpr double usual_window_s = 3.0;

/// The comparisons over spans of that length that do not overlap and in which the craft moved.
template <int Axes>
std::vector<SpanComparison> compare_spans(const Witness<Axes>& velocities,
                                          std::span<const TimedPosition<Axes>> positions);

/// A lasting difference that the errors of neither explain.
struct LastingDifference {
    double size_m_s = 0.0;  ///< standard deviation, each axis; 0 if all is explained
    double scale = 0.0;     ///< of the velocities, less 1, that fits it best
    bool is_scale = false;  ///< nothing that lasts remains beside that scale
    /// How much better than a scale a drift explains it: the likelihood of a drift, integrated over
    /// its size (m/s), over that of a scale.
    double drift_odds_m_s = 0.0;

    /// Probability that the positions drift, from their prior of a fault of at most this size.
    /// Velocities that err otherwise than by a scale are taken to be as likely. A half where a
    /// scale does not explain the difference, for then nothing tells which of the two errs.
    double positions_at_fault(double prior, double largest_m_s) const;
};

/// Weighs both explanations of a difference of `size_m_s` against each other ([JCGM106] 6, Bayes'
/// theorem). A scale shows the same ratio in slow spans as in fast ones. A drift is the same in all
/// spans, or in those above a fraction of the top speed, or proportional to the speed. The last of
/// these looks like a scale, and only their priors tell them apart.
///
/// A receiver's velocities have no scale of their own beside that of its oscillator, which is
/// negligible; filters and spinning antennas leave 0.1 to 0.5 %. The prior of the scale is
/// normal with 0.3 %, and in 5 of 100 cases with 2 %, as of velocities by another instrument or in
/// wrong units. The noise is the scatter of the spans about the best explanation, at least what
/// `explained_m_s` (standard deviation, each axis) explains, enlarged by its correlation between
/// neighbours. It is at least half of `least_velocity_sigma_m_s`, which lasts. `known_m_s` is what
/// good velocities leave; beside their scale, half of it. Smaller drifts than that are none.
LastingDifference weigh_scale_and_drift(double size_m_s, std::span<const SpanComparison> spans,
                                        double explained_m_s, double known_m_s);

/// Standard deviation (m/s, each axis) of a lasting error, from the difference of displacements of
/// up to 10 s by recorded velocities and by positions. It is what remains unexplained by twice the
/// positions' stated errors, the white noise of the velocities and the velocities' stated errors. 0
/// if all is explained, and up to 0.07 m/s (vertically 0.1), which good receivers leave.
double unexplained_by_velocities_m_s(const ScreenedTable& screened, TestedAxes axes);

/// That error, weighed as a scale of the velocities and as a drift of the positions. `velocities`
/// are the recorded ones as a witness; null if there are none.
template <int Axes>
LastingDifference lasting_difference(const ScreenedTable& screened,
                                     const Witness<Axes>* velocities);

}  // namespace runcert
