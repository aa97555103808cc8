#include "stages/screen/time_order.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "witness/continuity.h"

namespace runcert {
namespace {

using Rows = std::vector<EnuEpoch>;

/// Rows from first to last, in the order of the recording, whose stamps go forward without a gap.
struct Block {
    std::size_t first = 0, last = 0;
    std::int64_t epochs = 0;  ///< number of its epochs that repeat no other
    bool retained = false;
};

class TimeJudgement {
  public:
    TimeJudgement(const Rows& rows, const TimeOrderOptions& options)
        : rows_(rows),
          options_(options),
          longest_s_(options.gap_factor * options.interval_s),
          order_{.standing = std::vector(rows.size(), TimeStanding::in_order),
                 .rows = {},
                 .seam = std::vector<bool>(rows.size(), false)} {}

    TimeOrder judge() {
        if (!only_forward()) mark_repeated();
        cut_blocks();
        keep_longest_sequence();
        // Kept blocks may have filled the room in which another seemed to belong.
        while (keep_what_fits()) {
        }
        leave_out_strays();
        mark_left_out();
        thin_out();
        put_in_order();
        return std::move(order_);
    }

  private:
    std::int64_t stamp(std::size_t row) const { return rows_[row].time.nanoseconds; }
    bool is_repeated(std::size_t row) const {
        return order_.standing[row] == TimeStanding::repeated;
    }
    double step_s(std::size_t from, std::size_t to) const {
        return seconds_between(rows_[from], rows_[to]);
    }

    bool only_forward() const {
        for (std::size_t row = 1; row < rows_.size(); ++row)
            if (stamp(row) <= stamp(row - 1)) return false;
        return true;
    }

    static bool same_place(const EnuEpoch& a, const EnuEpoch& b) {
        constexpr double same_m = 1e-4;
        const auto same = [&](const OptionalReal& x, const OptionalReal& y) {
            return x.has_value() == y.has_value() && (!x || std::abs(*x - *y) < same_m);
        };
        return same(a.east_m, b.east_m) && same(a.north_m, b.north_m) && same(a.up_m, b.up_m);
    }

    void mark_repeated() {
        std::unordered_map<std::int64_t, std::size_t> first;
        for (std::size_t row = 0; row < rows_.size(); ++row) {
            const auto [at, is_new] = first.try_emplace(stamp(row), row);
            if (!is_new && same_place(rows_[at->second], rows_[row]))
                order_.standing[row] = TimeStanding::repeated;
        }
    }

    void cut_blocks() {
        for (std::size_t row = 0; row < rows_.size(); ++row) {
            if (is_repeated(row)) continue;
            const double step = blocks_.empty() ? 0.0 : step_s(blocks_.back().last, row);
            if (step <= 0.0 || step > longest_s_) blocks_.push_back({row, row});
            blocks_.back().last = row;
            ++blocks_.back().epochs;
        }
        epochs_to_.push_back(0);
        for (const Block& block : blocks_)
            epochs_to_.push_back(epochs_to_.back() + block.epochs);
    }

    /// Keeps the sequence of blocks, each entirely later than the one before, that holds most
    /// epochs. It uses the best sequence ending at or before each time, in a tree of prefix maxima.
    void keep_longest_sequence() {
        std::vector<std::int64_t> ends;
        for (const Block& block : blocks_)
            ends.push_back(stamp(block.last));
        std::ranges::sort(ends);
        constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
        std::vector<std::size_t> tree(ends.size() + 1, none);
        std::vector<std::int64_t> held(blocks_.size());
        std::vector<std::size_t> before(blocks_.size(), none);
        const auto better = [&](std::size_t one, std::size_t other) {
            return one == none || (other != none && held[other] > held[one]) ? other : one;
        };
        std::size_t best = none;
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            const auto earlier = std::ranges::lower_bound(ends, stamp(blocks_[b].first));
            for (auto k = static_cast<std::size_t>(earlier - ends.begin()); k > 0; k &= k - 1)
                before[b] = better(before[b], tree[k]);
            held[b] = blocks_[b].epochs + (before[b] == none ? 0 : held[before[b]]);
            const auto own = std::ranges::lower_bound(ends, stamp(blocks_[b].last));
            for (auto k = static_cast<std::size_t>(own - ends.begin()) + 1; k < tree.size();
                 k += k & (~k + 1))
                tree[k] = better(tree[k], b);
            best = better(best, b);
        }
        for (std::size_t b = best; b != none; b = before[b])
            keep(b);
    }

