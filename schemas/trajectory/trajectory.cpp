#include "schemas/trajectory/trajectory.h"

namespace runcert {

std::string_view trajectory_schema_text(std::string_view name);

namespace {

const TableFormat<TrajectoryEpoch>& format() {
    using Row = TrajectoryEpoch;
    static const TableFormat<Row> instance(
        trajectory_schema_text("v1.yaml"), "schemas/trajectory/v1.yaml",
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
            column<Row, &Row::arc>("arc"),
            column<Row, &Row::usable>("usable"),
        });
    return instance;
}

}  // namespace

std::string write_trajectory(const TrajectoryTable& table) {
    nlohmann::ordered_json meta = frame_meta_json(table.header, table.facts, table.origin);
    const EstimationSummary& summary = table.estimation;
    meta["estimation"] = {
        {"arcs", summary.arcs},
        {"degrees_of_freedom", summary.degrees_of_freedom},
        {"variance_factor", rounded(summary.variance_factor, 4)},
        {"variance_factor_applied", rounded(summary.variance_factor_applied, 4)},
        {"largest_position_difference_m", rounded(summary.largest_position_difference_m, 12)},
        {"largest_velocity_difference_mps", rounded(summary.largest_velocity_difference_mps, 12)}};
    return format().write(std::move(meta), table.rows);
}

TrajectoryTable read_trajectory(std::string_view text, const std::string& where) {
    auto contents = format().read(text, where);
    const YamlValue summary = contents.meta["estimation"];
    return {.header = read_header(contents.meta),
            .facts = read_recording_facts(contents.meta),
            .origin = read_origin(contents.meta),
            .estimation = {.arcs = summary["arcs"].integer(),
                           .degrees_of_freedom = summary["degrees_of_freedom"].integer(),
                           .variance_factor = summary["variance_factor"].real(),
                           .variance_factor_applied = summary["variance_factor_applied"].real(),
                           .largest_position_difference_m =
                               summary["largest_position_difference_m"].real(),
                           .largest_velocity_difference_mps =
                               summary["largest_velocity_difference_mps"].real()},
            .rows = std::move(contents.rows)};
}

}  // namespace runcert
