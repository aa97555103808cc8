#include "witness/screening_noise.h"

#include <algorithm>

namespace runcert {

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
