#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "simulation/inertial_run.h"

// How soon an inertial filter's attitude is right, by the start it is given: what [FHB03] measured
// on three race tracks, on simulated runs whose truth is known.

namespace runcert {

/// Where alignment is studied.
struct AlignmentCell {
    std::string name;
    InertialRunSpec spec = {};
    double spread_m = 0.0;             ///< the starts lie evenly over so much way
    double velocity_sigma_m_s = 0.03;  ///< of the receiver's velocities
    /// What the craft's attitude differs by from that of the ground (rad), as a start states it.
    EulerAngles lean = {};
};

/// A car with a tactical IMU on an oval, with positions as receivers gave them in 2003 (1 Hz, 0.3 m
/// white, 1.0 m correlated over 60 s) and with post-processed ones (10 Hz, 12 mm and 8 mm); a
/// sailing craft with a MEMS IMU on a salt lake.
std::vector<AlignmentCell> alignment_cells();

/// How the filter starts [FHB03]. In brackets the standard deviations of roll, pitch and heading in
/// degrees, by which the start errs or which its covariance states.
enum class AlignmentStart {
    previous,     ///< an attitude known before, errors drawn (5, 5, 12)
    blind,        ///< level, any heading (10, 8, 100)
    gps_heading,  ///< level, heading along the velocity (9, 4, 3)
    track_model,  ///< by surface and velocity, `AlignmentCell::lean`
};
inline constexpr AlignmentStart alignment_starts[]{AlignmentStart::previous, AlignmentStart::blind,
                                                   AlignmentStart::gps_heading,
                                                   AlignmentStart::track_model};
std::string alignment_start_name(AlignmentStart start);

/// One run of the filter, for 100 s and 10 s more.
struct Alignment {
    double initial_error_deg = 0.0;
    /// When the root of the trace of the attitude's covariance falls below 1 degree ("cov"), and
    /// the true error then.
    std::optional<double> stated_s = {};
    double error_when_stated_deg = 0.0;
    std::optional<double> true_s = {};  ///< after which the true error stays below 1 degree
    double nis = 0.0;                   ///< mean normalised innovation squared, by 3
};

/// What the runs of one start come to.
struct AlignmentSummary {
    int runs = 0;
    double initial_error_deg = 0.0;                           ///< mean
    double stated_s = 0.0, stated_sd_s = 0.0;                 ///< of those that state it
    double error_median_deg = 0.0, error_most_deg = 0.0;      ///< when they do
    double true_s = 0.0, true_sd_s = 0.0, true_most_s = 0.0;  ///< of those that converge
    int failed = 0;                                           ///< not converged within 100 s
    int failed_unseen = 0;                                    ///< of these, with NIS/3 of 2 or less
};
AlignmentSummary summarise(const std::vector<Alignment>& runs);

/// An initial error about one axis, up to 40 degrees any of the three in turn, above the heading.
/// The covariance at the start states the error's size, 1 degree at least, about the axes that may
/// err, and 5 degrees of roll and pitch where the heading errs.
inline constexpr double alignment_errors_deg[]{0.0,  10.0, 20.0,  30.0,  40.0,
                                               50.0, 80.0, 110.0, 140.0, 170.0};

struct AlignmentOptions {
    int starts = 24;  ///< a method and an error
    std::uint64_t seed = 1;
    unsigned threads = 0;  ///< 0: as many as there are
    bool errors = true;    ///< whether initial errors are studied, too
};

struct AlignmentStudy {
    std::string cell;
    std::vector<std::vector<Alignment>> by_start = {};  ///< as `alignment_starts`
    std::vector<std::vector<Alignment>> by_error = {};  ///< as `alignment_errors_deg`
    /// The track model's start with 1, 1 and 1.5 degrees whatever the craft; empty where that is
    /// the craft's own.
    std::vector<Alignment> overconfident = {};

    const std::vector<Alignment>& of(AlignmentStart start) const {
        return by_start[static_cast<std::size_t>(start)];
    }
};
AlignmentStudy study_alignment(const AlignmentCell& cell, const AlignmentOptions& options);

/// Attitude by surface and velocity less the car's, degrees: roll, pitch, heading.
struct SurfaceAccuracy {
    double vertex_sigma_m = 0.0;
    double velocity_sigma_m_s = 0.0;
    Eigen::Vector3d mean_deg = Eigen::Vector3d::Zero();
    Eigen::Vector3d sd_deg = Eigen::Vector3d::Zero();
};

/// On the oval, at epochs 0.2 s apart, with triangles of 10 m whose vertices err independently.
SurfaceAccuracy study_surface(double vertex_sigma_m, double velocity_sigma_m_s, int runs,
                              std::uint64_t seed);

/// Tables 1 to 3 and what is said of Figures 5, 6, 9 and 10, each beside ours.
std::string alignment_table_1(const std::vector<AlignmentStudy>& studies);
std::string alignment_table_2(const std::vector<SurfaceAccuracy>& ours);
std::string alignment_table_3(const std::vector<AlignmentStudy>& studies);
std::string alignment_figures(const std::vector<AlignmentStudy>& studies);

}  // namespace runcert
