#include "stages/window/certify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/failure.h"
#include "core/geodesy.h"
#include "stages/window/budget.h"
#include "stages/window/contradictions.h"
#include "stages/window/instants.h"
#include "stages/window/position_speed.h"
#include "stages/window/reliability.h"
#include "stages/window/selection.h"
#include "stages/window/trajectory_part.h"
#include "stages/window/witnessed_budget.h"
#include "stages/window/witnesses.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

/// The mean of each method's speeds over the window. Empty if one is missing.
template <int Axes>
MethodMeans methods_of(const AxesEstimate<Axes>& estimate, const FoundWindow& found) {
    using Row = TrajectoryEpoch;
    if constexpr (Axes == 1) return {};
    const std::vector<std::size_t>& rows = estimate.rows[found.series].rows;
    const auto mean = [&](std::optional<double> Row::*method) -> std::optional<double> {
        double sum = 0.0;
        for (std::size_t k = found.first; k <= found.last; ++k) {
            const auto& value = estimate.trajectory.rows[rows[k]].*method;
            if (!value) return std::nullopt;
            sum += *value;
        }
        return sum / static_cast<double>(found.last - found.first + 1);
    };
    return {.smoothed_m_s = mean(&Row::speed_m_s),
            .batch_m_s = mean(&Row::speed_batch_m_s),
            .v1_m_s = mean(&Row::speed_v1_m_s),
            .v2_m_s = mean(&Row::speed_v2_m_s),
            .kalman_m_s = mean(&Row::speed_kalman_m_s)};
}

template <int Axes>
SelectionBias selection_of(const AxesEstimate<Axes>& estimate, const WindowChoice& choice,
                           const ErrorBound& bound, double search_uncertainty_m_s,
                           const SpeedEstimate& stated) {
    const double duration_s = choice.found.duration_s();
    const double fitted_m_s =
        bound.along * estimate.model.error.process_density / std::sqrt(duration_s);
    const double slow_m_s = std::max(std::numbers::sqrt2 * bound.sigma_m / duration_s, fitted_m_s);
    const double least_m_s =
        choice.found.assured_m_s() - selection_width * std::hypot(search_uncertainty_m_s, slow_m_s);
    // No witness can narrow what alone exceeds the rule's limit, and no choice of the window can.
    const auto& limit_m_s = choice.profile.accuracy_limit_m_s;
    const bool refused =
        limit_m_s && !choice.by_positions_alone && estimate.witnesses.empty() &&
        choice.profile.coverage_factor * stated.standard_uncertainty_m_s > *limit_m_s;
    const bool is_whole = choice.extent == CertificateExtent::whole;
    // What lies further apart than a window is long, and than some epochs, hardly errs together.
    constexpr std::size_t some_epochs = 500;
    SelectionBias selection = selection_bias<Axes>(
        estimate.arcs,
        is_whole ? legs_of(choice.all, choice.found, least_m_s, some_epochs)
                 : std::vector<WindowLeg>{},
        SelectionModels{.estimated = estimate.model,
                        .by_path = counts_path(choice.profile.definition),
                        .along = bound.along,
                        .bound_m = bound.sigma_m,
                        .tau_min_s = bound.tau_min_s,
                        .tau_max_s = bound.tau_max_s},
        stated.speed_m_s, is_whole && !refused ? estimate.config.selection_samples : 0,
        estimate.config.seed);
    selection.treatment = choice.profile.uncertainty.selection_bias;
    return selection;
}

/// Correction (m/s) from a vertical speed of coordinate "up" to one of ellipsoidal heights, because
/// the Earth falls away from the plane as the craft moves over it. Zero for a horizontal speed.
template <int Axes>
double lacking_for_curvature(const AxesEstimate<Axes>& estimate, const FoundWindow& found) {
    if constexpr (Axes == 2) return 0.0;
    const auto row = [&](std::size_t k) -> const TrajectoryEpoch& {
        return estimate.trajectory.rows[estimate.arcs[found.series].rows[k]];
    };
    const auto fall_m = [&](const TrajectoryEpoch& at) {
        return fall_at_m(estimate.trajectory.origin, at.time, *at.east_m, *at.north_m);
    };
    const TrajectoryEpoch& first = row(found.first);
    const TrajectoryEpoch& last = row(found.last);
    const double upwards = *last.up_m >= *first.up_m ? 1.0 : -1.0;
    return upwards * (fall_m(last) - fall_m(first)) / found.duration_s();
}

