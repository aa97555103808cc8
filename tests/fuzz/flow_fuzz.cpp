// The reader of series of wind and current, and what they say of a window.

#include <cmath>

#include "fuzz_target.h"
#include "stages/check/wind.h"

namespace runcert::fuzz {

void read_input(std::string_view bytes) {
    const MeasuredSeries series =
        read_series(bytes, "input", GpsTime::from_calendar({.year = 2026, .month = 10, .day = 20}),
                    {"speed", "direction"});
    require(!series.samples.empty(), "a series has samples");
    for (std::size_t i = 0; i < series.samples.size(); ++i) {
        const SeriesSample& sample = series.samples[i];
        require(std::isfinite(sample.time_s) && sample.value >= 0.0, "a sample has its values");
        require(i == 0 || series.samples[i - 1].time_s < sample.time_s, "times increase");
    }
    const double start_s = series.samples.front().time_s;
    const FlowInWindow flow = flow_in_window(series, FlowKind::wind, start_s, start_s + 3.0, 90.0);
    require(!flow.missing.empty() || flow.mean_m_s <= flow.gust_m_s * (1.0 + 1e-9) + 1e-9,
            "the mean is not above the strongest");
}

}  // namespace runcert::fuzz
