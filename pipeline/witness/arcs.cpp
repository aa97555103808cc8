#include "witness/arcs.h"

#include <algorithm>

#include "core/failure.h"
#include "schemas/enu/measured_position.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert {

namespace {

bool has_measurement(const ScreenedEpoch& row, Measurements measurements) {
    return row.usable ||
           (measurements == Measurements::before_rejection && row.reason == Reason::outlier);
}

}  // namespace

template <int Axes>
std::vector<Arc<Axes>> arcs_of(const ScreenedTable& table, Measurements measurements) {
    std::vector<Arc<Axes>> arcs;
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const ScreenedEpoch& row = table.rows[i];
        if (!row.arc) continue;
        if (arcs.empty() || arcs.back().number != *row.arc) {
            arcs.emplace_back();
            arcs.back().number = *row.arc;
        }
        ArcEpoch<Axes> epoch;
        epoch.time_s = row.time.seconds();
        if (has_measurement(row, measurements))
            epoch.measurement =
                PositionMeasurement<Axes>{.position = measured_position<Axes>(row),
                                          .covariance = stated_covariance<Axes>(row)};
        arcs.back().rows.push_back(i);
        arcs.back().epochs.push_back(epoch);
    }
    return arcs;
}

template std::vector<Arc<1>> arcs_of<1>(const ScreenedTable&, Measurements);
template std::vector<Arc<2>> arcs_of<2>(const ScreenedTable&, Measurements);

EstimationModel model_of(const NoiseSummary& noise) {
    EstimationModel model;
    model.motion.jerk_density = noise.jerk_density.value;
    if (noise.acceleration_time_s)
        model.motion.acceleration_time_s = noise.acceleration_time_s->value;
    model.measurement_scale = noise.measurement_scale.value;
    if (noise.correlated_error_detected)
        model.error =
            GaussMarkovError::steady(noise.error_sigma_m->value, noise.error_tau_s->value);
    return model;
}

NoiseFitOptions fit_options(const SmoothParameters& parameters) {
    using Motion = NoiseFitOptions::Motion;
    const MotionChoice choice = parameters.motion_model;
    return {.initial_jerk_density = parameters.jerk_density,
            .tau_min_s = parameters.error_time_min_s,
            .tau_max_s = parameters.error_time_max_s,
            .motion = choice == MotionChoice::singer ? Motion::singer
                      : choice == MotionChoice::constant_acceleration
                          ? Motion::constant_acceleration
                          : Motion::by_likelihood};
}

NoiseBasis basis_of(NoiseFit::Status status) {
    switch (status) {
        case NoiseFit::Status::fitted:
            return NoiseBasis::fitted;
        case NoiseFit::Status::too_few_epochs:
            return NoiseBasis::too_few_epochs;
        case NoiseFit::Status::constant_positions:
            return NoiseBasis::constant_positions;
    }
    return NoiseBasis::stated;
}

template <int Axes>
const NoiseSummary& noise_of(const TrajectoryTable& trajectory) {
    const EstimationSummary& estimation = trajectory.estimation;
    if constexpr (Axes == 2) return estimation.horizontal.noise;
    if (!estimation.vertical)
        throw Failure("4-trajectory of receiver " + trajectory.facts.receiver,
                      "the trajectory has no heights",
                      "Use a recording with heights, or a profile of horizontal speed");
    return estimation.vertical->noise;
}

template const NoiseSummary& noise_of<1>(const TrajectoryTable&);
template const NoiseSummary& noise_of<2>(const TrajectoryTable&);

template <int Axes>
std::vector<Arc<Axes>> arcs_of(const ScreenedTable& screened, const TrajectoryTable& trajectory) {
    constexpr auto column =
        Axes == 1 ? &TrajectoryEpoch::jerk_density_up : &TrajectoryEpoch::jerk_density;
    const double whole = noise_of<Axes>(trajectory).jerk_density.value;
    std::vector<Arc<Axes>> arcs = arcs_of<Axes>(screened);
    for (Arc<Axes>& arc : arcs)
        for (std::size_t k = 0; k < arc.rows.size(); ++k)
            if (arc.rows[k] < trajectory.rows.size())
                arc.epochs[k].jerk_factor =
                    (trajectory.rows[arc.rows[k]].*column).value_or(whole) / whole;
    return arcs;
}

template std::vector<Arc<1>> arcs_of<1>(const ScreenedTable&, const TrajectoryTable&);
template std::vector<Arc<2>> arcs_of<2>(const ScreenedTable&, const TrajectoryTable&);

std::vector<WeightedModel> posterior_of(const NoiseSummary& noise) {
    if (noise.posterior.empty()) return {{model_of(noise), 1.0}};
    std::vector<WeightedModel> models;
    for (const NoiseModelShare& share : noise.posterior) {
        EstimationModel model;
        model.motion.jerk_density = share.jerk_density;
        if (share.acceleration_time_s)
            model.motion.acceleration_time_s = *share.acceleration_time_s;
        model.measurement_scale = share.measurement_scale;
        model.error = GaussMarkovError::steady(share.error_sigma_m, share.error_tau_s);
        models.push_back({model, share.weight});
    }
    return models;
}

EstimationModel model_of(const ScreeningModel& noise) {
    EstimationModel model;
    model.motion.jerk_density = noise.jerk_density;
    model.measurement_scale = noise.measurement_scale;
    model.error = GaussMarkovError::steady(noise.error_sigma_m, noise.error_tau_s);
    return model;
}

std::map<FixType, double> kind_factors(const ScreeningBasis& basis, TestedAxes axes) {
    std::map<FixType, double> factors;
    const auto noise = std::find_if(basis.models.begin(), basis.models.end(),
                                    [&](const ScreeningModel& one) { return one.axes == axes; });
    if (noise == basis.models.end()) return factors;
    const double scale = noise->white_scale * noise->white_scale;
    std::size_t kinds = 0;
    for (const FixTypeErrors& kind : basis.fix_types) {
        if (kind.axes != axes) continue;
        ++kinds;
        if (kind.judgement != AccuracyJudgement::too_few_epochs)
            factors[kind.fix] = kind.variance_factor / scale;
    }
    if (kinds < 2) factors.clear();
    return factors;
}

template <int Axes>
std::vector<Arc<Axes>> tested_arcs(const ScreenedTable& table, const EstimationModel& model,
                                   const std::map<FixType, double>& factors) {
    std::vector<Arc<Axes>> arcs = arcs_of<Axes>(table);
    for (Arc<Axes>& arc : arcs)
        for (std::size_t k = 0; k < arc.rows.size(); ++k) {
            const double manoeuvre = manoeuvre_before<Axes>(table.rows[arc.rows[k]]);
            if (k > 0 && manoeuvre > 0.0)
                allow_manoeuvre(arc.epochs[k - 1], manoeuvre, model, arc.epochs[k]);
            const auto factor = factors.find(table.rows[arc.rows[k]].fix);
            if (factor != factors.end() && arc.epochs[k].measurement)
                arc.epochs[k].measurement->covariance *= factor->second;
        }
    return arcs;
}

template std::vector<Arc<1>> tested_arcs<1>(const ScreenedTable&, const EstimationModel&,
                                            const std::map<FixType, double>&);
template std::vector<Arc<2>> tested_arcs<2>(const ScreenedTable&, const EstimationModel&,
                                            const std::map<FixType, double>&);

}  // namespace runcert