/// The bound on time-correlated errors, with the error's size along the window's direction.
template <int Axes>
ErrorBound bound_of(const AxesEstimate<Axes>& estimate, const WindowChoice& choice,
                    const EstimatedWindow<Axes>& at, const WindowStretch<Axes>& stretch) {
    const Arc<Axes>& arc = estimate.arcs[choice.found.series];
    double along = 1.0;
    if constexpr (Axes == 2) {
        const Eigen::Vector2d chord_m = displacement(at.smoothed, at.window.first, at.window.last);
        if (estimate.noise.correlated_error_detected && chord_m.norm() > 0.0)
            along = error_along(stretch.epochs, estimate.model, chord_m.normalized());
    }
    return error_bound<Axes>(estimate.screened, arc.rows[choice.found.first],
                             arc.rows[choice.found.last], estimate.noise,
                             choice.profile.uncertainty, along, estimate.stands);
}

template <int Axes>
BudgetInput budget_input(const AxesEstimate<Axes>& estimate, const WindowChoice& choice,
                         const PositionSpeed& measured, double duration_s, const WindowFault& fault,
                         const CertifiableWindow& window) {
    const Arc<Axes>& arc = estimate.arcs[choice.found.series];
    return {.trajectory = estimate.trajectory,
            .config = estimate.config,
            .measured = measured,
            .bound = *window.bound,
            .selection = *window.selection,
            .first_row = arc.rows[choice.found.first],
            .last_row = arc.rows[choice.found.last],
            .duration_s = duration_s,
            .mean_interval_s = estimate.screened.basis.time.interval_s.value_or(0.0),
            .vertical = Axes == 1,
            .length = choice.profile.window_kind == WindowKind::course
                          ? std::optional(SurveyedLength{choice.quantity.length_m,
                                                         choice.length_standard_uncertainty_m})
                          : std::nullopt,
            .reliability = window.reliability,
            .detection_power = window.detection_power.value_or(0.0),
            .fault = fault,
            .by_path = counts_path(choice.profile.definition),
            .craft = choice.craft};
}

/// The window's figures by positions with these errors.
template <int Axes>
PositionFigures<Axes> figures_of(const WindowChoice& choice, const EstimatedWindow<Axes>& at,
                                 double measured_m_s, const SpeedDefinitions& definitions,
                                 const SpeedBySource& errors) {
    const SpeedDefinition definition = choice.profile.definition;
    PositionFigures<Axes> figures{
        .start_s = choice.found.start.seconds(),
        .end_s = choice.found.end.seconds(),
        .by_path = counts_path(definition),
        .displacement_m = displacement(at.smoothed, at.window.first, at.window.last),
        .speed = errors};
    figures.speed.speed_m_s = figures.by_path ? definitions.path_length_m_s
                              : definition == SpeedDefinition::displacement
                                  ? measured_m_s
                                  : definitions.displacement_m_s;
    return figures;
}

/// Sets the speed minus the bias of the choice, its budget, and the quantities derived from them.
template <int Axes>
void set_speed_and_budget(const AxesEstimate<Axes>& estimate, const WindowChoice& choice,
                          const EstimatedWindow<Axes>& at, const PositionSpeed& measured,
                          CertifiableWindow& window) {
    const ArcRows& rows = estimate.rows[choice.found.series];
    const UncertaintyRule& rule = choice.profile.uncertainty;
    const SelectionBias& selection = *window.selection;
    const double probability =
        estimate.config.fault_probability_given
            ? estimate.config.fault_probability
            : rule.fault_probability.value_or(estimate.config.fault_probability);
    WindowFault fault = window_fault(estimate.screened, choice.found, choice.all,
                                     {rows.rows[choice.found.first], rows.rows[choice.found.last]},
                                     window.reliability, counts_path(choice.profile.definition),
                                     probability, estimate.lasting);
    BudgetInput input = budget_input(estimate, choice, measured, at.duration_s, fault, window);
    std::vector<BudgetRow> alone = budget_of(input);
    PositionFigures<Axes> figures = figures_of(
        choice, at, measured.speed.speed_m_s, window.definitions, positions_of(alone, fault.prior));
    const ArcMotion<Axes> motion(estimate.trajectory, rows);
    const auto compare_witnesses = [&] {
        return witnessed_speeds(admitted_witnesses(estimate, choice.files_attested), figures,
                                motion);
    };
    std::vector<WitnessedSpeed> witnesses = compare_witnesses();
    if (suspect(choice.contradictions, choice.found, witnesses, fault)) {
        input.fault = fault;
        alone = budget_of(input);
        figures.speed.fault = fault.prior;
        witnesses = compare_witnesses();
    }
    for (WitnessedSpeed& one : witnesses)
        one.confirms = one.confirms && !choice.by_positions_alone;
    WitnessedBudget combined =
        combine_with_witnesses(alone, fault, selection, std::move(witnesses));
    input.position_share = combined.position_share;
    const double craft_m_s = choice.craft ? choice.craft->speed_m_s : 0.0;
    set_speed(measured.speed.speed_m_s + craft_m_s, selection, combined.bias_m_s,
              combined.position_share, window);
    window.own_standard_uncertainty_m_s = own_uncertainty(alone);
    window.budget = std::move(combined.rows);
    window.witnesses = std::move(combined.witnesses);
    window.evidence = std::move(combined.evidence);
    if (window.witnesses.empty())
        window.expected_beside_velocities_m_s = expected_with_velocities(
            window.budget, *window.own_standard_uncertainty_m_s, window.bias_limit_m_s,
            at.duration_s, estimate.trajectory.facts.nominal_interval_s);
    cover_fault_mixture(choice.profile.coverage_factor, alone, window);
    set_uncertainty(window);
    if (choice.extent == CertificateExtent::whole)
        window.monte_carlo = monte_carlo(input, window.budget, window.speed_m_s);
}

