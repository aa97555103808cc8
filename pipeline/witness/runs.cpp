#include "witness/runs.h"

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "core/angle.h"

namespace runcert {
namespace {

using Eigen::Vector2d;

constexpr double direction_s = 2.0;
constexpr double longest_turn_s = 30.0;

/// A row with an estimate.
struct Moment {
    std::size_t row = 0;
    double time_s = 0.0;
    double speed_m_s = 0.0;
    Vector2d moved = Vector2d::Zero();  ///< displacement since the first moment, m
    std::size_t before = 0;  ///< the last moment at least `direction_s` ago, or the first
};

std::vector<Moment> moments_of(std::span<const TrajectoryEpoch> rows) {
    std::vector<Moment> moments;
    Vector2d last_velocity = Vector2d::Zero();
    std::size_t before = 0;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const TrajectoryEpoch& epoch = rows[row];
        if (!epoch.arc || !epoch.velocity_east_m_s || !epoch.velocity_north_m_s) continue;
        const Vector2d velocity(*epoch.velocity_east_m_s, *epoch.velocity_north_m_s);
        Moment moment{.row = row, .time_s = epoch.time.seconds(), .speed_m_s = velocity.norm()};
        if (!moments.empty())
            moment.moved = moments.back().moved + 0.5 * (moment.time_s - moments.back().time_s) *
                                                      (last_velocity + velocity);
        while (before + 1 < moments.size() &&
               moments[before + 1].time_s <= moment.time_s - direction_s)
            ++before;
        moment.before = before;
        moments.push_back(moment);
        last_velocity = velocity;
    }
    return moments;
}

double angle_between_deg(const Vector2d& a, const Vector2d& b) {
    const double cross = a.x() * b.y() - a.y() * b.x();
    return std::abs(std::atan2(cross, a.dot(b))) * degrees_per_radian;
}

/// Visits each moment once, except for those of a turn, which belong to two runs.
class RunCutter {
  public:
    RunCutter(std::vector<Moment> moments, const RunThresholds& thresholds)
        : moments_(std::move(moments)), thresholds_(thresholds) {}

    std::vector<CraftRun> runs() && {
        begin_at(0, RunEdge::recording);
        for (std::size_t k = 0; k < moments_.size(); ++k) {
            if (k > begin_ && is_gap_before(k)) {
                end_at(k - 1, RunEdge::gap);
                begin_at(k, RunEdge::gap);
            }
            visit(k);
            if (const auto cut = turn_at(k)) {
                end_at(*cut, RunEdge::turn);
                begin_at(*cut, RunEdge::turn);
                k = *cut;
                visit(k);
            }
        }
        if (!moments_.empty()) end_at(moments_.size() - 1, RunEdge::recording);
        return std::move(runs_);
    }

  private:
    bool is_slow(std::size_t k) const { return moments_[k].speed_m_s < thresholds_.stop_m_s; }

    bool is_gap_before(std::size_t k) const {
        return moments_[k].time_s - moments_[k - 1].time_s > thresholds_.stop_s;
    }

    void begin_at(std::size_t k, RunEdge why) {
        begin_ = k;
        began_ = why;
        fast_ = false;
        slow_since_.reset();
        stood_from_.reset();
        straight_.reset();
    }

    /// Restarts while the craft is at a standstill, which began at `slow_since_`.
    void begin_standing_at(std::size_t k) {
        const std::optional<std::size_t> since = slow_since_;
        begin_at(k, RunEdge::standing);
        slow_since_ = stood_from_ = since;
    }

    /// Ends the run, if there is one, here or at the beginning of the craft's standstill.
    void end_at(std::size_t k, RunEdge why) {
        if (!fast_) return;
        const bool stands = slow_since_.has_value() && why != RunEdge::turn;
        runs_.push_back({.first_row = moments_[begin_].row,
                         .last_row = moments_[stands ? *slow_since_ : k].row,
                         .began = began_,
                         .ended = stands ? RunEdge::standing : why});
        if (stood_from_) runs_.back().stood_from_row = moments_[*stood_from_].row;
    }

    void visit(std::size_t k) {
        if (!is_slow(k)) {
            slow_since_.reset();
            fast_ = fast_ || moments_[k].speed_m_s > thresholds_.start_m_s;
            return;
        }
        if (!slow_since_) slow_since_ = k;
        if (fast_ && moments_[k].time_s - moments_[*slow_since_].time_s < thresholds_.stop_s)
            return;
        end_at(k, RunEdge::standing);
        begin_standing_at(k);
    }

    /// Angle between the direction of travel and that of the run, degrees.
    std::optional<double> turned_deg(std::size_t k) const {
        const std::size_t before = moments_[k].before;
        if (!fast_ || before <= begin_) return std::nullopt;
        const Vector2d now = moments_[k].moved - moments_[before].moved;
        const Vector2d so_far = moments_[before].moved - moments_[begin_].moved;
        if (now.norm() < thresholds_.stop_m_s * direction_s ||
            so_far.norm() < thresholds_.start_m_s * thresholds_.stop_s)
            return std::nullopt;
        return angle_between_deg(so_far, now);
    }

    /// The moment at which to cut, if the craft has turned by now.
    std::optional<std::size_t> turn_at(std::size_t k) {
        const std::optional<double> turned = turned_deg(k);
        if (!turned) return std::nullopt;
        if (!straight_ || *turned <= 0.5 * thresholds_.turn_deg) straight_ = k;
        if (*turned <= thresholds_.turn_deg) return std::nullopt;
        std::size_t slowest = k;
        for (std::size_t i = k; i > *straight_; --i) {
            if (moments_[k].time_s - moments_[i].time_s > longest_turn_s) break;
            if (moments_[i].speed_m_s < moments_[slowest].speed_m_s) slowest = i;
        }
        return slowest;
    }

    std::vector<Moment> moments_;
    RunThresholds thresholds_;
    std::vector<CraftRun> runs_;
    std::size_t begin_ = 0;  ///< beginning of a possible run
    RunEdge began_ = RunEdge::recording;
    bool fast_ = false;                      ///< it has a fast part, so it is a run
    std::optional<std::size_t> slow_since_;  ///< below stop_m_s since then
    std::optional<std::size_t> stood_from_;  ///< below stop_m_s from there to begin_
    std::optional<std::size_t> straight_;    ///< the last moment within half of turn_deg
};

}  // namespace

std::vector<CraftRun> runs_in(std::span<const TrajectoryEpoch> rows,
                              const RunThresholds& thresholds) {
    return RunCutter(moments_of(rows), thresholds).runs();
}

}  // namespace runcert
