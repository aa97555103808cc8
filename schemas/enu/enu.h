#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geodesy.h"
#include "schemas/observations/observations.h"

namespace runcert {

/// One epoch in the local frame; accuracy and velocity are towards the frame's axes.
struct EnuEpoch : StatedAccuracy, RecordedVelocity, EpochQuality {
    std::int64_t epoch = 0;
    ElapsedTime time;
    std::optional<double> east_m;
    std::optional<double> north_m;
    std::optional<double> up_m;
};

/// The position (m) of an epoch that has one. Axes: 1 (up alone), 2 (east, north) or 3 (all).
template <int Axes>
Eigen::Matrix<double, Axes, 1> measured_position(const EnuEpoch& row) {
    if constexpr (Axes == 1)
        return Eigen::Matrix<double, 1, 1>(row.up_m.value());
    else if constexpr (Axes == 2)
        return {row.east_m.value(), row.north_m.value()};
    else
        return {row.east_m.value(), row.north_m.value(), row.up_m.value()};
}

/// Where the local frame stands on the Earth.
struct FrameOrigin {
    Geodetic position;
    std::string source;  ///< "attempt" or "first_epoch"
};

/// 2-enu.ecsv, `schemas/enu/v1.yaml`.
struct EnuTable {
    Header header;
    RecordingFacts facts;
    std::optional<FrameOrigin> origin;  ///< empty where not georeferenced
    std::vector<EnuEpoch> rows;
};

std::string write_enu(const EnuTable& table);
EnuTable read_enu(std::string_view text, const std::string& where);

/// The same row by row, in memory that does not grow with the table: `head` holds all but the rows.
class EnuWriter {
  public:
    EnuWriter(const EnuTable& head, EcsvWriter::Sink sink);
    void write(const EnuEpoch& row);
    /// Gives the sink what it has not yet.
    void finish();

  private:
    EcsvWriter out_;
};
/// `text` must outlive what is returned.
OpenTable<EnuTable> open_enu(std::string_view text, const std::string& where);

/// The meta that every table in the local frame begins with, and back.
nlohmann::ordered_json frame_meta_json(const Header& header, const RecordingFacts& facts,
                                       const std::optional<FrameOrigin>& origin);
std::optional<FrameOrigin> read_origin(const YamlValue& meta);

/// Column bindings of EnuEpoch; Row derives from it.
template <class Row>
std::vector<ColumnBinding<Row>> enu_columns() {
    std::vector<ColumnBinding<Row>> columns{
        column<Row, &Row::epoch>("epoch"), column<Row, &Row::time>("time"),
        column<Row, &Row::east_m>("east"), column<Row, &Row::north_m>("north"),
        column<Row, &Row::up_m>("up")};
    bind_accuracy(columns);
    bind_recorded_velocity(columns);
    bind_quality(columns);
    return columns;
}

}  // namespace runcert
