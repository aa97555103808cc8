#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification_study.h"

namespace runcert {

/// One recording through screening, smoothing and window search under the rule for 3 s.
struct CertifiedRun {
    std::uint64_t seed = 0;
    std::string cell;
    double length_s = 0.0;
    double jerk_density = 0.0;
    std::vector<SupposedError> errors;  ///< one kind only; none of a clean run

    enum class Outcome {
        certified,
        no_window,
        accuracy_refused,
        robust_refused,
        witness_refused,
        failed
    };
    Outcome outcome = Outcome::no_window;
    std::string failure;          ///< what a stage said that could not do it
    double error_m_s = 0.0;       ///< measured speed less the true one of the same window
    double expanded_m_s = 0.0;    ///< expanded uncertainty, coverage factor 2
    double undetected_m_s = 0.0;  ///< stated: what an error too small to be found does to the speed
    std::int64_t first_epoch = 0;
    std::string witnesses;  ///< what each says of the window

    bool missed() const;
    bool far_off() const;   ///< missed, and the error above 0.8 km/h
    bool unstated() const;  ///< missed by more than an error too small to be found is said to do
    bool wrong() const;     ///< missed by more than 0.05 km/h
};

/// What is recorded beside the positions.
struct StudyWitness {
    /// m/s; the receiver records velocities too, true but for white noise
    std::optional<double> velocity_noise_m_s = std::nullopt;
    bool phases = false;    ///< the receiver's raw phases, of 1.2 mm
    bool receiver = false;  ///< a second receiver on the craft, with errors of its own
};

/// The run of a seed: 45 to 60 s of the run of [DHD22], without or with random motion, in one of
/// the cells of screening; without an error, or with errors of one kind, random in number, size,
/// direction and place. Sizes: outliers, bursts and (one to five) steps from 3 standard deviations
/// to 100, of steps to 300; ramps from 0.02 to 2 m/s; stamps late or early by 20 ms or one sample.
/// What the witness records has none of these errors.
CertifiedRun certify_run(std::uint64_t seed, const StudyWitness& witness);

struct FalseRecordOptions {
    std::int64_t runs = 10'000;
    std::uint64_t seed = 1;
    unsigned threads = 0;
    StudyWitness witness = {};
    std::optional<std::uint64_t> only = std::nullopt;  ///< the run of this seed alone
};

std::vector<CertifiedRun> study_false_records(const FalseRecordOptions& options);

/// A run with its errors and its witnesses, in words.
std::string run_line(const CertifiedRun& run);

/// By kind of error and altogether; then the runs that are furthest off.
std::string false_records_table(const std::vector<CertifiedRun>& runs);

}  // namespace runcert
