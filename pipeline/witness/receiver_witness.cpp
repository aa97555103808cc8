#include "witness/receiver_witness.h"

#include <algorithm>
#include <cmath>

namespace runcert {

template <int Axes>
ReceiverWitness<Axes>::ReceiverWitness(std::vector<OtherReceiverEpoch<Axes>> epochs,
                                       double longest_step_s)
    : epochs_(std::move(epochs)), longest_step_s_(longest_step_s) {}

template <int Axes>
std::optional<typename ReceiverWitness<Axes>::Place> ReceiverWitness<Axes>::place_of(
    double time_s) const {
    constexpr double rounding_s = 1e-6;
    const auto after = std::ranges::upper_bound(epochs_, time_s + rounding_s, {},
                                                &OtherReceiverEpoch<Axes>::time_s);
    if (after == epochs_.begin()) return std::nullopt;
    const auto k = static_cast<std::size_t>(after - epochs_.begin()) - 1;
    const OtherReceiverEpoch<Axes>& a = epochs_[k];
    if (time_s - a.time_s <= rounding_s) return Place{k, a.position_m, a.covariance_m2};
    if (after == epochs_.end() || after->stretch != a.stretch) return std::nullopt;
    const OtherReceiverEpoch<Axes>& b = *after;
    const double h = b.time_s - a.time_s;
    if (h > longest_step_s_) return std::nullopt;
    const double s = (time_s - a.time_s) / h;
    const double s2 = s * s, s3 = s2 * s, s4 = s3 * s, s5 = s4 * s;
    const double to_b = 10.0 * s3 - 15.0 * s4 + 6.0 * s5;
    const PositionVector<Axes> velocities = (s - 6.0 * s3 + 8.0 * s4 - 3.0 * s5) * a.velocity_m_s +
                                            (-4.0 * s3 + 7.0 * s4 - 3.0 * s5) * b.velocity_m_s;
    const PositionVector<Axes> accelerations =
        0.5 * (s2 - 3.0 * s3 + 3.0 * s4 - s5) * a.acceleration_m_s2 +
        0.5 * (s3 - 2.0 * s4 + s5) * b.acceleration_m_s2;
    return Place{k,
                 a.position_m + to_b * (b.position_m - a.position_m) + h * velocities +
                     h * h * accelerations,
                 a.covariance_m2.cwiseMax(b.covariance_m2)};
}

template <int Axes>
std::optional<WitnessedMotion<Axes>> ReceiverWitness<Axes>::between(double from_s,
                                                                    double to_s) const {
    const auto from = place_of(from_s);
    const auto to = place_of(to_s);
    if (!from || !to || epochs_[from->epoch].stretch != epochs_[to->epoch].stretch)
        return std::nullopt;
    WitnessedMotion<Axes> motion;
    motion.displacement_m = to->position_m - from->position_m;
    motion.covariance_m2 = from->covariance_m2 + to->covariance_m2;
    return motion;
}

template <int Axes>
TimeSpan ReceiverWitness<Axes>::covered() const {
    if (epochs_.empty()) return {};
    return {.first_s = epochs_.front().time_s, .last_s = epochs_.back().time_s};
}

template <int Axes>
std::optional<double> ReceiverWitness<Axes>::path_between(double from_s, double to_s) const {
    const auto from = place_of(from_s);
    const auto to = place_of(to_s);
    if (!from || !to || epochs_[from->epoch].stretch != epochs_[to->epoch].stretch)
        return std::nullopt;
    double path_m = 0.0;
    PositionVector<Axes> last_m = from->position_m;
    for (std::size_t k = from->epoch + 1; k <= to->epoch; ++k) {
        path_m += (epochs_[k].position_m - last_m).norm();
        last_m = epochs_[k].position_m;
    }
    return path_m + (to->position_m - last_m).norm();
}

template class ReceiverWitness<1>;
template class ReceiverWitness<2>;

}  // namespace runcert
