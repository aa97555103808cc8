#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/common/window_span.h"

namespace runcert {

/// The four definitions of a window's speed (m/s), from the smoothed trajectory.
struct SpeedDefinitions {
    double displacement_mps = 0.0;   ///< displacement over time
    double path_length_mps = 0.0;    ///< path length over time
    double mean_n_plus_1_mps = 0.0;  ///< mean of the N+1 speeds, both ends ([DHD22] (26))
    double mean_n_mps = 0.0;         ///< mean of the N speeds after the first

    /// The one of that name ("displacement", "path_length", "mean_n_plus_1", "mean_n").
    double by_name(std::string_view name) const;
};

/// Mean over the window of the speeds by each method (m/s); empty where a method has no value at
/// some epoch of it.
struct MethodMeans {
    std::optional<double> smoothed_mps, batch_mps, v1_mps, v2_mps, kalman_mps;
};

struct CertifiableWindow {
    WindowSpan span;
    std::int64_t arc = 0;
    double speed_mps = 0.0;  ///< by the profile's definition
    double standard_uncertainty_mps = 0.0;
    double displacement_m = 0.0;
    double position_r95_m = 0.0;  ///< 95 % radius of the position at the worse end
    SpeedDefinitions definitions;
    MethodMeans methods;
};

struct IndicatedWindow {
    WindowSpan span;
    double speed_mps = 0.0;  ///< displacement of the raw positions over time
    std::vector<std::string> refusals;
};

struct ProfileWindows {
    std::string profile;
    double duration_s = 0.0;
    std::string definition;
    std::int64_t candidates = 0;
    std::optional<CertifiableWindow> best;
    std::optional<IndicatedWindow> indicated;
};

/// 5-windows.yaml, `schemas/windows/v1.yaml`.
struct Windows {
    Header header;
    std::string receiver;
    std::optional<GpsTime> first_epoch;
    bool georeferenced = true;
    std::vector<ProfileWindows> profiles;
};

std::string write_windows(const Windows& windows);
Windows read_windows(std::string_view text, const std::string& where);

}  // namespace runcert