/// Raises what is stated with the speed, as the speed itself: the definitions each by their own.
void raise(const SpeedDefinitions& by, double by_m_s, CertifiableWindow& window) {
    for (const auto definition :
         {&SpeedDefinitions::displacement_m_s, &SpeedDefinitions::path_length_m_s,
          &SpeedDefinitions::mean_n_plus_1_m_s, &SpeedDefinitions::mean_n_m_s})
        window.definitions.*definition += by.*definition;
    window.fitted->speed_m_s += by_m_s;
    OtherEstimates& others = *window.estimates;
    for (double* const other : {&others.stiffer_m_s, &others.softer_m_s, &others.whole_m_s})
        *other += by_m_s;
    if (others.chord_m_s) *others.chord_m_s += by_m_s;
}

/// What is stated with the speed, of the reference point as the speed itself.
void move_to_craft(const CraftCorrection& craft, CertifiableWindow& window) {
    raise(craft.definitions, craft.speed_m_s, window);
    if (window.robust) window.robust->speed_m_s += craft.speed_m_s;
    const double duration_s = window.span.duration.seconds();
    window.displacement_m += craft.definitions.displacement_m_s * duration_s;
    *window.length_m += craft.speed_m_s * duration_s;
    for (std::optional<double>* const mean :
         {&window.methods.smoothed_m_s, &window.methods.batch_m_s, &window.methods.v1_m_s,
          &window.methods.v2_m_s, &window.methods.kalman_m_s})
        if (*mean) **mean += craft.definitions.mean_n_plus_1_m_s;
}

/// What is known of a speed in space, from that of its two parts: uncertainties as of errors that
/// are fully correlated, faults of either.
SpeedEvidence evidence_in_space(SpeedEvidence horizontal, const SpeedEvidence& vertical,
                                double level, double upright) {
    for (double SpeedEvidence::*const figure :
         {&SpeedEvidence::position_standard_uncertainty_m_s,
          &SpeedEvidence::slow_standard_uncertainty_m_s,
          &SpeedEvidence::shared_standard_uncertainty_m_s, &SpeedEvidence::fault_m_s,
          &SpeedEvidence::at_a_fifth_m_s, &SpeedEvidence::at_five_times_m_s})
        horizontal.*figure = level * horizontal.*figure + upright * vertical.*figure;
    for (double SpeedEvidence::*const probability :
         {&SpeedEvidence::fault_probability, &SpeedEvidence::chosen_fault_probability})
        horizontal.*probability = std::min(1.0, horizontal.*probability + vertical.*probability);
    return horizontal;
}

}  // namespace

CertifiableWindow window_at(const TrajectoryTable& trajectory, const ArcRows& arc,
                            const FoundWindow& found) {
    CertifiableWindow window;
    const auto epoch = [&](std::size_t k) { return trajectory.rows[arc.rows[k]].epoch; };
    window.span = window_span(trajectory.facts, epoch(found.first), epoch(found.last), found.start,
                              found.end);
    window.arc = arc.number;
    return window;
}

