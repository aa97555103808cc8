#include "stages/window/crossings.h"

#include <cassert>
#include <cmath>
#include <optional>

#include "core/failure.h"

namespace runcert {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// How far beyond the line through the gate a position is, times the gate's length (m^2); negative
/// before it.
double beyond(const Gate& gate, const Eigen::Vector2d& position) {
    return cross(gate.right - gate.left, position - gate.left);
}

bool between_ends(const Gate& gate, const Eigen::Vector2d& position) {
    const Eigen::Vector2d across = gate.right - gate.left;
    const double along_m2 = across.dot(position - gate.left);
    return along_m2 >= 0.0 && along_m2 <= across.squaredNorm();
}

/// The crossing of the line within the step after a sample, on its way from `before` to `after`
/// the line; at the sample itself where `before` is 0.
Crossing crossing_in(const SampleSeries& series, std::size_t sample, double before, double after) {
    Crossing crossing;
    crossing.after = sample;
    crossing.time = series.times[sample];
    crossing.position = series.positions[sample].head<2>();
    if (before == 0.0) return crossing;
    const Eigen::Vector2d next = series.positions[sample + 1].head<2>();
    const auto step_ns = static_cast<double>(series.times[sample + 1].nanoseconds -
                                             series.times[sample].nanoseconds);
    crossing.fraction = before / (before - after);
    crossing.time.nanoseconds += std::llround(crossing.fraction * step_ns);
    crossing.position += crossing.fraction * (next - crossing.position);
    return crossing;
}

void add_crossings(const SampleSeries& series, std::size_t index, const Gate& gate,
                   std::vector<Crossing>& found) {
    std::optional<std::size_t> off_line;  // the last sample on either side
    double side_before = 0.0;
    for (std::size_t k = 0; k < series.times.size(); ++k) {
        const double side = beyond(gate, series.positions[k].head<2>());
        if (side == 0.0) continue;
        if (off_line && (side > 0.0) != (side_before > 0.0)) {
            const bool at_sample = *off_line + 1 < k;
            Crossing crossing = at_sample ? crossing_in(series, *off_line + 1, 0.0, side)
                                          : crossing_in(series, *off_line, side_before, side);
            crossing.series = index;
            crossing.forward = side > 0.0;
            if (between_ends(gate, crossing.position)) found.push_back(crossing);
        }
        off_line = k;
        side_before = side;
    }
}

}  // namespace

std::vector<Crossing> crossings(const std::vector<SampleSeries>& series, const Gate& gate) {
    if (gate.left == gate.right)
        throw Failure("a gate of the course", "its left end is where its right end is",
                      "State the surveyed positions of both ends of the line");
    std::vector<Crossing> found;
    for (std::size_t k = 0; k < series.size(); ++k) {
        assert(series[k].positions.size() == series[k].times.size());
        add_crossings(series[k], k, gate, found);
    }
    return found;
}

}  // namespace runcert
