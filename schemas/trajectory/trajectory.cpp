#include "schemas/trajectory/trajectory.h"

#include "schemas/common/members.h"

namespace runcert {

YamlNode trajectory_field_table_node();

// The members of the estimation's maps, as `schemas/trajectory/v1.yaml` names them.

template <>
inline constexpr auto members<NoiseParameter> =
    std::tuple{Member{"value", &NoiseParameter::value},
               Member{"relative_uncertainty", &NoiseParameter::relative_uncertainty},
               Member{"at_bound", &NoiseParameter::at_bound}};

template <>
inline constexpr auto members<NoiseModelShare> =
    std::tuple{Member{"weight", &NoiseModelShare::weight},
               Member{"jerk_density", &NoiseModelShare::jerk_density},
               Member{"acceleration_time_s", &NoiseModelShare::acceleration_time_s},
               Member{"measurement_scale", &NoiseModelShare::measurement_scale},
               Member{"error_sigma_m", &NoiseModelShare::error_sigma_m},
               Member{"error_tau_s", &NoiseModelShare::error_tau_s}};

template <>
inline constexpr auto members<NoiseSummary> =
    std::tuple{Member{"status", &NoiseSummary::status},
               Member{"epochs", &NoiseSummary::epochs},
               Member{"epochs_needed", &NoiseSummary::epochs_needed},
               Member{"stated_sigma_m", &NoiseSummary::stated_sigma_m},
               Member{"stated_all_equal", &NoiseSummary::stated_all_equal},
               Member{"tau_min_s", &NoiseSummary::tau_min_s},
               Member{"tau_max_s", &NoiseSummary::tau_max_s},
               Member{"jerk_density", &NoiseSummary::jerk_density},
               Member{"measurement_scale", &NoiseSummary::measurement_scale},
               Member{"acceleration_time_s", &NoiseSummary::acceleration_time_s},
               Member{"singer_gain", &NoiseSummary::singer_gain},
               Member{"error_told", &NoiseSummary::error_told},
               Member{"error_gain", &NoiseSummary::error_gain},
               Member{"error_diffusion", &NoiseSummary::error_diffusion},
               Member{"error_tau_s", &NoiseSummary::error_tau_s},
               Member{"error_sigma_m", &NoiseSummary::error_sigma_m},
               Member{"white_scale", &NoiseSummary::white_scale},
               Member{"evaluations", &NoiseSummary::evaluations},
               Member{"converged", &NoiseSummary::converged},
               Member{"posterior", &NoiseSummary::posterior}};

template <>
inline constexpr auto members<FilterHealth> =
    std::tuple{Member{"innovations", &FilterHealth::innovations},
               Member{"mean_statistic", &FilterHealth::mean_statistic},
               Member{"lower", &FilterHealth::lower},
               Member{"upper", &FilterHealth::upper},
               Member{"spans", &FilterHealth::spans},
               Member{"spans_outside", &FilterHealth::spans_outside},
               Member{"spans_allowed", &FilterHealth::spans_allowed},
               Member{"consistent", &FilterHealth::consistent},
               Member{"autocorrelation_stated", &FilterHealth::autocorrelation_stated},
               Member{"autocorrelation", &FilterHealth::autocorrelation},
               Member{"white", &FilterHealth::white},
               Member{"largest_condition", &FilterHealth::largest_condition},
               Member{"largest_asymmetry", &FilterHealth::largest_asymmetry},
               Member{"repaired", &FilterHealth::repaired}};

template <>
inline constexpr auto members<AxesEstimation> =
    std::tuple{Member{"noise", &AxesEstimation::noise}, Member{"health", &AxesEstimation::health}};

template <>
inline constexpr auto members<EstimationSummary> = std::tuple{
    Member{"arcs", &EstimationSummary::arcs},
    Member{"degrees_of_freedom", &EstimationSummary::degrees_of_freedom},
    Member{"variance_factor", &EstimationSummary::variance_factor},
    Member{"variance_factor_applied", &EstimationSummary::variance_factor_applied},
    Member{"largest_position_difference_m", &EstimationSummary::largest_position_difference_m},
    Member{"largest_velocity_difference_mps", &EstimationSummary::largest_velocity_difference_mps},
    Member{"batch_stretches", &EstimationSummary::batch_stretches},
    Member{"robust_downweighted", &EstimationSummary::robust_downweighted},
    Member{"robust_unsolved", &EstimationSummary::robust_unsolved},
    Member{"horizontal", &EstimationSummary::horizontal},
    Member{"vertical", &EstimationSummary::vertical}};

namespace {

const TableFormat<TrajectoryEpoch>& format() {
    using Row = TrajectoryEpoch;
    static const TableFormat<Row> instance(
        trajectory_field_table_node(), "schemas/trajectory/v1.yaml",
        {
            column<Row, &Row::epoch>("epoch"),
            column<Row, &Row::time>("time"),
            column<Row, &Row::east_m>("east"),
            column<Row, &Row::north_m>("north"),
            column<Row, &Row::up_m>("up"),
            column<Row, &Row::velocity_east_mps>("velocity_east"),
            column<Row, &Row::velocity_north_mps>("velocity_north"),
            column<Row, &Row::velocity_up_mps>("velocity_up"),
            column<Row, &Row::acceleration_east_mps2>("acceleration_east"),
            column<Row, &Row::acceleration_north_mps2>("acceleration_north"),
            column<Row, &Row::acceleration_up_mps2>("acceleration_up"),
            column<Row, &Row::speed_mps>("speed"),
            column<Row, &Row::sigma_east_m>("sigma_east"),
            column<Row, &Row::sigma_north_m>("sigma_north"),
            column<Row, &Row::sigma_up_m>("sigma_up"),
            column<Row, &Row::sigma_velocity_east_mps>("sigma_velocity_east"),
            column<Row, &Row::sigma_velocity_north_mps>("sigma_velocity_north"),
            column<Row, &Row::sigma_velocity_up_mps>("sigma_velocity_up"),
            column<Row, &Row::sigma_acceleration_east_mps2>("sigma_acceleration_east"),
            column<Row, &Row::sigma_acceleration_north_mps2>("sigma_acceleration_north"),
            column<Row, &Row::sigma_acceleration_up_mps2>("sigma_acceleration_up"),
            column<Row, &Row::sigma_speed_mps>("sigma_speed"),
            column<Row, &Row::speed_batch_mps>("speed_batch"),
            column<Row, &Row::speed_v1_mps>("speed_v1"),
            column<Row, &Row::speed_v2_mps>("speed_v2"),
            column<Row, &Row::speed_kalman_mps>("speed_kalman"),
            column<Row, &Row::robust_east_m>("robust_east"),
            column<Row, &Row::robust_north_m>("robust_north"),
            column<Row, &Row::robust_weight>("robust_weight"),
            column<Row, &Row::jerk_density>("jerk_density"),
            column<Row, &Row::jerk_density_up>("jerk_density_up"),
            column<Row, &Row::arc>("arc"),
            column<Row, &Row::usable>("usable"),
            column<Row, &Row::step_before>("step_before"),
        });
    return instance;
}

}  // namespace

std::string write_trajectory(const TrajectoryTable& table) {
    nlohmann::ordered_json meta = frame_meta_json(table.header, table.facts, table.origin);
    meta["estimation"] = members_json(table.estimation);
    return format().write(std::move(meta), table.rows);
}

namespace {

TrajectoryTable head_of(const YamlValue& meta) {
    return {.header = read_header(meta),
            .facts = read_recording_facts(meta),
            .origin = read_origin(meta),
            .estimation = read_members<EstimationSummary>(meta["estimation"]),
            .rows = {}};
}

}  // namespace

TrajectoryTable read_trajectory(std::string_view text, const std::string& where) {
    auto contents = format().read(text, where);
    TrajectoryTable table = head_of(contents.meta);
    table.rows = std::move(contents.rows);
    return table;
}

OpenTable<TrajectoryTable> open_trajectory(std::string_view text, const std::string& where) {
    RowReader<TrajectoryEpoch> rows(format(), text, where);
    return {head_of(rows.meta()), std::move(rows)};
}

}  // namespace runcert
