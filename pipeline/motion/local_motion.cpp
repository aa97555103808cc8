#include "motion/local_motion.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace runcert {
namespace {

constexpr double block_s = 2.0;
constexpr std::size_t blocks_each_side = 5;  // on each side: 22 s in all
constexpr double prior_sd = 2.0;             // of the logarithm of the ratio of a local density to
                                             // that of the whole recording

// The grid of densities, in units of the measurement scale, evenly spaced in the logarithm.
constexpr double log_least = -4.6;  // 0.01 m s^-2.5
constexpr double log_step = 1.0;
constexpr std::size_t grid_points = 11;

double log_density_at(double grid_point) {
    return log_least + log_step * grid_point;
}

std::vector<EstimationModel> grid_models() {
    std::vector<EstimationModel> models(grid_points);
    for (std::size_t i = 0; i < grid_points; ++i)
        models[i].motion.jerk_density = std::exp(log_density_at(static_cast<double>(i)));
    return models;
}

/// The sums of one block, for each density of the grid.
using BlockSums = std::vector<InnovationSums>;

/// The blocks of an arc.
struct Blocks {
    std::vector<std::size_t> ends;  ///< for each block, one past its last epoch
    std::vector<BlockSums> sums;
    std::vector<double> grid_points;  ///< in the grid, of the most likely density around each block
};

template <int Axes>
std::vector<std::size_t> block_ends(std::span<const ArcEpoch<Axes>> arc) {
    std::vector<std::size_t> ends;
    double next_s = arc.front().time_s + block_s;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        if (arc[k].time_s < next_s) continue;
        ends.push_back(k);
        next_s = std::max(next_s, arc[k].time_s) + block_s;
    }
    if (ends.empty() || ends.back() != arc.size()) ends.push_back(arc.size());
    return ends;
}

template <int Axes>
Blocks blocks_of(std::span<const ArcEpoch<Axes>> arc, std::span<const EstimationModel> models) {
    Blocks blocks{.ends = block_ends(arc), .sums = {}, .grid_points = {}};
    const auto by_model = innovation_sums_along<Axes>(arc, models, blocks.ends);
    for (std::size_t b = 0; b < blocks.ends.size(); ++b) {
        BlockSums& sums = blocks.sums.emplace_back();
        for (const auto& of_model : by_model)
            sums.push_back(of_model[b]);
    }
    blocks.grid_points.assign(blocks.ends.size(), 0.0);
    return blocks;
}

void add(BlockSums& sum, const BlockSums& more, double sign) {
    for (std::size_t i = 0; i < sum.size(); ++i) {
        sum[i].statistic += sign * more[i].statistic;
        sum[i].log_determinant += sign * more[i].log_determinant;
    }
}

/// The place in the grid where the likelihood of these sums times the prior is largest. No prior
/// applies where `whole_grid_point` is empty.
double best_grid_point(const BlockSums& sums, double scale,
                       std::optional<double> whole_grid_point) {
    const auto value = [&](std::size_t i) {
        const double away = whole_grid_point
                                ? log_step * (static_cast<double>(i) - *whole_grid_point) / prior_sd
                                : 0.0;
        return -0.5 * (sums[i].statistic / (scale * scale) + sums[i].log_determinant + away * away);
    };
    std::size_t best = 0;
    for (std::size_t i = 1; i < sums.size(); ++i)
        if (value(i) > value(best)) best = i;
    if (best == 0 || best + 1 == sums.size()) return static_cast<double>(best);
    const double left = value(best - 1);
    const double right = value(best + 1);
    const double curvature = left - 2.0 * value(best) + right;
    const double move = curvature < 0.0 ? 0.5 * (left - right) / curvature : 0.0;
    return static_cast<double>(best) + std::clamp(move, -0.5, 0.5);
}

void set_grid_points(Blocks& blocks, double scale, double whole_grid_point) {
    const std::size_t count = blocks.sums.size();
    BlockSums about(grid_points);
    std::size_t first = 0;
    std::size_t end = 0;
    for (std::size_t b = 0; b < count; ++b) {
        for (; end < std::min(count, b + blocks_each_side + 1); ++end)
            add(about, blocks.sums[end], 1.0);
        for (; first + blocks_each_side < b; ++first)
            add(about, blocks.sums[first], -1.0);
        blocks.grid_points[b] = best_grid_point(about, scale, whole_grid_point);
    }
}

/// The most likely scale for the current densities.
double best_scale(const std::vector<Blocks>& arcs) {
    double statistic = 0.0;
    std::int64_t values = 0;
    for (const Blocks& arc : arcs)
        for (std::size_t b = 0; b < arc.sums.size(); ++b) {
            const InnovationSums& sums =
                arc.sums[b][static_cast<std::size_t>(std::lround(arc.grid_points[b]))];
            statistic += sums.statistic;
            values += sums.values;
        }
    return std::sqrt(statistic / static_cast<double>(values));
}

}  // namespace

template <int Axes>
LocalMotion local_motion(std::span<const std::span<const ArcEpoch<Axes>>> arcs) {
    const std::vector<EstimationModel> models = grid_models();
    std::vector<Blocks> all;
    BlockSums whole(grid_points);
    std::int64_t values = 0;
    for (const auto arc : arcs) {
        all.push_back(blocks_of<Axes>(arc, models));
        for (const BlockSums& sums : all.back().sums) {
            add(whole, sums, 1.0);
            values += sums.front().values;
        }
    }
    LocalMotion motion;
    if (values == 0) return motion;
    const auto n = static_cast<double>(values);
    const auto profiled = [&](std::size_t i) {
        return n * std::log(whole[i].statistic / n) + whole[i].log_determinant;
    };
    std::size_t best = 0;
    for (std::size_t i = 1; i < grid_points; ++i)
        if (profiled(i) < profiled(best)) best = i;
    motion.scale = std::sqrt(whole[best].statistic / n);
    const double whole_grid_point = best_grid_point(whole, motion.scale, std::nullopt);
    motion.whole = motion.scale * std::exp(log_density_at(whole_grid_point));
    constexpr int rounds = 3;
    for (int round = 0; round < rounds; ++round) {
        for (Blocks& arc : all)
            set_grid_points(arc, motion.scale, whole_grid_point);
        motion.scale = best_scale(all);
    }
    for (const Blocks& arc : all) {
        std::vector<double>& density = motion.jerk_density.emplace_back();
        for (std::size_t b = 0; b < arc.ends.size(); ++b)
            density.resize(arc.ends[b],
                           motion.scale * std::exp(log_density_at(arc.grid_points[b])));
    }
    return motion;
}

template LocalMotion local_motion<1>(std::span<const std::span<const ArcEpoch<1>>>);
template LocalMotion local_motion<2>(std::span<const std::span<const ArcEpoch<2>>>);

}  // namespace runcert
