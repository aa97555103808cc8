#include "stages/import/measured_epoch.h"

#include <algorithm>
#include <utility>

namespace runcert {

const SignalMeasurement* order_measurements(MeasuredEpoch& epoch) {
    const auto key = [](const SignalMeasurement& each) {
        return std::pair(each.satellite, each.signal);
    };
    std::ranges::sort(epoch.measurements, {}, key);
    const auto same = std::ranges::adjacent_find(epoch.measurements, {}, key);
    return same == epoch.measurements.end() ? nullptr : &*same;
}

}  // namespace runcert
