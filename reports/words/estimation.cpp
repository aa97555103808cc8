#include "reports/words/estimation.h"

#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "reports/words/figures.h"

namespace runcert {

std::string noise_status_text(const NoiseSummary& noise) {
    if (noise.status == NoiseBasis::fitted)
        return fmt::format("estimated from {}", counted(noise.epochs, "epoch"));
    if (noise.status == NoiseBasis::too_few_epochs)
        return fmt::format("not estimated: {}, at least {} required; the stated noise is used",
                           counted(noise.epochs, "usable epoch"), counted(noise.epochs_needed));
    return fmt::format("not estimated: {}; the stated noise is used", words_of(noise.status));
}

std::string noise_parameter_text(const NoiseParameter& parameter, const NoiseSummary& noise,
                                 std::string_view unit) {
    constexpr double small = 0.3;
    const auto with_unit = [&](std::string figure) {
        return unit.empty() ? figure : fmt::format("{} {}", figure, unit);
    };
    const auto& relative = parameter.relative_uncertainty;
    const std::string value = with_unit(significant_text(parameter.value, 3));
    if (noise.status != NoiseBasis::fitted) return value;
    const std::string limit = parameter.at_bound ? "; at the limit of its range" : "";
    if (!relative) return value + ", uncertainty not determined by the data" + limit;
    const double sigma = *relative * parameter.value;
    if (*relative < small && sigma > 0.0)
        return fmt::format("{} ± {}{}",
                           with_unit(format_fixed(parameter.value, uncertainty_decimals(sigma))),
                           with_unit(uncertainty_text(sigma)), limit);
    return fmt::format("{}, × or ÷ {}{}", value, significant_text(std::exp(*relative), 3), limit);
}

std::string engineering_crs_text() {
    return "engineering CRS, not tied to the Earth: its place, orientation and scale are not "
           "stated";
}

std::string place_text(const FramePlace& place) {
    return fmt::format("{} s on: latitude {}°, longitude {}°, ellipsoidal height {} m",
                       format_fixed(place.from.seconds(), 1),
                       format_fixed(place.position.latitude.degrees(), 9),
                       format_fixed(place.position.longitude.degrees(), 9),
                       format_fixed(place.position.height_m, 3));
}

}  // namespace runcert
