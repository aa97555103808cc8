#include <cmath>

#include "stages/import/cell.h"
#include "stages/import/earth.h"
#include "stages/import/rtklib_pos/header.h"

namespace runcert::rtklib_pos {
namespace {

/// The fields of one row, by column.
class Fields : public RowCells<Column> {
  public:
    using RowCells::RowCells;

    /// Three numbers, from columns that follow each other in the list of columns.
    Eigen::Vector3d reals(Column first, std::string_view meaning) const {
        return {real(first, meaning), real(after(first, 1), meaning),
                real(after(first, 2), meaning)};
    }
    Eigen::Vector3d deviations(Column first, std::string_view meaning) const {
        return {read_deviation(cell(first), meaning),
                read_deviation(cell(after(first, 1)), meaning),
                read_deviation(cell(after(first, 2)), meaning)};
    }
    /// Three standard deviations and the three signed roots behind them.
    Eigen::Matrix3d covariance(Column first, std::string_view meaning) const {
        const Eigen::Vector3d roots = reals(after(first, 3), meaning);
        for (const int i : {0, 1, 2})
            if (std::abs(roots(i)) > 1e9)
                cell(after(first, 3 + static_cast<std::size_t>(i)))
                    .fail("the root of a covariance is above 1e9",
                          "Hand in the solution as the program wrote it, or solve it again");
        return covariance_from_rtklib(deviations(first, meaning), roots);
    }

