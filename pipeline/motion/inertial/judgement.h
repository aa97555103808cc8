#pragma once

#include "inertial/alignment.h"

namespace runcert {

/// How a recording is to be solved, as judged on a part of it.
struct Judged {
    InertialSetup setup;  ///< with the likeliest noise, and a time offset if that is likelier
    bool search = false;  ///< whether the start is to be searched for
    double log_likelihood = 0.0;
    double nis = 0.0;             ///< NIS/3 with the noise of a craft
    bool noise_at_limit = false;  ///< the likeliest noise is the greatest that was tried
};

/// Start, noise and time offset by their likelihood over two minutes about the highest speed (from
/// the beginning, where the setup gives the start).
Judged judge(const InertialData& data, const InertialSetup& setup);

}  // namespace runcert