void set_speed(double measured_m_s, const SelectionBias& selection, double bias_m_s, double share,
               CertifiableWindow& window) {
    const bool subtracted = selection.treatment == SelectionTreatment::subtracted;
    window.speed_m_s = subtracted ? less_bias(measured_m_s, bias_m_s) : measured_m_s;
    window.bias_limit_m_s =
        share * (subtracted ? selection.bias_half_range_m_s : selection.bounded_bias_m_s);
}

void set_uncertainty(CertifiableWindow& window) {
    const CombinedUncertainty combined = combine(window.budget);
    window.standard_uncertainty_m_s = combined.standard_uncertainty;
    window.effective_degrees_of_freedom = combined.effective_degrees_of_freedom;
}

SpeedQuantity quantity_of(const Profile& profile) {
    SpeedQuantity quantity;
    quantity.definition = profile.definition;
    quantity.length_is_given =
        profile.window_kind == WindowKind::distance && profile.ends == WindowEnds::any;
    quantity.of_samples =
        profile.exact_duration && profile.definition == SpeedDefinition::displacement;
    return quantity;
}

template <int Axes>
AxesEstimate<Axes> estimate_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                               const WindowConfig& config, const WitnessRecords& records,
                               std::vector<Stand> stands) {
    const NoiseSummary& noise = noise_of<Axes>(trajectory);
    AxesEstimate<Axes> estimate{.screened = screened,
                                .trajectory = trajectory,
                                .config = config,
                                .noise = noise,
                                .model = model_of(noise),
                                .models = posterior_of(noise),
                                .arcs = arcs_of<Axes>(screened, trajectory),
                                .rows = arcs_in(trajectory),
                                .times = {},
                                .witnesses = {},
                                .unattested = {},
                                .stands = std::move(stands),
                                .lasting = {}};
    estimate.witnesses =
        witnesses_of<Axes>(screened, trajectory, records, estimate.model.motion.jerk_density);
    estimate.unattested = estimate.witnesses;
    for (AssessedWitness<Axes>& one : estimate.unattested) {
        one.unanswered = is_second_file(one.kind, records);
        one.confirms = one.confirms && !one.unanswered;
    }
    const auto velocities = std::ranges::find(estimate.witnesses, WitnessKind::velocities,
                                              &AssessedWitness<Axes>::kind);
    estimate.lasting = lasting_difference<Axes>(
        screened, velocities == estimate.witnesses.end() ? nullptr : velocities->motion.get());
    const bool equal =
        std::equal(estimate.arcs.begin(), estimate.arcs.end(), estimate.rows.begin(),
                   estimate.rows.end(), [&](const Arc<Axes>& arc, const ArcRows& own) {
                       return arc.number == own.number && arc.rows == own.rows;
                   });
    if (!equal)
        throw Failure("4-trajectory of receiver " + screened.facts.receiver,
                      "the trajectory does not have the arcs of the screened epochs",
                      "Run runcert-smooth again");
    for (const Arc<Axes>& arc : estimate.arcs) {
        std::vector<ElapsedTime>& times = estimate.times.emplace_back();
        for (const std::size_t row : arc.rows)
            times.push_back(screened.rows[row].time);
    }
    return estimate;
}

