#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/gps_time.h"
#include "schemas/common/table.h"
#include "schemas/common/window_span.h"

namespace runcert {

/// Kind of a position solution.
enum class FixKind {
    unknown,  ///< the recording does not say
    none,
    single,
    dgps,
    sbas,
    ppp,
    float_ambiguities,
    fixed,
    dead_reckoning
};
std::string_view to_text(FixKind fix);
bool from_text(std::string_view text, FixKind& fix);

/// Stated accuracy of a position: standard deviations (m) and correlations of its errors towards
/// east, north, up. Empty is unknown.
struct StatedAccuracy {
    std::optional<double> sigma_east_m;
    std::optional<double> sigma_north_m;
    std::optional<double> sigma_up_m;
    std::optional<double> correlation_east_north;
    std::optional<double> correlation_east_up;
    std::optional<double> correlation_north_up;
};

/// The covariance (m^2) that a stated accuracy stands for; what is not stated counts as zero.
/// Axes: 1 (up alone), 2 (east, north) or 3 (all).
template <int Axes>
Eigen::Matrix<double, Axes, Axes> stated_covariance(const StatedAccuracy& accuracy);

/// Velocity as the receiver recorded it, towards east, north, up (m/s). Empty is unknown.
struct RecordedVelocity {
    std::optional<double> recorded_velocity_east_mps;
    std::optional<double> recorded_velocity_north_mps;
    std::optional<double> recorded_velocity_up_mps;
    std::optional<double> sigma_recorded_velocity_east_mps;
    std::optional<double> sigma_recorded_velocity_north_mps;
    std::optional<double> sigma_recorded_velocity_up_mps;
};

/// What the recording says about an epoch's quality, and where it says so.
struct EpochQuality {
    FixKind fix = FixKind::unknown;
    std::optional<std::int64_t> satellites;
    std::optional<double> age_s;
    std::optional<double> ratio;
    std::optional<std::int64_t> source_line;
    std::optional<std::int64_t> source_byte;
};

/// One epoch: either a WGS 84 position or a local-plane one, never both; neither where the
/// receiver had none.
struct Observation : StatedAccuracy, RecordedVelocity, EpochQuality {
    std::int64_t epoch = 0;
    ElapsedTime time;
    std::optional<double> latitude_deg;
    std::optional<double> longitude_deg;
    std::optional<double> height_m;
    std::optional<double> plane_east_m;
    std::optional<double> plane_north_m;
    std::optional<double> plane_up_m;
};

/// What holds for the whole of a recording, and is carried through every table made from it.
struct RecordingFacts {
    std::string receiver;
    std::optional<GpsTime> first_epoch;  ///< empty where the recording's time is relative
    bool georeferenced = true;
    bool vertical_measured = true;
    double nominal_interval_s = 0.0;  ///< median step between epochs
    /// Smallest step that the recording's horizontal coordinates can show, m; empty where unknown.
    std::optional<double> position_resolution_m = std::nullopt;
    /// Smallest step that its time stamps can show, s.
    std::optional<double> time_resolution_s = std::nullopt;
};

/// The members of a table's meta that hold RecordingFacts, and back.
nlohmann::ordered_json recording_facts_json(const RecordingFacts& facts);
RecordingFacts read_recording_facts(const YamlValue& meta);

/// The stretch between two epochs of a recording.
WindowSpan window_span(const RecordingFacts& facts, std::int64_t first_epoch,
                       std::int64_t last_epoch, ElapsedTime first, ElapsedTime last);

/// 1-observations.ecsv, `schemas/observations/v1.yaml`.
struct Observations {
    Header header;
    RecordingFacts facts;
    std::string format;           ///< "rtklib-pos", "csv"
    std::string frame;            ///< "geodetic", "ecef", "utm", "local_plane"
    std::string time_scale;       ///< "gps", "utc", "relative"
    std::string accuracy_source;  ///< "recording", "attempt", "none"
    std::vector<std::string> notes;
    std::vector<Observation> rows;
};

std::string write_observations(const Observations& observations);
/// `where` names the file in messages. Failure on any deviation from the schema.
Observations read_observations(std::string_view text, const std::string& where);

/// Column bindings that several tables share; Row derives from the struct they fill.
template <class Row>
void bind_accuracy(std::vector<ColumnBinding<Row>>& columns) {
    columns.push_back(column<Row, &Row::sigma_east_m>("sigma_east"));
    columns.push_back(column<Row, &Row::sigma_north_m>("sigma_north"));
    columns.push_back(column<Row, &Row::sigma_up_m>("sigma_up"));
    columns.push_back(column<Row, &Row::correlation_east_north>("correlation_east_north"));
    columns.push_back(column<Row, &Row::correlation_east_up>("correlation_east_up"));
    columns.push_back(column<Row, &Row::correlation_north_up>("correlation_north_up"));
}
template <class Row>
void bind_recorded_velocity(std::vector<ColumnBinding<Row>>& columns) {
    columns.push_back(column<Row, &Row::recorded_velocity_east_mps>("recorded_velocity_east"));
    columns.push_back(column<Row, &Row::recorded_velocity_north_mps>("recorded_velocity_north"));
    columns.push_back(column<Row, &Row::recorded_velocity_up_mps>("recorded_velocity_up"));
    columns.push_back(
        column<Row, &Row::sigma_recorded_velocity_east_mps>("sigma_recorded_velocity_east"));
    columns.push_back(
        column<Row, &Row::sigma_recorded_velocity_north_mps>("sigma_recorded_velocity_north"));
    columns.push_back(
        column<Row, &Row::sigma_recorded_velocity_up_mps>("sigma_recorded_velocity_up"));
}
template <class Row>
void bind_quality(std::vector<ColumnBinding<Row>>& columns) {
    columns.push_back(column<Row, &Row::fix>("fix"));
    columns.push_back(column<Row, &Row::satellites>("satellites"));
    columns.push_back(column<Row, &Row::age_s>("age"));
    columns.push_back(column<Row, &Row::ratio>("ratio"));
    columns.push_back(column<Row, &Row::source_line>("source_line"));
    columns.push_back(column<Row, &Row::source_byte>("source_byte"));
}

}  // namespace runcert
