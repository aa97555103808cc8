#include "stages/window/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/geodesy.h"
#include "witness/antenna_swing.h"
#include "witness/continuity.h"

namespace runcert {

BudgetRow quantity_row(std::string symbol, std::string source, std::string type,
                       double standard_uncertainty, std::string unit, double sensitivity,
                       RowScope touches, std::string note) {
    return {.symbol = std::move(symbol),
            .source = std::move(source),
            .estimate = 0.0,
            .unit = std::move(unit),
            .standard_uncertainty = standard_uncertainty,
            .type = std::move(type),
            .distribution = "normal",
            .degrees_of_freedom = std::nullopt,
            .sensitivity = sensitivity,
            .contribution_m_s = standard_uncertainty * std::abs(sensitivity),
            .touches = touches,
            .note = std::move(note)};
}

BudgetRow speed_row(std::string symbol, std::string source, std::string type,
                    double contribution_m_s, RowScope touches, std::string note) {
    return quantity_row(std::move(symbol), std::move(source), std::move(type), contribution_m_s,
                        "m / s", 1.0, touches, std::move(note));
}

BudgetRow bounded_row(std::string symbol, std::string source, double half_width, std::string unit,
                      double sensitivity, RowScope touches, std::string note) {
    BudgetRow row =
        quantity_row(std::move(symbol), std::move(source), "B", rectangular_uncertainty(half_width),
                     std::move(unit), sensitivity, touches, std::move(note));
    row.distribution = "rectangular";
    return row;
}

namespace {

/// At least one degree of freedom, because fewer have no distribution to draw from.
std::optional<double> degrees_of(const NoiseParameter& parameter) {
    return parameter.relative_uncertainty
               ? degrees_of_freedom(std::min(*parameter.relative_uncertainty, 0.7))
               : std::nullopt;
}

/// The largest jerk density used to estimate the window's epochs.
double largest_jerk_density(const BudgetInput& input) {
    double largest = 0.0;
    for (std::size_t i = input.first_row; i <= input.last_row; ++i) {
        const TrajectoryEpoch& row = input.trajectory.rows[i];
        largest = std::max(largest,
                           (input.vertical ? row.jerk_density_up : row.jerk_density).value_or(0.0));
    }
    return largest;
}

std::vector<BudgetRow> position_rows(const BudgetInput& input) {
    std::vector<BudgetRow> rows;
    const auto& estimation = input.trajectory.estimation;
    const NoiseSummary& fit =
        (input.vertical ? estimation.vertical.value() : estimation.horizontal).noise;
    const double scale = fit.measurement_scale.value;
    BudgetRow white = speed_row(
        "w", "white noise of the positions", "A", input.measured.white_m_s, RowScope::source,
        fmt::format("{:.3f} times the stated standard deviations, as the data show", scale));
    white.degrees_of_freedom = degrees_of(fit.measurement_scale);
    rows.push_back(std::move(white));

    const bool fitted = input.bound.decided_by == BoundSource::fitted;
    BudgetRow slow =
        speed_row("b", "time-correlated error of the positions", fitted ? "A" : "B",
                  input.measured.correlated_m_s, RowScope::slow,
                  fmt::format("standard deviation {:.4f} m ({}), any correlation time from {:g} s "
                              "to {:g} s",
                              input.bound.sigma_m, to_text(input.bound.decided_by),
                              input.bound.tau_min_s, input.bound.tau_max_s));
    if (fitted) slow.degrees_of_freedom = degrees_of(*fit.error_diffusion);
    rows.push_back(std::move(slow));

    BudgetRow motion = speed_row(
        "j", "motion of the craft between the measurements", "A", input.measured.motion_m_s,
        RowScope::source,
        fmt::format("jerk density {:.4f} m s^-2.5 at the window", largest_jerk_density(input)));
    motion.degrees_of_freedom = degrees_of(fit.jerk_density);
    rows.push_back(std::move(motion));
    rows.push_back(bounded_row(
        "o", "choice of the model of the motion", input.measured.model_m_s, "m / s", 1.0,
        RowScope::source,
        "other jerk densities, and the measured positions at the window's ends without a model"));
    return rows;
}

/// The step of the time stamps. It is as the recording states, otherwise the largest power of ten
/// of a second that divides all stamps.
double time_resolution_s(const BudgetInput& input) {
    const auto& facts = input.trajectory.facts;
    if (facts.time_resolution_s) return *facts.time_resolution_s;
    std::int64_t step_ns = 1'000'000'000;
    for (std::size_t i = input.first_row; i <= input.last_row; ++i)
        while (step_ns > 1 && input.trajectory.rows[i].time.nanoseconds % step_ns != 0)
            step_ns /= 10;
    return static_cast<double>(step_ns) * 1e-9;
}

/// Whether every stamp of the window is a whole number of nominal intervals from its beginning.
/// Truncation to the resolution is then the same at both ends.
bool stamps_are_regular(const BudgetInput& input) {
    const auto& rows = input.trajectory.rows;
    const std::int64_t nominal_ns = std::llround(input.trajectory.facts.nominal_interval_s * 1e9);
    if (nominal_ns <= 0) return false;
    for (std::size_t i = input.first_row; i <= input.last_row; ++i)
        if ((rows[i].time.nanoseconds - rows[input.first_row].time.nanoseconds) % nominal_ns != 0)
            return false;
    return true;
}

/// Row t. A displacement takes another time; the mean of recorded speeds changes where places
/// determine its ends.
BudgetRow time_row(const BudgetInput& input) {
    const double resolution_s = time_resolution_s(input);
    const bool regular = stamps_are_regular(input);
    const auto rows = std::span(input.trajectory.rows)
                          .subspan(input.first_row, input.last_row - input.first_row + 1);
    const double wander_s = regular || input.mean_interval_s == 0.0
                                ? 0.0
                                : beyond_whole_intervals_s(rows, input.mean_interval_s);
    const bool wanders = wander_s > resolution_s;
    // The errors of both ends are independent.
    const double rounding_s = regular ? 0.0 : 0.5 * resolution_s * std::numbers::sqrt2;
    const double half_width_s = wanders ? wander_s : rounding_s;
    BudgetRow row = bounded_row(
        "t", "time stamps of the window's ends", half_width_s, "s",
        input.recorded ? input.recorded->changes_m_s2.value_or(0.0)
                       : -input.measured.speed.speed_m_s / input.duration_s,
        RowScope::source,
        regular ? std::string("stamps are whole multiples of the interval: what rounding may have "
                              "cut off is the same at both ends")
        : wanders ? fmt::format("the steps lead, in sum, {:.4f} s away from the mean interval of "
                                "the recording",
                                wander_s)
                  : fmt::format("stamps are irregular, with a resolution of {:g} s", resolution_s));
    row.estimate = input.duration_s;
    return row;
}

BudgetRow delay_row(const RecordedSource& recorded) {
    BudgetRow row = quantity_row(
        "l", "delay of the recorded speeds behind the positions", "B", recorded.sigma_delay_s, "s",
        recorded.changes_m_s2.value_or(0.0), RowScope::source,
        recorded.changes_m_s2 ? "it moves both ends of the window"
                              : "the window is of the moments of the speeds, whichever "
                                "they are: only a window whose ends are places changes");
    row.estimate = recorded.delay_s;
    return row;
}

/// Row k. It is negligible over a window for a clock steered by satellites.
BudgetRow clock_row(const BudgetInput& input) {
    const std::string& source = input.trajectory.facts.time_source;
    const bool unknown = source == "unknown";
    BudgetRow row = bounded_row(
        "k", "rate of the clock that made the time stamps",
        unknown ? input.config.clock_rate_bound : 0.0, "1", -input.measured.speed.speed_m_s,
        RowScope::window,
        source == "satellites" ? std::string("the satellites' time, as the format has it")
        : source == "attempt"  ? std::string("the satellites' time, as the attempt states")
                               : fmt::format("whose clock it is was not stated; bound by parameter "
                                              "window.clock_rate_bound, {:g}",
                                             input.config.clock_rate_bound));
    row.estimate = 1.0;
    return row;
}

BudgetRow resolution_row(const BudgetInput& input) {
    if (input.recorded)
        return bounded_row(
            "r", "resolution of the recorded speeds", 0.5 * input.recorded->resolution_m_s, "m / s",
            1.0, RowScope::source,
            fmt::format("speeds in steps of {:.2g} m/s", input.recorded->resolution_m_s));
    const auto& resolution_m = input.trajectory.facts.position_resolution_m;
    return bounded_row(
        "r", "resolution of the recorded coordinates",
        0.5 * resolution_m.value_or(0.0) * std::numbers::sqrt2, "m", 1.0 / input.duration_s,
        RowScope::source,
        resolution_m
            ? fmt::format("coordinates in steps of {:.2g} m", *resolution_m)
            : std::string(
                  "not known of this recording; it is part of the white noise that the data show"));
}

BudgetRow plane_row(const BudgetInput& input) {
    const double speed_m_s = input.measured.speed.speed_m_s;
    const bool georeferenced = input.trajectory.facts.georeferenced;
    double half_width = input.config.plane_scale_bound;
    std::string note =
        "the scale of the engineering CRS was not stated; bound by parameter "
        "window.plane_scale_bound";
    if (georeferenced) {
        const TrajectoryEpoch& first = input.trajectory.rows[input.first_row];
        const TrajectoryEpoch& last = input.trajectory.rows[input.last_row];
        const double distance_m = std::max(std::hypot(*first.east_m, *first.north_m),
                                           std::hypot(*last.east_m, *last.north_m));
        half_width = 0.5 * std::pow(distance_m / earth_mean_radius_m, 2);
        note = fmt::format("{:.1f} km from the origin at most", distance_m / 1000.0);
    }
    BudgetRow row = bounded_row(
        "m",
        georeferenced ? "local frame against the ground" : "scale of the engineering coordinates",
        half_width, "1", speed_m_s, RowScope::window, std::move(note));
    row.estimate = 1.0;
    return row;
}

/// Row of the height that the attempt states where none was measured. It converts angles to
/// lengths.
std::optional<BudgetRow> height_row(const BudgetInput& input) {
    const RecordingFacts& facts = input.trajectory.facts;
    if (facts.vertical_measured || !facts.georeferenced || input.length) return std::nullopt;
    const double bound_m = input.config.height_bound_m;
    return bounded_row(
        "h", "height of the course, as the attempt states it", bound_m, "m",
        input.measured.speed.speed_m_s / earth_mean_radius_m, RowScope::window,
        fmt::format("not measured; {:g} m allowed for, by parameter window.height_bound_m",
                    bound_m));
}

/// The deviation of the ellipsoid's normal, along which heights are measured, from the plumb line.
BudgetRow plumb_row(const BudgetInput& input) {
    constexpr double deflection_rad = 3e-4;  // one minute of arc, as in high mountains
    const TrajectoryEpoch& first = input.trajectory.rows[input.first_row];
    const TrajectoryEpoch& last = input.trajectory.rows[input.last_row];
    const double moved_m = std::hypot(*last.east_m - *first.east_m, *last.north_m - *first.north_m);
    return bounded_row(
        "m", "vertical of the ellipsoid against the plumb line", deflection_rad, "1",
        moved_m / input.duration_s, RowScope::window,
        fmt::format("{:.1f} m moved horizontally; one minute of arc allowed for", moved_m));
}

/// The relation between lengths in the local frame and lengths on the ground.
BudgetRow frame_row(const BudgetInput& input) {
    if (input.length)
        return bounded_row("m", "local frame against the ground", 0.0, "1", 0.0, RowScope::window,
                           "the length is the surveyed one");
    return input.vertical ? plumb_row(input) : plane_row(input);
}

BudgetRow length_row(const SurveyedLength& length, double duration_s) {
    BudgetRow row =
        quantity_row("c", "surveyed length of the course", "B", length.standard_uncertainty_m, "m",
                     1.0 / duration_s, RowScope::window, "as the attempt states it");
    row.estimate = length.length_m;
    row.contribution_m_s = length.standard_uncertainty_m / duration_s;
    return row;
}

BudgetRow antenna_row(const BudgetInput& input) {
    if (const auto& motion = input.config.antenna_motion)
        return bounded_row("a", "motion of the antenna against the craft",
                           swing_bound_m_s(*motion, std::abs(input.measured.speed.speed_m_s),
                                           input.duration_s, input.by_path),
                           "m / s", 1.0, RowScope::antenna,
                           fmt::format("antenna {:g} m above the craft, roll of at most {:g} and "
                                       "pitch of at most {:g} degrees, as the attempt states",
                                       motion->height_m, motion->roll_deg, motion->pitch_deg));
    const auto& arm = input.config.lever_arm;
    const auto& rotation = input.config.rotation_bound_deg;
    double moved_m = 0.0;
    std::string note = arm ? "no bound on the craft's rotation stated: the speed is the antenna's"
                           : "no lever arm stated: the speed is the antenna's";
    if (arm && rotation) {
        moved_m = 2.0 * arm->norm() * std::sin(0.5 * *rotation * radians_per_degree);
        note = fmt::format(
            "lever arm {:.3f} m, rotation of at most {:g} degrees between the window's ends",
            arm->norm(), *rotation);
    }
    return bounded_row("a", "antenna against the craft's reference point", moved_m, "m",
                       1.0 / input.duration_s, RowScope::antenna, std::move(note));
}

/// The rows of what an IMU says of antenna and reference point.
void add_craft_rows(const CraftCorrection& craft, std::vector<BudgetRow>& rows) {
    rows.push_back(speed_row(
        "a", "lever arm between antenna and reference point", "B", craft.arm_m_s, RowScope::antenna,
        fmt::format("each of its components known to {:.3f} m; the reference point is {:+.4f} "
                    "m/s faster than the antenna",
                    craft.arm_sigma_m, craft.speed_m_s)));
    rows.push_back(speed_row("y", "attitude of the craft", "A", craft.attitude_m_s,
                             RowScope::antenna, "by the joint covariance of IMU and positions"));
    rows.push_back(quantity_row("z", "clock of the IMU against that of the positions", "B",
                                craft.lag_sigma_s, "s", craft.lag_m_s_per_s, RowScope::antenna,
                                craft.lag_sigma_s > 0.0
                                    ? "not estimated: the motion would show a greater one"
                                    : "estimated with the attitude, and part of its row"));
}

BudgetRow undetected_row(const BudgetInput& input) {
    const FaultPrior& fault = input.fault.prior;
    std::string note =
        input.recorded ? input.recorded->undetected
        : !input.fault.shown.empty()
            ? fmt::format(
                  "up to {:.2f} m/s: {}; the positions are taken to err with a probability "
                  "of {:.2g} %, as mean square",
                  fault.largest_m_s, input.fault.shown, 100.0 * fault.probability)
        : input.reliability.empty()
            ? std::string(
                  "not quantified: the screened epochs do not state the largest "
                  "undetected error")
            : fmt::format(
                  "up to {:.2f} m/s: what would be left with a probability of {:.0f} % or "
                  "more, at most what such positions are off by; taken to happen in one "
                  "window of {:.0f} (parameter window.fault_probability), as mean square",
                  fault.largest_m_s, 100.0 * (1.0 - input.detection_power),
                  1.0 / fault.probability);
    return speed_row("d",
                     input.recorded ? "undetected error of single samples"
                                    : "error of the positions that screening left, drifts included",
                     "B", input.fault.standard_uncertainty_m_s(), RowScope::fault, std::move(note));
}

/// Row f: the remaining uncertainty of the bias. The bias itself is not a row; what remains of it
/// is added to the expanded uncertainty.
BudgetRow selection_row(const BudgetInput& input) {
    const SelectionBias& selection = input.selection;
    if (selection.samples == 0)
        return speed_row("f", "choice of the fastest of many windows", "A", 0.0, RowScope::window,
                         "not simulated: without it U exceeds the rule's limit already");
    const bool subtracted = selection.treatment == SelectionTreatment::subtracted;
    const bool middle =
        selection.bias_m_s > selection.fitted_bias_m_s || selection.bias_half_range_m_s == 0.0;
    const std::string between =
        fmt::format("{:.4f} m/s{} and {:.4f} m/s,{}", selection.fitted_bias_m_s,
                    input.recorded ? ", by white noise alone," : "", selection.bounded_bias_m_s,
                    input.recorded ? " by all errors that differ between windows;" : "");
    BudgetRow row = speed_row(
        "f", "choice of the fastest of many windows", "A", selection.bias_uncertainty_m_s,
        RowScope::window,
        fmt::format("bias between {} {} could have been the fastest; {}", between,
                    selection.candidates == 1 ? std::string("no other window")
                                              : fmt::format("{} windows", selection.candidates),
                    !subtracted ? "the larger is added to the expanded uncertainty"
                    : middle    ? "the middle is subtracted from the speed, half the difference "
                                  "added to the expanded uncertainty"
                                : "the smaller is subtracted from the speed, the difference "
                                  "added to the expanded uncertainty"));
    row.estimate = subtracted ? selection.bias_m_s : 0.0;
    row.sensitivity = subtracted ? -1.0 : 1.0;
    return row;
}

/// The rows of what the positions have in common with the ground and the craft.
void add_ground_rows(const BudgetInput& input, std::vector<BudgetRow>& rows) {
    rows.push_back(frame_row(input));
    if (auto height = height_row(input)) rows.push_back(*std::move(height));
    if (input.length) rows.push_back(length_row(*input.length, input.duration_s));
    if (input.craft)
        add_craft_rows(*input.craft, rows);
    else
        rows.push_back(antenna_row(input));
}

/// Row q: what the receiver's certificate of calibration states of a speed. Empty if it states
/// nothing. Witnesses do not reduce it: it is not known what of it they share.
std::optional<BudgetRow> calibration_row(const WindowConfig& config) {
    const auto& uncertainty_m_s = config.calibration_standard_uncertainty_m_s;
    if (!uncertainty_m_s) return std::nullopt;
    return speed_row("q", "calibration of the receiver", "B", *uncertainty_m_s,
                     RowScope::calibration,
                     "half the expanded uncertainty (k = 2) that its certificate states, as the "
                     "attempt has it; added to the other rows, of which it reduces none");
}

}  // namespace

void scale(BudgetRow& row, double factor) {
    row.sensitivity *= factor;
    row.contribution_m_s *= factor;
}

std::vector<BudgetRow> budget_of(const BudgetInput& input) {
    std::vector<BudgetRow> rows = input.recorded ? input.recorded->rows : position_rows(input);
    rows.push_back(time_row(input));
    if (input.recorded) rows.push_back(delay_row(*input.recorded));
    rows.push_back(clock_row(input));
    rows.push_back(resolution_row(input));
    if (!input.recorded) add_ground_rows(input, rows);
    if (auto calibration = calibration_row(input.config)) rows.push_back(*std::move(calibration));
    rows.push_back(undetected_row(input));
    rows.push_back(selection_row(input));
    return rows;
}

double own_uncertainty(const std::vector<BudgetRow>& rows) {
    return uncertainty_of(rows, {RowScope::source, RowScope::slow, RowScope::antenna});
}

double uncertainty_of(const std::vector<BudgetRow>& rows,
                      std::initializer_list<RowScope> touching) {
    double square = 0.0;
    for (const BudgetRow& row : rows)
        if (std::ranges::find(touching, row.touches) != touching.end())
            square += row.contribution_m_s * row.contribution_m_s;
    return std::sqrt(square);
}

CombinedUncertainty combine(const std::vector<BudgetRow>& rows) {
    std::vector<InputQuantity> inputs;
    double calibration_m_s = 0.0;
    for (const BudgetRow& row : rows)
        if (row.touches == RowScope::calibration)
            calibration_m_s = row.contribution_m_s;
        else
            inputs.push_back({.standard_uncertainty = row.standard_uncertainty,
                              .sensitivity = row.sensitivity,
                              .degrees_of_freedom = row.degrees_of_freedom});
    CombinedUncertainty combined = combine(std::span<const InputQuantity>(inputs));
    combined.standard_uncertainty = std::hypot(combined.standard_uncertainty, calibration_m_s);
    return combined;
}

}  // namespace runcert
