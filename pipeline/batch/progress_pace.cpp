#include "batch/progress_pace.h"

#include <algorithm>

namespace runcert {

void Pace::begins(std::size_t index, double now_s) {
    if (!first_began_s_) first_began_s_ = now_s;
    running_.emplace(index, now_s);
    side_by_side_ = std::max(side_by_side_, running_.size());
}

void Pace::ends(std::size_t index, bool ran, double now_s) {
    const auto found = running_.find(index);
    if (found == running_.end()) return;
    if (ran) {
        ++ran_;
        ran_for_s_ += now_s - found->second;
    }
    running_.erase(found);
}

std::optional<double> Pace::runs_per_minute(double now_s) const {
    if (ran_ == 0 || now_s <= *first_began_s_) return std::nullopt;
    return 60.0 * static_cast<double>(ran_) / (now_s - *first_began_s_);
}

std::optional<double> Pace::seconds_left(std::size_t waiting, double now_s) const {
    if (ran_ == 0) return std::nullopt;
    const double each_s = ran_for_s_ / static_cast<double>(ran_);
    double work_s = each_s * static_cast<double>(waiting);
    double longest_s = 0.0;
    for (const auto& [index, began_s] : running_) {
        const double left_s = std::max(each_s - (now_s - began_s), 0.0);
        work_s += left_s;
        longest_s = std::max(longest_s, left_s);
    }
    return std::max(work_s / static_cast<double>(side_by_side_), longest_s);
}

}  // namespace runcert
