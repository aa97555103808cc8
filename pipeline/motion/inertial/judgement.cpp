#include "inertial/judgement.h"

#include <cmath>

#include "inertial/imu_noise_fit.h"
#include "inertial/inertial_passes.h"

namespace runcert {
namespace {

constexpr double search_nis = 2.0;    ///< NIS/3 above which a start is doubted
constexpr double compared_s = 120.0;  ///< of motion, on which noise and offset are judged
/// By so much a time offset must raise the logarithm of the likelihood.
constexpr double asking_gain = 10.0;

/// Two minutes about the highest speed, on which to compare.
InertialData part_of(const InertialData& data, bool from_the_beginning) {
    std::size_t fastest = 0;
    double most_m_s = 0.0;
    for (std::size_t k = 0; k < data.fixes.size() && !from_the_beginning; ++k) {
        const double speed_m_s = velocity_of_positions(data.fixes, k).head<2>().norm();
        if (speed_m_s <= most_m_s) continue;
        most_m_s = speed_m_s;
        fastest = k;
    }
    const double middle_s = data.fixes[fastest].time_s;
    InertialData part = data;
    std::erase_if(part.fixes, [&](const PositionFix& fix) {
        return std::abs(fix.time_s - middle_s) > 0.5 * compared_s;
    });
    return part.fixes.size() < least_positions ? data : part;
}

/// The likeliest noise of a part about its own trajectory. That is found with the noise of a craft,
/// from which a wrong start recovers soonest.
Judged judge_part(InertialData part, InertialSetup setup, StartChoice choice) {
    const FoundStart start = chosen_start(choice, part, setup);
    part.noise = setup.fit_noise ? on_a_craft(setup.noise) : setup.noise;
    const Passes passes = run_passes(part, start.prior);
    const std::vector<InertialNominal> about = passes.last.trajectory();
    double squares = 0.0;
    for (const PositionInnovation& innovation : passes.last.innovations)
        squares += innovation.whitened.squaredNorm();
    part.noise = setup.noise;
    const FittedImuNoise fitted =
        setup.fit_noise ? fit_imu_noise(part, start.prior, about)
                        : FittedImuNoise{setup.noise, passes.last.log_likelihood, false};
    setup.noise = fitted.noise;
    return {.setup = setup,
            .start = start.kind == StartMethod::search    ? StartChoice::search
                     : start.kind == StartMethod::surface ? StartChoice::surface
                                                          : StartChoice::found,
            .log_likelihood = fitted.log_likelihood,
            .nis = squares / (3.0 * static_cast<double>(about.size())),
            .noise_at_limit = fitted.at_limit};
}

}  // namespace

FoundStart chosen_start(StartChoice choice, const InertialData& data, const InertialSetup& setup) {
    if (choice == StartChoice::surface)
        if (auto start = surface_start(data, setup)) return *start;
    if (choice != StartChoice::search)
        if (auto start = find_start(data, setup)) return *start;
    return search_start(data, setup);
}

Judged judge(const InertialData& data, const InertialSetup& setup) {
    const InertialData part = part_of(data, setup.start.has_value());
    Judged best = judge_part(part, setup, StartChoice::found);
    const auto try_start = [&](StartChoice choice) {
        const Judged other = judge_part(part, setup, choice);
        if (other.log_likelihood > best.log_likelihood) best = other;
    };
    if (surface_start(part, setup)) try_start(StartChoice::surface);
    if (best.nis > search_nis && best.start != StartChoice::search && !setup.start)
        try_start(StartChoice::search);
    if (setup.estimate_time_offset) return best;
    InertialSetup with_offset = setup;
    with_offset.estimate_time_offset = true;
    const Judged offset = judge_part(part, with_offset, best.start);
    return offset.log_likelihood > best.log_likelihood + asking_gain ? offset : best;
}

}  // namespace runcert
