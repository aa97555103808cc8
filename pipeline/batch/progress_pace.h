#pragma once

#include <cstddef>
#include <map>
#include <optional>

namespace runcert {

/// How fast a day goes, from the attempts that really ran: those of which everything was kept take
/// next to no time and say nothing about those to come. Times are seconds since any moment.
class Pace {
  public:
    /// The attempt of that index begins.
    void begins(std::size_t index, double now_s);
    /// It has ended; `ran` is false where everything was kept. An index that has not begun is
    /// passed over.
    void ends(std::size_t index, bool ran, double now_s);

    /// Attempts that ran, in a minute, since the first one began; nothing before one has ended.
    std::optional<double> runs_per_minute(double now_s) const;

    /// The time (s) that the attempts running and `waiting` more will take, if each takes as long
    /// as those that ran did and as many go side by side; nothing before one has ended.
    std::optional<double> seconds_left(std::size_t waiting, double now_s) const;

  private:
    std::map<std::size_t, double> running_;  ///< when they began
    std::optional<double> first_began_s_;
    std::size_t side_by_side_ = 0;
    std::size_t ran_ = 0;
    double ran_for_s_ = 0.0;
};

}  // namespace runcert