  private:
    static Column after(Column column, std::size_t steps) {
        return static_cast<Column>(static_cast<std::size_t>(column) + steps);
    }
};

GpsTime read_instant(std::span<const Cell> fields, Clock clock) {
    if (fields[0].text.find('/') != std::string_view::npos)
        return read_calendar(fields[0], fields[1], clock);
    return read_week_time(fields[0], fields[1], clock);
}

Geodetic read_angles(const Fields& fields, bool dms) {
    const auto angle = [&](Column column, std::string_view meaning) {
        return dms ? read_dms(fields.cell(column), fields.cell(column, 1), fields.cell(column, 2),
                              meaning)
                   : Angle::from_degrees(fields.real(column, meaning));
    };
    const Geodetic position{.latitude = angle(Column::latitude, "latitude"),
                            .longitude = angle(Column::longitude, "longitude"),
                            .height_m = fields.real(Column::height, "height")};
    return checked_geodetic(position, fields.cell(Column::latitude), fields.cell(Column::longitude),
                            fields.cell(Column::height));
}

Geodetic read_baseline(const Fields& fields, const LocalFrame& base) {
    const Eigen::Vector3d enu_m = fields.reals(Column::east, "baseline");
    const Geodetic position = base.geodetic_from_enu(Enu{enu_m});
    return checked_ecef(ecef_from_geodetic(position).m, fields.cell(Column::east));
}

Geodetic read_position(const Fields& fields, const Layout& layout,
                       const std::optional<LocalFrame>& base) {
    if (layout.coordinates == Coordinates::baseline) return read_baseline(fields, *base);
    if (layout.coordinates == Coordinates::earth_centred)
        return checked_ecef(fields.reals(Column::x, "coordinate"), fields.cell(Column::x));
    return read_angles(fields, layout.coordinates == Coordinates::degrees_minutes_seconds);
}

void set_written_coordinates(WrittenCells& written, const Fields& fields, Coordinates coordinates) {
    const auto text = [&](Column column, std::size_t part = 0) {
        return fields.cell(column, part).text;
    };
    switch (coordinates) {
        case Coordinates::degrees:
            written.unit = CoordinateUnit::degree;
            written.coordinates = {text(Column::latitude), text(Column::longitude)};
            break;
        case Coordinates::degrees_minutes_seconds:
            written.unit = CoordinateUnit::arc_second;
            written.coordinates = {text(Column::latitude, 2), text(Column::longitude, 2)};
            break;
        case Coordinates::earth_centred:
            written.coordinates = {text(Column::x), text(Column::y), text(Column::z)};
            break;
        case Coordinates::baseline:
            written.coordinates = {text(Column::east), text(Column::north)};
            break;
    }
}

/// A covariance in the axes of `rotation`'s domain, turned by it; zero, for unknown, where one of
/// the axes has no standard deviation, because then none of the turned ones is known.
Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, const Eigen::Matrix3d& rotation) {
    if (covariance.diagonal().minCoeff() <= 0.0) return Eigen::Matrix3d::Zero();
    return rotation * covariance * rotation.transpose();
}

/// Turns the axes that the row's values towards east, north, up belong to into those of the
/// place: the base's, for a baseline.
Eigen::Matrix3d rotation_from_stated(const Geodetic& place, const std::optional<LocalFrame>& base) {
    if (!base) return Eigen::Matrix3d::Identity();
    return base->rotation_from_local(place.latitude, place.longitude).transpose();
}

/// The covariance of the columns from `enu` on, or else of those from `ecef` on, towards east,
/// north, up of the place; zero where neither is there.
Eigen::Matrix3d read_covariance(const Fields& fields, Column enu, Column ecef,
                                const Geodetic& place, const std::optional<LocalFrame>& base) {
    constexpr std::string_view meaning = "standard deviation";
    if (fields.has(ecef))
        return turned(fields.covariance(ecef, meaning),
                      rotation_enu_from_ecef(place.latitude, place.longitude));
    if (!fields.has(enu)) return Eigen::Matrix3d::Zero();
    const Eigen::Matrix3d covariance = fields.covariance(enu, meaning);
    return base ? turned(covariance, rotation_from_stated(place, base)) : covariance;
}

void read_velocity(const Fields& fields, const Geodetic& place,
                   const std::optional<LocalFrame>& base, RecordedVelocity& velocity) {
    Eigen::Vector3d enu_m_s;
    if (fields.has(Column::velocity_xyz))
        enu_m_s = rotation_enu_from_ecef(place.latitude, place.longitude) *
                  fields.reals(Column::velocity_xyz, "velocity");
    else if (fields.has(Column::velocity_enu))
        enu_m_s =
            rotation_from_stated(place, base) * fields.reals(Column::velocity_enu, "velocity");
    else
        return;
    velocity.recorded_velocity_east_m_s = enu_m_s(0);
    velocity.recorded_velocity_north_m_s = enu_m_s(1);
    velocity.recorded_velocity_up_m_s = enu_m_s(2);
    const StatedAccuracy accuracy = accuracy_from_covariance(read_covariance(
        fields, Column::velocity_covariance_enu, Column::velocity_covariance_xyz, place, base));
    velocity.sigma_recorded_velocity_east_m_s = accuracy.sigma_east_m;
    velocity.sigma_recorded_velocity_north_m_s = accuracy.sigma_north_m;
    velocity.sigma_recorded_velocity_up_m_s = accuracy.sigma_up_m;
}

void read_quality(const Fields& fields, EpochQuality& quality) {
    quality.fix = read_rtklib_quality(fields.cell(Column::quality));
    if (fields.has(Column::satellites))
        quality.satellites = read_satellites(fields.cell(Column::satellites));
    if (fields.has(Column::age)) quality.age_s = fields.real(Column::age, "age");
    if (fields.has(Column::ratio)) quality.ratio = fields.real(Column::ratio, "ratio");
}

/// RTKLIB has no position where Q is 0, and other programs then write zeros.
bool has_position(const Fields& fields, const Layout& layout, FixType fix) {
    if (fix != FixType::none) return true;
    for (const Column first : {Column::latitude, Column::x, Column::east}) {
        if (!fields.has(first)) continue;
        const bool dms = layout.coordinates == Coordinates::degrees_minutes_seconds;
        if (dms) return fields.real(first, "position") != 0.0;
        return !fields.reals(first, "position").isZero(0.0);
    }
    return true;
}

}  // namespace

TimedRow read_row(std::span<const Cell> cells, const Layout& layout,
                  const std::optional<LocalFrame>& base) {
    const Fields fields(cells, layout);
    TimedRow row;
    row.instant = read_instant(cells, layout.clock);
    row.written.time = cells[1].text;
    read_quality(fields, row.observation);
    if (!has_position(fields, layout, row.observation.fix)) return row;
    const Geodetic place = read_position(fields, layout, base);
    set_position(row.observation, place);
    set_written_coordinates(row.written, fields, layout.coordinates);
    static_cast<StatedAccuracy&>(row.observation) = accuracy_from_covariance(
        read_covariance(fields, Column::covariance_enu, Column::covariance_xyz, place, base));
    read_velocity(fields, place, base, row.observation);
    return row;
}

}  // namespace runcert::rtklib_pos
