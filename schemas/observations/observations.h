#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/gps_time.h"
#include "core/optional_number.h"
#include "schemas/common/table.h"
#include "schemas/common/window_span.h"

namespace runcert {

/// Kind of a position solution.
enum class FixKind : std::uint8_t {
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
    OptionalReal sigma_east_m;
    OptionalReal sigma_north_m;
    OptionalReal sigma_up_m;
    OptionalReal correlation_east_north;
    OptionalReal correlation_east_up;
    OptionalReal correlation_north_up;
};

/// The covariance (m^2) that a stated accuracy stands for; what is not stated counts as zero.
/// Axes: 1 (up alone), 2 (east, north) or 3 (all).
template <int Axes>
Eigen::Matrix<double, Axes, Axes> stated_covariance(const StatedAccuracy& accuracy);

/// Velocity as the receiver recorded it, towards east, north, up (m/s). Empty is unknown.
struct RecordedVelocity {
    OptionalReal recorded_velocity_east_mps;
    OptionalReal recorded_velocity_north_mps;
    OptionalReal recorded_velocity_up_mps;
    OptionalReal sigma_recorded_velocity_east_mps;
    OptionalReal sigma_recorded_velocity_north_mps;
    OptionalReal sigma_recorded_velocity_up_mps;
};

/// What the recording says about an epoch's quality, and where it says so. The order keeps it
/// small: a recording may have millions of epochs.
struct EpochQuality {
    FixKind fix = FixKind::unknown;
    OptionalNumber<std::int8_t> source_file;  ///< of a recording in several: counted from 1
    OptionalNumber<std::int16_t> satellites;
    OptionalCount source_line;
    OptionalReal age_s;
    OptionalReal ratio;
    OptionalInteger source_byte;
};

/// One epoch: either a WGS 84 position or a local-plane one, never both; neither where the
/// receiver had none.
struct Observation : StatedAccuracy, RecordedVelocity, EpochQuality {
    std::int64_t epoch = 0;
    ElapsedTime time;
    OptionalReal latitude_deg;
    OptionalReal longitude_deg;
    OptionalReal height_m;
    OptionalReal plane_east_m;
    OptionalReal plane_north_m;
    OptionalReal plane_up_m;
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
    /// Whose clock made the time stamps: "satellites", which the format says; "attempt", which says
    /// that they are the satellites'; "unknown".
    std::string time_source = "unknown";
};

/// The members of a table's meta that hold RecordingFacts, and back.
nlohmann::ordered_json recording_facts_json(const RecordingFacts& facts);
RecordingFacts read_recording_facts(const YamlValue& meta);

/// The stretch between two epochs of a recording.
WindowSpan window_span(const RecordingFacts& facts, std::int64_t first_epoch,
                       std::int64_t last_epoch, ElapsedTime first, ElapsedTime last);

/// A record (a line, sentence, frame, track point) of a recording that could not be read.
struct BadRecord {
    OptionalInteger line;                   ///< counted from 1; empty in binary formats
    OptionalInteger column = std::nullopt;  ///< byte in the line, from 1, where one is to blame
    std::int64_t byte = 0;                  ///< offset of its first byte, counted from 0
    OptionalCount file =
        std::nullopt;  ///< of a recording in several files: which one, counted from 1
    /// Number of the epoch that it is part of, or else of the last epoch before it; 0 before the
    /// first.
    std::int64_t epoch = 0;
    std::string what;  ///< what was found there, what was expected, and what to do
};

/// How much of a recording could be read.
struct RecordCount {
    std::int64_t total = 0;  ///< good and bad
    std::int64_t bad = 0;
    std::vector<BadRecord> bad_records;  ///< the first `listed_at_most` of them

    static constexpr std::size_t listed_at_most = 1000;
};

/// 1-observations.ecsv, `schemas/observations/v1.yaml`.
struct Observations {
    Header header;
    RecordingFacts facts;
    std::string format;            ///< "rtklib-pos", "nmea", ...: a word of the attempt's `format`
    std::string variant = {};      ///< of the format, in words ("GPX 1.1"); empty where it has one
    std::string device = {};       ///< what the recording says made it; empty where unknown
    std::string frame;             ///< "geodetic", "ecef", "utm", "local_plane"
    std::string time_scale;        ///< "gps", "utc", "relative"
    std::string accuracy_source;   ///< "recording", "attempt", "none"
    std::string time_origin = {};  ///< what the time stamps are, in words
    /// Who says the kind of solution: "recording"; "attempt", where the recording does not;
    /// "partly" the recording; "unknown": nobody.
    std::string solution_source = "unknown";
    RecordCount records = {};
    std::vector<std::string> notes;
    std::vector<Observation> rows;
};

std::string write_observations(const Observations& observations);
/// `where` names the file in messages. Failure on any deviation from the schema.
Observations read_observations(std::string_view text, const std::string& where);

/// The same row by row, in memory that does not grow with the table: `head` holds all but the rows.
class ObservationsWriter {
  public:
    ObservationsWriter(const Observations& head, EcsvWriter::Sink sink);
    void write(const Observation& row);
    /// Gives the sink what it has not yet.
    void finish();

  private:
    EcsvWriter out_;
};
/// `text` must outlive what is returned.
OpenTable<Observations> open_observations(std::string_view text, const std::string& where);

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
    columns.push_back(column<Row, &Row::source_file>("source_file"));
}

}  // namespace runcert
