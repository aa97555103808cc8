#pragma once

namespace runcert {

/// A measured value at a time (s) from a recording's first epoch.
struct TimedValue {
    double time_s = 0.0;
    double value = 0.0;
};

}  // namespace runcert
