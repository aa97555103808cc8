#include "stages/screen/screen.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "stages/screen/baseline.h"
#include "stages/screen/decisions.h"
#include "stages/screen/device_signs.h"
#include "stages/screen/epoch_checks.h"
#include "stages/screen/examination.h"
#include "stages/screen/innovation_test.h"
#include "stages/screen/speed_tests.h"
#include "stages/screen/time_check.h"
#include "stages/screen/velocity_check.h"
#include "stages/screen/witness_check.h"
#include "witness/arcs.h"
#include "witness/receiver_witness.h"
#include "witness/recorded_velocities.h"

namespace runcert {
namespace {

/// The rows after a first look, from which the noise is estimated.
ScreenedTable first_look(const ScreenedTable& screened, const ScreenConfig& config) {
    ScreenedTable table = screened;
    const bool vertical = table.facts.vertical_measured;
    table.variance_factor = robust_variance_factor(table.rows, vertical, config);
    test_innovations(table.rows, vertical, table.variance_factor, config);
    drop_short_arcs(table.rows, config);
    return table;
}

ScreeningNoises estimate_noises(const ScreenedTable& look, const ScreenConfig& config,
                                ScreeningBasis& basis) {
    ScreeningNoises noises;
    std::vector<FixTypeErrors> of_heights;
    do_together(
        [&] {
            noises.horizontal = estimate_screening_noise<2>(look, config);
            basis.fix_types = compare_fix_types<2>(look, noises.horizontal);
        },
        [&] {
            if (!look.facts.vertical_measured) return;
            noises.vertical = estimate_screening_noise<1>(look, config);
            of_heights = compare_fix_types<1>(look, *noises.vertical);
        });
    basis.models = {noises.horizontal.summary};
    if (noises.vertical) basis.models.push_back(noises.vertical->summary);
    basis.fix_types.insert(basis.fix_types.end(), of_heights.begin(), of_heights.end());
    noises.horizontal_factors = kind_factors(basis, TestedAxes::horizontal);
    noises.vertical_factors = kind_factors(basis, TestedAxes::vertical);
    return noises;
}

/// The arcs of one group of axes, and the decisions on each.
template <int Axes>
struct AdaptedArcs {
    std::vector<Arc<Axes>> arcs;
    std::vector<ArcDecisions> decisions;
};

/// The plan is copied, because it caches values and the two groups of axes are tested in parallel.
template <int Axes>
AdaptedArcs<Axes> adapt_arcs(const ScreenedTable& screened, const EstimationModel& model,
                             const std::map<FixType, double>& factors, const TestPlan plan,
                             const ScreenConfig& config) {
    AdaptedArcs<Axes> adapted{.arcs = tested_arcs<Axes>(screened, model, factors), .decisions = {}};
    for (const Arc<Axes>& arc : adapted.arcs)
        adapted.decisions.push_back(adapt<Axes>(arc.epochs, model, plan, config.section_epochs));
    return adapted;
}

template <int Axes>
void mark_arcs(ScreenedTable& screened, const AdaptedArcs<Axes>& adapted, bool on_the_ground,
               ScreeningBasis& basis) {
    constexpr TestedAxes axes = tested_axes<Axes>;
    for (std::size_t a = 0; a < adapted.arcs.size(); ++a) {
        const ArcDecisions& decisions = adapted.decisions[a];
        basis.passes = std::max(basis.passes, decisions.passes);
        const auto largest =
            mark_rows(screened.rows, adapted.arcs[a].rows, decisions, axes, on_the_ground);
        if (largest &&
            (!basis.largest_decision || largest->epochs > basis.largest_decision->epochs)) {
            basis.largest_decision = largest;
            basis.largest_decision->share =
                static_cast<double>(largest->epochs) / static_cast<double>(screened.rows.size());
        }
    }
}

void test_positions(ScreenedTable& screened, const ScreeningNoises& noises, const TestPlan& plan,
                    const ScreenConfig& config, ScreeningBasis& basis) {
    // Both groups of axes are tested on the epochs that passed their own checks.
    AdaptedArcs<2> horizontal;
    AdaptedArcs<1> vertical;
    do_together(
        [&] {
            horizontal = adapt_arcs<2>(screened, noises.horizontal.model, noises.horizontal_factors,
                                       plan, config);
        },
        [&] {
            if (noises.vertical)
                vertical = adapt_arcs<1>(screened, noises.vertical->model, noises.vertical_factors,
                                         plan, config);
        });
    // No craft on the ground goes up or down faster. Craft that do have vertical speed in their
    // score.
    constexpr double on_the_ground_m_s = 20.0;
    const bool on_the_ground = config.limits.vertical_rate_m_s <= on_the_ground_m_s;
    mark_arcs(screened, horizontal, on_the_ground, basis);
    mark_arcs(screened, vertical, on_the_ground, basis);
}

/// The inputs of a check over arcs, in addition to the table.
struct ArcCheck {
    const ScreeningNoises& noises;
    const TestPlan& plan;
    const ScreenConfig& config;
};

void finish_arcs(ScreenedTable& screened, const ScreenConfig& config) {
    finish_arcs(screened.rows, config.bridged_s(screened.facts.nominal_interval_s),
                config.min_arc_epochs);
}

/// Tests the positions against a witness. Returns whether anything was marked.
bool contradicts(ScreenedTable& screened, const DisplacementTest& test, const ArcCheck& check,
                 ScreeningBasis& basis) {
    DisplacementComparison found = check_displacements(
        screened.rows, test, screened.facts.nominal_interval_s, check.plan.size());
    const bool any = found.rejected > 0;
    note(std::move(found), basis.displacements);
    return any;
}

bool phases_contradict(ScreenedTable& screened, const Witness<2>* phases, const ArcCheck& check,
                       ScreeningBasis& basis) {
    if (phases == nullptr) return false;
    return contradicts(screened, {.kind = WitnessKind::phases, .witness = phases}, check, basis);
}

bool velocities_contradict(ScreenedTable& screened, const Motion& motion, const ArcCheck& check,
                           ScreeningBasis& basis) {
    VelocityFindings found = check_velocities(
        screened.rows, motion,
        {.delay_max_s = check.config.velocity_delay_max_s,
         .share_max = check.config.velocity_share_max,
         .nominal_interval_s = screened.facts.nominal_interval_s,
         .jerk_density = check.noises.horizontal.model.motion.jerk_density,
         .vertical_measured = screened.facts.vertical_measured,
         .position_resolution_m = screened.facts.position_resolution_m.value_or(0.0),
         .test_size = check.plan.size()});
    const std::int64_t marked = found.comparison ? found.comparison->rejected : 0;
    if (found.comparison && basis.velocity) found.comparison->rejected += basis.velocity->rejected;
    basis.velocity = found.comparison;
    basis.velocity_errors = std::move(found.errors);
    return marked > 0;
}

bool handed_in_contradict(ScreenedTable& screened, const Motion& motion, const HandedIn& given,
                          const ArcCheck& check, ScreeningBasis& basis) {
    if (given.series.empty()) return false;
    const Track track = track_of(screened, motion);
    const std::vector<TimedPosition<2>> positions = timed_positions<2>(screened.rows);
    for (const WitnessEntry& entry : witness_roster()) {
        if (!entry.screening) continue;
        const auto witness = handed_in_witness(entry, given, positions, track,
                                               check.noises.horizontal.model.motion.jerk_density);
        if (witness && !witness->is_copy &&
            contradicts(screened, {.kind = entry.kind, .witness = witness->motion.get()}, check,
                        basis))
            return true;
    }
    return false;
}

bool limits_are_broken(ScreenedTable& screened, const Motion& motion, const ArcCheck& check,
                       ScreeningBasis& basis) {
    PhysicalLimits allowed = check.config.limits;
    allowed.test_size = check.plan.size();
    LimitComparison found = check_limits(screened.rows, motion, allowed);
    const bool any = found.rejected > 0;
    found.rejected += basis.limits.rejected;
    basis.limits = found;
    return any;
}

/// Asks the witnesses in turn. Their marks change the motion, so that they are asked again, for a
/// few rounds. The physical limits hold for every epoch that is left, however many rounds it takes.
Motion check_witnesses_and_limits(ScreenedTable& screened, const ArcCheck& check,
                                  const ScreeningWitnesses& witnesses, ScreeningBasis& basis) {
    constexpr int rounds = 4;
    const auto examined = [&] {
        return examine_arcs(screened, check.noises, check.plan, check.config.section_epochs);
    };
    for (int round = 0; round < rounds; ++round) {
        finish_arcs(screened, check.config);
        if (phases_contradict(screened, witnesses.phases, check, basis)) continue;
        Motion motion = examined();
        if (velocities_contradict(screened, motion, check, basis) ||
            handed_in_contradict(screened, motion, witnesses.handed_in, check, basis) ||
            limits_are_broken(screened, motion, check, basis))
            continue;
        return motion;
    }
    for (;;) {
        finish_arcs(screened, check.config);
        Motion motion = examined();
        if (!limits_are_broken(screened, motion, check, basis)) return motion;
    }
}

/// A receiver screened on its own, with what is needed to examine its arcs again.
struct ReceiverScreening {
    ScreenedTable table;
    ScreeningNoises noises;
    TestPlan plan;
    Motion motion;
};

std::vector<ScreenedEpoch> in_order_of_time(const std::vector<EnuEpoch>& rows,
                                            const std::vector<std::size_t>& order) {
    std::vector<ScreenedEpoch> ordered;
    ordered.reserve(rows.size());
    for (const std::size_t row : order)
        static_cast<EnuEpoch&>(ordered.emplace_back()) = rows[row];
    return ordered;
}

/// Adds a seam where a row belongs to another place than the one before it.
void add_changes_of_place(const std::vector<ScreenedEpoch>& rows, const FrameOrigin& origin,
                          std::vector<bool>& seams) {
    for (std::size_t i = 1; i < rows.size(); ++i)
        if (origin.number_at(rows[i].time) != origin.number_at(rows[i - 1].time)) seams[i] = true;
}

/// What there is to test. A witness is compared over 3 s and 10 s, and between neighbouring epochs
/// where it is precise enough; recorded velocities also with the smoothed motion.
TestedData tested_data(const EnuTable& table, const ScreenConfig& config,
                       const ScreeningWitnesses& witnesses, bool second_receiver) {
    const bool heights = table.facts.vertical_measured;
    const PhysicalLimits& limits = config.limits;
    TestedData data{.position_series = heights ? 2 : 1,
                    .baseline_series = second_receiver ? 2 : 0,
                    .comparisons = (heights && witnesses.ground != nullptr) +
                                   (limits.acceleration_m_s2 > 0.0) + (limits.jerk_m_s3 > 0.0) +
                                   (heights && limits.vertical_rate_m_s > 0.0)};
    const auto recorded = [&](bool upright) {
        return std::ranges::any_of(table.rows, [&](const EnuEpoch& row) {
            return recorded_speed(row, !upright, upright).has_value();
        });
    };
    const bool velocities = recorded(false);
    data.speed_series = (velocities ? 1 : 0) + (recorded(true) ? 1 : 0);
    for (const WitnessEntry& entry : witness_roster()) {
        const bool is_there =
            entry.kind == WitnessKind::receiver     ? second_receiver
            : entry.kind == WitnessKind::velocities ? velocities
            : entry.kind == WitnessKind::phases
                ? witnesses.phases != nullptr
                : witnesses.handed_in.series.contains(std::string(to_text(entry.kind)));
        if (entry.screening && is_there)
            data.comparisons += 2 + (entry.screening->single_epochs ? 1 : 0) +
                                (entry.kind == WitnessKind::velocities ? 1 : 0);
    }
    return data;
}

ReceiverScreening screen_alone(const EnuTable& table, const ScreenConfig& config,
                               const ScreeningWitnesses& witnesses, bool second_receiver) {
    ScreenedTable screened;
    screened.facts = table.facts;
    screened.origin = table.origin;
    const double nominal_interval_s = table.facts.nominal_interval_s;
    const TimeOrder order = order_by_time(table.rows, {.interval_s = nominal_interval_s,
                                                       .gap_factor = config.gap_factor,
                                                       .session_gap_s = config.session_gap_s,
                                                       .fewest = config.min_arc_epochs});
    screened.rows = in_order_of_time(table.rows, order.rows);
    const auto sorted = [&](const auto& of_rows) {
        std::remove_cvref_t<decltype(of_rows)> result;
        for (const std::size_t row : order.rows)
            result.push_back(of_rows[row]);
        return result;
    };
    check_epochs(screened.rows, sorted(order.standing), table.facts.vertical_measured, config,
                 screened.origin);
    std::vector<bool> seams = sorted(order.seam);
    if (screened.origin) add_changes_of_place(screened.rows, *screened.origin, seams);
    number_arcs(screened.rows, seams, nominal_interval_s, config);
    TestPlan plan(config.family_false_alarm_rate,
                  std::max<std::int64_t>(1, summarise(screened.rows).usable) *
                      tests_of_an_epoch(tested_data(table, config, witnesses, second_receiver),
                                        config.burst_epochs_max),
                  config.power, config.burst_epochs_max, config.limits.acceleration_m_s2);
    ScreeningBasis basis;
    basis.family_false_alarm_rate = config.family_false_alarm_rate;
    basis.tests = plan.tests();
    basis.test_size = plan.size();
    basis.power = plan.power();
    basis.burst_epochs_max = config.burst_epochs_max;
    basis.time = examine_time(table.rows, {.nominal_interval_s = nominal_interval_s,
                                           .gap_factor = config.gap_factor,
                                           .session_gap_s = config.session_gap_s});
    basis.time.moved = order.moved;
    basis.time.left_out = std::ranges::count_if(order.standing, [](TimeStanding standing) {
        return standing == TimeStanding::same_time || standing == TimeStanding::out_of_order;
    });
    basis.device = find_device_signs(screened.rows, nominal_interval_s,
                                     table.facts.position_resolution_m.value_or(0.0));
    finish_arcs(screened, config);
    ScreeningNoises noises;
    {
        const ScreenedTable look = first_look(screened, config);
        screened.variance_factor = look.variance_factor;
        noises = estimate_noises(look, config, basis);
    }
    test_positions(screened, noises, plan, config, basis);
    basis.speeds = screen_speeds(screened.rows, plan, noises.horizontal.model.motion.jerk_density,
                                 config, nominal_interval_s);
    if (witnesses.ground != nullptr)
        basis.surface = check_surface(screened, *witnesses.ground, plan);
    Motion motion = check_witnesses_and_limits(
        screened, {.noises = noises, .plan = plan, .config = config}, witnesses, basis);
    screened.basis = std::move(basis);
    return {.table = std::move(screened),
            .noises = std::move(noises),
            .plan = std::move(plan),
            .motion = std::move(motion)};
}

/// Finishes the arcs and re-estimates their motion after rows were marked.
void examine_again(ReceiverScreening& one, const ScreenConfig& config) {
    finish_arcs(one.table, config);
    one.motion = examine_arcs(one.table, one.noises, one.plan, config.section_epochs);
}

/// Whether one of two receivers contradicts the other as its witness. Which one errs cannot be
/// decided, so each marks the other.
bool receivers_contradict(std::array<ReceiverScreening*, 2> pair, const ScreenConfig& config) {
    const std::array tracks{track_of(pair[0]->table, pair[0]->motion),
                            track_of(pair[1]->table, pair[1]->motion)};
    bool any = false;
    for (const std::size_t own : {0U, 1U}) {
        const std::size_t other = 1U - own;
        const auto witness = receiver_witness<2>(tracks[other], tracks[own]);
        if (!witness) continue;
        ReceiverScreening& judged = *pair[own];
        const bool marked = contradicts(
            judged.table,
            {.kind = WitnessKind::receiver,
             .receiver = pair[other]->table.facts.receiver,
             .witness = &*witness},
            {.noises = judged.noises, .plan = judged.plan, .config = config}, judged.table.basis);
        any = any || marked;
    }
    return any;
}

}  // namespace

ScreenConfig screen_config(const Attempt& attempt) {
    ScreenConfig config{attempt.parameters.screen};
    for (const std::string& word : config.allowed_fixes) {
        FixType fix{};
        from_text(word, fix);
        config.counted_fixes.insert(counted_as(fix));
    }
    config.tau_min_s = attempt.parameters.smooth.error_time_min_s;
    config.tau_max_s = attempt.parameters.smooth.error_time_max_s;
    config.limits.acceleration_m_s2 = config.acceleration_max_m_s2;
    config.limits.jerk_m_s3 = config.jerk_max_m_s3;
    config.limits.vertical_rate_m_s = config.vertical_rate_max_m_s;
    return config;
}

ScreenedTable screen(const EnuTable& table, const ScreenConfig& config,
                     const ScreeningWitnesses& witnesses) {
    return screen_alone(table, config, witnesses, false).table;
}

std::vector<ScreenedTable> screen_receivers(std::span<const EnuTable> tables,
                                            const ScreenConfig& config,
                                            std::span<const ScreeningWitnesses> witnesses) {
    std::vector<ReceiverScreening> receivers;
    for (std::size_t i = 0; i < tables.size(); ++i)
        receivers.push_back(screen_alone(tables[i], config,
                                         witnesses.empty() ? ScreeningWitnesses{} : witnesses[i],
                                         tables.size() > 1));
    if (receivers.size() > 1) {
        ReceiverScreening &first = receivers[0], &second = receivers[1];
        const auto strictest = std::ranges::min_element(
            receivers, {}, [](const ReceiverScreening& one) { return one.plan.size(); });
        bool marked =
            compare_receivers(first.table, second.table, first.motion, strictest->plan, config);
        constexpr int rounds = 4;
        for (int round = 0; round < rounds; ++round) {
            if (marked)
                for (ReceiverScreening* const one : {&first, &second})
                    examine_again(*one, config);
            if (round + 1 == rounds) break;
            marked = receivers_contradict({&first, &second}, config);
            if (!marked) break;
        }
    }
    std::vector<ScreenedTable> screened;
    for (ReceiverScreening& one : receivers)
        screened.push_back(std::move(one.table));
    return screened;
}

}  // namespace runcert