    void keep(std::size_t b) {
        blocks_[b].retained = true;
        kept_[stamp(blocks_[b].first)] = b;
        recorded_.insert(b);
    }

    bool is_taken(std::int64_t time_ns) const {
        const auto later = kept_.upper_bound(time_ns);
        return later != kept_.begin() && time_ns <= stamp(blocks_[std::prev(later)->second].last);
    }

    /// Reduces an overlapping block to its longest free part, if that is most of it.
    bool cut_to_free_part(Block& block) const {
        Block best{block.first, block.first}, part = best;
        for (std::size_t row = block.first; row <= block.last; ++row) {
            if (is_repeated(row)) continue;
            if (is_taken(stamp(row))) {
                part = {row + 1, row + 1};
                continue;
            }
            const auto later = kept_.upper_bound(stamp(part.first));
            if (part.epochs > 0 && later != kept_.end() && later->first < stamp(row))
                part = {row, row};  // another block lies in between
            part.last = row;
            ++part.epochs;
            if (part.epochs > best.epochs) best = part;
        }
        if (3 * best.epochs < 2 * block.epochs || best.epochs == 0) return false;
        best.retained = block.retained;
        block = best;
        return true;
    }

    /// The retained block next to another in the recording, before or after it.
    std::optional<std::size_t> neighbour_in_sequence(std::size_t b, bool before) const {
        if (!before) {
            const auto next = recorded_.upper_bound(b);
            return next == recorded_.end() ? std::nullopt : std::optional(*next);
        }
        const auto next = recorded_.lower_bound(b);
        return next == recorded_.begin() ? std::nullopt : std::optional(*std::prev(next));
    }

    std::optional<Eigen::Vector3d> velocity_at(std::size_t b, bool at_end) const {
        const Block& block = blocks_[b];
        if (block.last == block.first) return std::nullopt;
        const std::size_t from = at_end ? block.last - 1 : block.first;
        return velocity_between(rows_[from], rows_[from + 1], longest_s_);
    }

    /// Whether the craft's motion continues from one block to another within `step_s`.
    bool leads_to(std::size_t from, std::size_t to, double step_s) const {
        return continues({.from = &rows_[blocks_[from].last],
                          .to = &rows_[blocks_[to].first],
                          .before = velocity_at(from, true),
                          .after = velocity_at(to, false)},
                         step_s);
    }

    /// Whether a block that is not retained was recorded in place, between two that leave room for
    /// it.
    bool belongs_between(std::size_t b) const {
        const auto before = neighbour_in_sequence(b, true), after = neighbour_in_sequence(b, false);
        if (!before || !after) return false;
        const auto next = std::next(kept_.find(stamp(blocks_[*before].first)));
        if (next == kept_.end() || next->second != *after) return false;
        const std::int64_t between = epochs_to_[*after] - epochs_to_[*before + 1];
        const double room = step_s(blocks_[*before].last, blocks_[*after].first);
        return room > (static_cast<double>(between) + 0.5) * options_.interval_s &&
               leads_to(*before, *before + 1, options_.interval_s) &&
               leads_to(*after - 1, *after, options_.interval_s);
    }

    /// Keeps further blocks that fit, the longer first. Returns whether there were any.
    bool keep_what_fits() {
        std::vector<std::size_t> left;
        for (std::size_t b = 0; b < blocks_.size(); ++b)
            if (!blocks_[b].retained && blocks_[b].epochs > 0) left.push_back(b);
        std::ranges::stable_sort(left, std::greater<>(),
                                 [&](std::size_t b) { return blocks_[b].epochs; });
        bool any = false;
        for (const std::size_t b : left) {
            if (belongs_between(b) || !cut_to_free_part(blocks_[b])) continue;
            keep(b);
            any = true;
        }
        return any;
    }

    /// Leaves out retained blocks with no other near in time. Each begins a session, in order of
    /// time.
    void leave_out_strays() {
        std::vector<std::vector<std::size_t>> sessions;
        std::int64_t end_ns = 0;
        for (const auto& [start_ns, b] : kept_) {
            const double apart_s =
                (static_cast<double>(start_ns) - static_cast<double>(end_ns)) * 1e-9;
            if (sessions.empty() || apart_s > options_.session_gap_s) sessions.emplace_back();
            sessions.back().push_back(b);
            end_ns = stamp(blocks_[b].last);
        }
        if (sessions.size() < 2) return;
        for (const auto& session : sessions) {
            std::int64_t epochs = 0;
            for (const std::size_t b : session)
                epochs += blocks_[b].epochs;
            if (epochs < options_.fewest && session.size() == 1) leave_out_stray(session.front());
        }
    }