template <int Axes>
CertifiableWindow certify_by_positions(const AxesEstimate<Axes>& estimate,
                                       const WindowChoice& choice) {
    const FoundWindow& found = choice.found;
    const auto [part, smoothed] = checked_estimate(estimate, found);
    const ArcWithInstants<Axes> at = with_instants(part.arc, part.times, found.start, found.end);
    const WindowStretch<Axes> stretch = cut_stretch(at.arc, at.window, stretch_margin_s);
    // A window that begins or ends between epochs is smoothed again with these instants included.
    const bool between_epochs = at.arc.epochs.size() != part.arc.epochs.size();
    const Chain<Axes> between =
        between_epochs ? Chain<Axes>(at.arc.epochs, estimate.model) : Chain<Axes>{};
    const Chain<Axes>& smoothed_at = between_epochs ? between : smoothed;

    const EstimatedWindow<Axes> estimated{.epochs = at.arc.epochs,
                                          .smoothed = smoothed_at,
                                          .model = estimate.model,
                                          .window = at.window,
                                          .duration_s = stretch.duration_s};
    const double lacking_m_s = lacking_for_curvature(estimate, found);
    const ErrorBound bound = bound_of(estimate, choice, estimated, stretch);
    const SpeedWeights<Axes> weights = speed_weights(estimated, choice.quantity);
    PositionSpeed measured = speed_by_positions(estimated, choice.quantity, weights, bound);

    CertifiableWindow window = window_at(estimate.trajectory, estimate.rows[found.series], found);
    window.methods = methods_of(estimate, found);
    window.definitions = definitions_of(smoothed_track(smoothed_at), at.window, stretch.duration_s);
    window.fitted = fitted_speed(stretch, estimate.models, choice.quantity);
    window.estimates = other_estimates(estimated, choice.quantity, weights, measured);
    raise({lacking_m_s, lacking_m_s, lacking_m_s, lacking_m_s}, lacking_m_s, window);
    measured.model_m_s = window.estimates->half_width_m_s;
    measured.speed.speed_m_s += lacking_m_s;
    if constexpr (Axes == 2)
        window.robust = robust_speed(estimate.trajectory, part, smoothed, measured.model_m_s);
    window.bound = bound;
    window.bound->standard_uncertainty_m_s = measured.speed.standard_uncertainty_m_s;
    window.displacement_m = measured.displacement_m;
    window.length_m = measured.speed.speed_m_s * window.span.duration.seconds();
    window.position_r95_m = position_r95_m(smoothed, part.window, bound);
    window.detection_power = estimate.screened.basis.power;
    window.reliability =
        undetected_errors<Axes>(estimate.screened, at.arc, stretch,
                                std::span(weights).subspan(stretch.first, stretch.epochs.size()));
    const SpeedEstimate searched = smoothed_speed(smoothed_at, at.window, stretch.duration_s, {});
    window.selection =
        selection_of(estimate, choice, bound, searched.standard_uncertainty_m_s, measured.speed);
    set_speed_and_budget(estimate, choice, estimated, measured, window);
    if (choice.craft) move_to_craft(*choice.craft, window);
    return window;
}

CertifiableWindow speed_in_space(const CertifiableWindow& horizontal,
                                 const CertifiableWindow& vertical) {
    CertifiableWindow window = horizontal;
    const double speed = std::hypot(horizontal.speed_m_s, vertical.speed_m_s);
    const double level = speed > 0.0 ? horizontal.speed_m_s / speed : 1.0;
    const double upright = speed > 0.0 ? vertical.speed_m_s / speed : 1.0;
    const double of_level = level * horizontal.standard_uncertainty_m_s;
    const double of_upright = upright * vertical.standard_uncertainty_m_s;
    for (BudgetRow& row : window.budget)
        scale(row, level);
    BudgetRow row = speed_row("v", "vertical part of the speed", "B",
                              std::sqrt(of_upright * of_upright + 2.0 * of_level * of_upright),
                              RowScope::source,
                              fmt::format("its own standard uncertainty is {:.4f} m/s",
                                          vertical.standard_uncertainty_m_s));
    row.estimate = vertical.speed_m_s;
    row.correlation =
        "fully correlated with all other rows together; what it adds to them is given";
    window.budget.push_back(std::move(row));
    window.speed_m_s = speed;
    window.standard_uncertainty_m_s = of_level + of_upright;
    window.bias_limit_m_s = level * horizontal.bias_limit_m_s + upright * vertical.bias_limit_m_s;
    window.evidence = window.evidence && vertical.evidence
                          ? std::optional(evidence_in_space(*horizontal.evidence,
                                                            *vertical.evidence, level, upright))
                          : std::nullopt;
    window.estimates = std::nullopt;
    window.own_standard_uncertainty_m_s = std::nullopt;
    window.length_m = speed * window.span.duration.seconds();
    window.definitions.displacement_m_s =
        std::hypot(horizontal.definitions.displacement_m_s, vertical.definitions.displacement_m_s);
    window.fitted = std::nullopt;
    window.monte_carlo = std::nullopt;
    window.reliability.insert(window.reliability.end(), vertical.reliability.begin(),
                              vertical.reliability.end());
    return window;
}

template AxesEstimate<1> estimate_of<1>(const ScreenedTable&, const TrajectoryTable&,
                                        const WindowConfig&, const WitnessRecords&,
                                        std::vector<Stand>);
template AxesEstimate<2> estimate_of<2>(const ScreenedTable&, const TrajectoryTable&,
                                        const WindowConfig&, const WitnessRecords&,
                                        std::vector<Stand>);
template CertifiableWindow certify_by_positions<1>(const AxesEstimate<1>&, const WindowChoice&);
template CertifiableWindow certify_by_positions<2>(const AxesEstimate<2>&, const WindowChoice&);

}  // namespace runcert
