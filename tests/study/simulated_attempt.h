#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/random.h"
#include "core/timed_value.h"
#include "simulated_arc.h"
#include "stages/window/window.h"
#include "study_phases.h"

namespace runcert {

/// What is heard beside positions of 10 Hz with white noise of 8 mm.
enum class StudyHeard {
    nothing,
    fine_velocities,
    coarse_velocities,
    phases,
    receiver,
    wheel,
    gates
};
inline constexpr std::array<std::string_view, 7> study_heard_names{
    "none", "velocities 0.05", "velocities 0.3", "phases", "second receiver", "wheel", "gates"};

/// Runs whose lasting errors, of positions and witnesses, are a part of what is stated of them, and
/// whose top speed lasts for so many windows of 3 s.
struct WitnessCell {
    double part = 0.1;
    int rivals = 1;
    double velocity_scale = 1.0;  ///< of the recorded velocities
    double fast_drift_m_s = 0.0;  ///< of the positions, along the track above half the top speed
    double slow_s = 0.0;          ///< driving at a quarter of the top speed before the run
};

/// The fastest 3 s of one run as certified, with one witness.
struct WitnessedRun {
    bool certified = false;  ///< there is a window, and no witness contradicts it
    double error_m_s = 0.0;  ///< measured speed less the true one of the same window
    double expanded_m_s = 0.0;
    double probability = 0.0;  ///< that a limit well below the truth is reached
    double tail_m_s = 0.0;     ///< measured speed less that which the truth is below once in 10,000
};

/// A simulated run with its truth, and what witnesses record of it.
class SimulatedAttempt {
  public:
    SimulatedAttempt(const WitnessCell& cell, std::uint64_t seed);

    /// A drift along the track, from a row on for 3 s.
    void add_fault(std::size_t first, double rate_m_s, double lasts_s = 3.0);

    /// The fastest window with what is heard. The limit of its probability lies below the truth by
    /// so much.
    WitnessedRun judged(StudyHeard heard, double limit_m_s);

    /// The window that was judged last.
    const std::optional<CertifiableWindow>& best() const { return best_; }
    /// Of its speed by positions: the standard uncertainties that an optimal estimator states which
    /// knows the errors' sizes and correlation times, by white noise, by lasting errors, and by
    /// what the craft may do between epochs.
    struct Optimum {
        double white_m_s = 0.0, slow_m_s = 0.0, motion_m_s = 0.0;
    };
    Optimum optimum() const;

    /// Where a window begins that may have the fault: the best, or any while the top speed lasts.
    std::size_t any_window(RandomGenerator& random) const;

  private:
    void record_velocities(double noise_m_s, EnuTable& table);
    std::vector<TimedValue> wheel();
    std::vector<TimedValue> gates();
    EnuTable second_receiver();
    StudyPhases phases();

    WitnessCell cell_;
    RandomGenerator random_;
    SimulatedRecording motion_;
    EnuTable positions_;
    std::vector<Eigen::Vector2d> common_;  ///< what phases share with the positions, m
    ScreenedTable screened_;
    TrajectoryTable trajectory_;
    std::optional<CertifiableWindow> best_;
};

}  // namespace runcert
