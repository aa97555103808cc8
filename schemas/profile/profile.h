#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/document_schema.h"

namespace runcert {

/// One requirement of a rule.
struct Clause {
    std::string id;
    std::string text;
    std::string source;
    std::string certainty;   ///< "quoted", "secondary", "unconfirmed"
    std::string decided_by;  ///< name of a computation, or "attest"
};

/// A body's rule for one kind of record, `schemas/profile/v1.yaml`. Speeds in m/s.
struct Profile {
    std::string id;
    std::string body;
    std::string title;
    double duration_s = 0.0;
    std::string definition;       ///< "displacement", "path_length", "mean_n_plus_1", "mean_n"
    bool repaired_steps = false;  ///< whether a window may hold a step that was bridged
    std::optional<double> accuracy_limit_mps;
    std::string accuracy_unit;     ///< unit the limit is written in
    double coverage_factor = 2.0;  ///< k of the expanded uncertainty
    bool margin_is_relative = false;
    double margin = 0.0;  ///< m/s, or a fraction
    struct Rounding {
        std::string mode;  ///< "truncate", "nearest"
        std::string unit;
        int decimals = 0;
    };
    std::optional<Rounding> rounding;
    /// How the uncertainty of the speed is made up.
    struct Uncertainty {
        double tau_min_s = 0.5;                ///< correlation time of a slow position error: from
        double tau_max_s = 10.0;               ///< and to
        bool subtract_selection_bias = false;  ///< else it is covered by the uncertainty
        /// Smallest standard deviation of such an error (m), by kind of solution.
        std::map<std::string, double> error_floor_m;
    };
    Uncertainty uncertainty = {};
    std::vector<Clause> clauses;
};

/// Reads and checks a profile; Failure with file, line and column on any deviation.
Profile read_profile(std::string_view text, const std::string& where);

/// The text of the profile of that name that comes with the program ("nalsa", "fisly"); empty if
/// there is none.
std::string_view builtin_profile(std::string_view name);

/// Metres per second in one of "km/h", "m/s", "kn", "mph" (exact: knot 1852 m/h, mile 1609.344 m).
double metres_per_second(std::string_view unit);

}  // namespace runcert
