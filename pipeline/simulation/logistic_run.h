#pragma once

namespace runcert {

/// The straight run of [DHD22], section "Simulated run": speed is logistic,
/// v(t) = A / (1 + exp(-r (t - t0))), r = ln(A / v0 - 1) / t0. The paper's own figures are the
/// defaults.
struct LogisticRun {
    double top_speed_m_s = 60.0;      ///< A, approached and never reached
    double start_speed_m_s = 0.01;    ///< v0, the speed at time 0
    double half_speed_time_s = 15.0;  ///< t0, when the speed is A / 2
};

/// The run at one time.
struct RunState {
    double distance_m = 0.0;  ///< from where the craft was at time 0
    double speed_m_s = 0.0;
    double acceleration_m_s2 = 0.0;
    double jerk_m_s3 = 0.0;
};

/// Failure (at "run") unless 0 < v0 < A / 2 and t0 > 0, all finite.
void require_valid(const LogisticRun& run);

/// The run `time_s` after its beginning; before it (negative times) too. Failure as
/// `require_valid`. Rounding only: a distance to a few times 1e-16 of A (|t| + t0). Reproduces
/// table 2 of [DHD22] to its printed digits.
///
/// It takes exp and log from the C library, whose last bits differ between processor models. What
/// is written from it is rounded to 1e-6 m at the finest, a million times more.
RunState logistic_run(const LogisticRun& run, double time_s);

}  // namespace runcert
