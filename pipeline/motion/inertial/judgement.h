#pragma once

#include "inertial/alignment.h"

namespace runcert {

/// Where a solution starts.
enum class StartChoice {
    found,    ///< as the setup or the data give it (`find_start`)
    surface,  ///< on the surface (`surface_start`)
    search,   ///< the heading is searched (`search_start`)
};

/// The start by that choice, or else the next that there is.
FoundStart chosen_start(StartChoice choice, const InertialData& data, const InertialSetup& setup);

/// How a recording is to be solved, as judged on a part of it.
struct Judged {
    InertialSetup setup;  ///< with the likeliest noise, and a time offset if that is likelier
    StartChoice start = StartChoice::found;
    double log_likelihood = 0.0;
    double nis = 0.0;             ///< NIS/3 with the noise of a craft
    bool noise_at_limit = false;  ///< `FittedImuNoise::at_limit`
};

/// Start, noise and time offset by their likelihood over two minutes about the highest speed (from
/// the beginning, where the setup gives the start). A start on a surface is taken if it is likelier
/// than the one without: with a wrong surface it is not, or leads to the same solution.
Judged judge(const InertialData& data, const InertialSetup& setup);

}  // namespace runcert