    void leave_out_stray(std::size_t b) {
        const auto before = neighbour_in_sequence(b, true), after = neighbour_in_sequence(b, false);
        const bool continues_here = (before && leads_to(*before, b, options_.interval_s)) ||
                                    (after && leads_to(b, *after, options_.interval_s));
        if (!continues_here) return;
        blocks_[b].retained = false;
        kept_.erase(stamp(blocks_[b].first));
        recorded_.erase(b);
    }

    void mark_left_out() {
        std::vector<bool> retained(rows_.size(), false);
        for (const Block& block : blocks_)
            if (block.retained)
                for (std::size_t row = block.first; row <= block.last; ++row)
                    retained[row] = !is_repeated(row);
        for (std::size_t row = 0; row < rows_.size(); ++row)
            if (!retained[row] && !is_repeated(row))
                order_.standing[row] = TimeStanding::out_of_order;
        // A row with the time of the retained one next to it, but another position. Only the
        // retained one tells when it was recorded.
        const EnuEpoch* neighbour = nullptr;
        const auto compare = [&](std::size_t row) {
            if (retained[row])
                neighbour = &rows_[row];
            else if (neighbour != nullptr && rows_[row].time == neighbour->time &&
                     !is_repeated(row))
                order_.standing[row] = TimeStanding::same_time;
        };
        for (std::size_t row = 0; row < rows_.size(); ++row)
            compare(row);
        neighbour = nullptr;
        for (std::size_t row = rows_.size(); row-- > 0;)
            compare(row);
    }

    void thin_out() {
        constexpr double least_of_interval = 0.05;
        std::optional<std::size_t> before;
        for (const auto& [start_ns, b] : kept_)
            for (std::size_t row = blocks_[b].first; row <= blocks_[b].last; ++row) {
                if (order_.standing[row] != TimeStanding::in_order) continue;
                if (before && step_s(*before, row) < least_of_interval * options_.interval_s)
                    order_.standing[row] = TimeStanding::same_time;
                else
                    before = row;
            }
    }

    void put_in_order() {
        // Each row left out comes after the retained row that it follows or repeats.
        std::vector<std::int64_t> place(rows_.size());
        std::int64_t anchor = std::numeric_limits<std::int64_t>::min();
        std::int64_t latest = anchor;
        for (std::size_t row = 0; row < rows_.size(); ++row) {
            if (order_.standing[row] == TimeStanding::in_order) {
                anchor = stamp(row);
                order_.moved += anchor < latest ? 1 : 0;
                latest = std::max(latest, anchor);
            }
            place[row] = is_repeated(row) ? stamp(row) : anchor;
        }
        order_.rows.resize(rows_.size());
        std::iota(order_.rows.begin(), order_.rows.end(), std::size_t{0});
        std::ranges::stable_sort(order_.rows, {}, [&](std::size_t row) {
            return std::pair(place[row], order_.standing[row] != TimeStanding::in_order);
        });
        if (order_.moved > 0) find_seams();
    }

    void find_seams() {
        std::optional<std::size_t> before;
        for (const auto& [start_ns, b] : kept_) {
            if (before) {
                const auto recorded = neighbour_in_sequence(b, true);
                order_.seam[blocks_[b].first] =
                    recorded != before &&
                    !leads_to(*before, b, step_s(blocks_[*before].last, blocks_[b].first));
            }
            before = b;
        }
    }

    const Rows& rows_;
    TimeOrderOptions options_;
    double longest_s_;
    std::vector<Block> blocks_;
    std::vector<std::int64_t> epochs_to_;       ///< of all blocks before each, as originally
                                                ///< divided
    std::map<std::int64_t, std::size_t> kept_;  ///< by the time of their first epoch
    std::set<std::size_t> recorded_;            ///< the same blocks, in the order of the recording
    TimeOrder order_;
};

}  // namespace

TimeOrder order_by_time(const std::vector<EnuEpoch>& rows, const TimeOrderOptions& options) {
    return TimeJudgement(rows, options).judge();
}

}  // namespace runcert
