#include "stages/smooth/batch.h"

#include <algorithm>
#include <cassert>
#include <mutex>

#include "core/failure.h"
#include "stages/smooth/batch_problem.h"

namespace runcert {
namespace {

/// Epochs [first, last) of an arc, and the epochs [take_from, take_to) whose states are used.
struct Stretch {
    std::size_t first = 0;
    std::size_t last = 0;
    std::size_t take_from = 0;
    std::size_t take_to = 0;
};

/// Where the next stretch begins after the one that begins at `first`: the wanted epoch or the
/// nearest measured one before it. Where that would be `first` itself, it is the next measured one
/// after. The end of the arc where there is none.
template <int Axes>
std::size_t next_beginning(std::span<const ArcEpoch<Axes>> arc, std::size_t first,
                           std::size_t wanted) {
    for (std::size_t k = wanted; k > first; --k)
        if (arc[k].measurement) return k;
    while (wanted < arc.size() && !arc[wanted].measurement)
        ++wanted;
    return wanted;
}

/// The stretches of an arc. A stretch is extended if it would leave the next one no measured epoch
/// to begin at, because of a gap as long as itself.
template <int Axes>
std::vector<Stretch> cut(std::span<const ArcEpoch<Axes>> arc, const BatchOptions& options) {
    assert(!arc.empty() && arc.front().measurement);
    assert(options.overlap > 0 && 2 * options.overlap <= options.epochs_at_once);
    std::vector<Stretch> stretches;
    Stretch stretch{.last = options.epochs_at_once};
    while (stretch.last < arc.size()) {
        const std::size_t next =
            next_beginning<Axes>(arc, stretch.first, stretch.last - options.overlap);
        stretch.last = std::max(stretch.last, next + options.overlap);
        if (stretch.last >= arc.size()) break;
        stretch.take_to = next + (stretch.last - next) / 2;
        stretches.push_back(stretch);
        stretch = {
            .first = next, .last = next + options.epochs_at_once, .take_from = stretch.take_to};
    }
    stretch.last = stretch.take_to = arc.size();
    stretches.push_back(stretch);
    return stretches;
}

/// Copies the states used from a stretch's solution to those of the arc.
template <int Axes>
void take(const Stretch& stretch, const std::vector<StateVector<Axes>>& solved,
          std::vector<StateVector<Axes>>& states) {
    for (std::size_t k = stretch.take_from; k < stretch.take_to; ++k)
        states[k] = solved[k - stretch.first];
}

/// A path through measured positions at least a while apart, straight from one to the next and
/// beyond the last. It is far enough from the solution to make the agreement with the smoother a
/// real check, and close enough to lose no relevant digits.
template <int Axes>
std::vector<StateVector<Axes>> straight_between_measurements(
    std::span<const ArcEpoch<Axes>> stretch) {
    constexpr double while_s = 1.0;
    std::vector<StateVector<Axes>> states(stretch.size(), StateVector<Axes>::Zero());
    std::size_t from = 0;  // a measured epoch
    PositionVector<Axes> velocity = PositionVector<Axes>::Zero();
    const auto fill = [&](std::size_t to) {
        for (std::size_t k = from; k < to; ++k) {
            states[k].template head<Axes>() = stretch[from].measurement->position +
                                              (stretch[k].time_s - stretch[from].time_s) * velocity;
            states[k].template segment<Axes>(Axes) = velocity;
        }
    };
    for (std::size_t k = 1; k < stretch.size(); ++k) {
        if (!stretch[k].measurement) continue;
        const double dt_s = stretch[k].time_s - stretch[from].time_s;
        if (dt_s < while_s) continue;
        velocity = (stretch[k].measurement->position - stretch[from].measurement->position) / dt_s;
        fill(k);
        from = k;
    }
    fill(stretch.size());
    return states;
}

template <int Axes>
std::vector<StateVector<Axes>> solve_stretch(std::span<const ArcEpoch<Axes>> stretch,
                                             const EstimationModel& model) {
    BatchProblem<Axes> problem(stretch, model, straight_between_measurements<Axes>(stretch));
    // The problem is linear: one step, and a second to recover the digits lost by the normal
    // equations of the first. The comparison with the smoother decides whether that was enough.
    const Convergence end = problem.solve(2, 0.0);
    if (!end.usable)
        throw Failure(problem.where(),
                      "the batch least squares could not be solved: " + end.message,
                      "Check the stated standard deviations and the time steps of this stretch");
    return problem.states();
}

}  // namespace

template <int Axes>
BatchSolution<Axes> solve_batch(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model,
                                const BatchOptions& options) {
    const std::vector<Stretch> stretches = cut<Axes>(arc, options);
    BatchSolution<Axes> solution;
    solution.stretches = static_cast<std::int64_t>(stretches.size());
    solution.states.resize(arc.size());
    // One at a time: the sparse factors of a stretch are most of the memory of a run.
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    for (const Stretch& stretch : stretches)
        take<Axes>(
            stretch,
            solve_stretch<Axes>(arc.subspan(stretch.first, stretch.last - stretch.first), model),
            solution.states);
    return solution;
}

template BatchSolution<1> solve_batch<1>(std::span<const ArcEpoch<1>>, const EstimationModel&,
                                         const BatchOptions&);
template BatchSolution<2> solve_batch<2>(std::span<const ArcEpoch<2>>, const EstimationModel&,
                                         const BatchOptions&);

}  // namespace runcert
