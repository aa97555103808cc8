#include "identification_study.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace runcert {
namespace {

constexpr double first_error_s = 10.0;
constexpr double last_error_s = 55.0;
constexpr double first_shift_s = 20.0;  // before it the craft is too slow for its stamps to show

std::vector<SupposedError> errors_of(const StudyRun& cell, const ErrorScenario& scenario,
                                     RandomGenerator& random) {
    std::vector<SupposedError> errors;
    const double from_s = scenario.kind == Hypothesis::time_shift ? first_shift_s : first_error_s;
    const double share_s = (last_error_s - from_s) / static_cast<double>(scenario.errors);
    for (std::int64_t i = 0; i < scenario.errors; ++i) {
        // Five are at least 2.7 s apart: two steps closer than the longest burst are a burst.
        const double at = static_cast<double>(i) + 0.15 + 0.7 * random.uniform();
        const auto first =
            static_cast<std::size_t>(std::lround((from_s + share_s * at) * cell.rate_hz));
        errors.push_back(random_error(scenario, cell.noise, first, random));
    }
    return errors;
}

Identification identify(const StudyRun& cell, const ErrorScenario& scenario, std::uint64_t seed) {
    const SimulatedRecording recording = simulate_recording(cell, seed);
    RandomGenerator random(seed ^ 0x5eed);
    const std::vector<SupposedError> errors = errors_of(cell, scenario, random);
    const ScreenedTable screened =
        screen(to_be_screened(with_errors(recording, errors)), study_screen_config());
    Identification result;
    for (const SupposedError& error : errors) {
        const Judgement judgement = judge(screened, error, cell.rate_hz);
        result.found.add(judgement.found);
        result.dated.add(judgement.dated);
        result.named.add(judgement.named);
    }
    result.left_out = wrongly_left_out(screened, errors);
    return result;
}

std::string scenario_name(const ErrorScenario& scenario) {
    std::string name = scenario.errors > 1 ? fmt::format("{} ", scenario.errors) : "";
    name += to_text(scenario.kind);
    if (scenario.errors > 1) name += "s";
    if (scenario.kind == Hypothesis::burst) name += fmt::format(" of {}", scenario.epochs);
    return name;
}

std::string size_text(const ErrorScenario& scenario) {
    if (scenario.kind == Hypothesis::ramp) return fmt::format("{:g} m/s", scenario.size);
    if (scenario.kind == Hypothesis::time_shift) return fmt::format("{:g} ms", scenario.size * 1e3);
    return fmt::format("{:g} sigma", scenario.size);
}

}  // namespace

SupposedError random_error(const ErrorScenario& scenario, const StudyNoise& noise,
                           std::size_t first, RandomGenerator& random) {
    SupposedError error{.kind = scenario.kind, .first = first, .epochs = scenario.epochs};
    const double direction_rad = 2.0 * std::numbers::pi * random.uniform();
    const Eigen::Vector2d direction(std::cos(direction_rad), std::sin(direction_rad));
    if (scenario.kind == Hypothesis::time_shift)
        error.late_s = std::copysign(scenario.size, direction.y());
    else if (scenario.kind == Hypothesis::ramp)
        error.size = scenario.size * direction;
    else
        error.size = scenario.size * std::hypot(noise.white_m, noise.error_sigma_m) * direction;
    return error;
}

std::vector<ErrorScenario> error_scenarios(double rate_hz) {
    std::vector<ErrorScenario> scenarios;
    for (const double size : {3.0, 5.0, 10.0, 30.0, 100.0})
        scenarios.push_back({.kind = Hypothesis::outlier, .size = size, .errors = 2});
    for (const std::size_t epochs : {2U, 5U, 10U, 20U})
        for (const double size : {3.0, 10.0, 30.0, 100.0})
            scenarios.push_back({.kind = Hypothesis::burst, .epochs = epochs, .size = size});
    for (const std::int64_t steps : {1, 2, 5})
        for (const double size : {3.0, 10.0, 30.0, 100.0, 300.0})
            scenarios.push_back({.kind = Hypothesis::step, .size = size, .errors = steps});
    for (const double size_m_s : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0})
        scenarios.push_back({.kind = Hypothesis::ramp, .size = size_m_s});
    for (const double late_s : {0.02, 1.0 / rate_hz})
        scenarios.push_back({.kind = Hypothesis::time_shift, .size = late_s});
    return scenarios;
}

Identification study_identification(const StudyRun& cell, const ErrorScenario& scenario,
                                    const ScreeningStudyOptions& options) {
    Identification sum;
    sum.scenario = scenario;
    sum.recordings = options.scenario_recordings;
    for (const Identification& one :
         results_of(options.scenario_recordings, options.threads, [&](std::int64_t i) {
             return identify(cell, scenario,
                             options.seed * 3'000'017 + static_cast<std::uint64_t>(i));
         })) {
        sum.found += one.found;
        sum.dated += one.dated;
        sum.named += one.named;
        sum.left_out += one.left_out;
        if (one.left_out > 0) ++sum.spoilt;
    }
    return sum;
}

std::string identification_table(const StudyRun& cell, const std::vector<Identification>& lines) {
    std::string text = fmt::format(
        "{}: {} recordings for each line; sigma is {:.1f} mm\n"
        "errors                size        found   dated   named | recordings, and good epochs, "
        "left out\n",
        cell_name(cell), lines.empty() ? 0 : lines.front().recordings,
        std::hypot(cell.noise.white_m, cell.noise.error_sigma_m) * 1e3);
    for (const Identification& line : lines) {
        const Hypothesis kind = line.scenario.kind;
        const bool dated = kind == Hypothesis::step || kind == Hypothesis::time_shift;
        text += fmt::format("{:<18} {:>11}     {:6.3f}  {:>6}  {:6.3f} |  {:6} {:9}\n",
                            scenario_name(line.scenario), size_text(line.scenario),
                            line.found.fraction(),
                            dated ? fmt::format("{:.3f}", line.dated.fraction()) : "-",
                            line.named.fraction(), line.spoilt, line.left_out);
    }
    return text;
}

}  // namespace runcert
