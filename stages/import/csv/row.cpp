#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/clock.h"
#include "stages/import/csv/csv.h"
#include "stages/import/earth.h"

namespace runcert::csv {
namespace {

/// The fields of one row, by column.
class Fields : public RowCells<Column> {
  public:
    Fields(std::span<const Cell> cells, const Layout& layout)
        : RowCells(cells, layout), layout_(layout) {}

    /// Whether the column is there and its field holds a value. What a program writes for a
    /// coordinate that it does not have ("nan") is no coordinate all the same, and fails.
    bool has(Column column) const {
        const std::string_view field = text(column);
        if (!is_missing(field)) return true;
        return (column_kinds[index(column)].keeps_unit || column == Column::height) &&
               (field.ends_with('n') || field.ends_with('N'));
    }
    double real(Column column) const {
        Cell number = cell(column);
        double factor = layout_.factor[index(column)];
        if (const auto unit = take_unit(number.text, *column_kinds[index(column)].quantity)) {
            if (factor != 1.0 && factor != unit->factor)
                cell(column).fail(
                    fmt::format("the {} \"{}\" is in another unit than its column", name_of(column),
                                escape_for_message(cell(column).text)),
                    "Hand in the table as the logger wrote it, or another export");
            factor = unit->factor;
        }
        return read_real(number, name_of(column)) * factor;
    }
    std::optional<double> optional_real(Column column) const {
        if (!has(column)) return std::nullopt;
        return real(column);
    }
    /// Latitude or longitude, each a half of its cell where one column holds both.
    WrittenAngle coordinate(Column column) const {
        const bool north = column == Column::latitude;
        const Cell& whole = cell(column);
        const Column hemisphere = north ? Column::north_south : Column::east_west;
        return WrittenAngle(layout_.both_in_one ? halves_of(whole)[north ? 0 : 1] : whole, north,
                            layout_.angles,
                            RowCells::has(hemisphere) ? &cell(hemisphere) : nullptr);
    }
    /// Empty, zero, and what is too large are unknown.
    std::optional<double> deviation(Column column) const {
        if (!has(column)) return std::nullopt;
        Cell number = cell(column);
        const auto unit = take_unit(number.text, *column_kinds[index(column)].quantity);
        const double value = read_deviation(number, name_of(column));
        if (value <= 0.0 || value >= layout_.unknown_from) return std::nullopt;
        return value * (unit ? unit->factor : layout_.factor[index(column)]);
    }

  private:
    static std::size_t index(Column column) { return static_cast<std::size_t>(column); }

    const Layout& layout_;
};

/// A count of satellites, which is interpolated too where rows are.
std::int16_t read_count(const Cell& cell, bool between_fixes) {
    Cell whole = cell;
    // "12(17)": used of those in view.
    whole.text = cell.text.substr(0, cell.text.find('('));
    if (between_fixes) whole.text = whole.text.substr(0, whole.text.find('.'));
    return read_satellites(whole);
}

GpsTime read_seconds(const Cell& cell, const Receiver& receiver, int shift) {
    if (unix_shift(cell.text).value_or(0) > 0)
        cell.fail(fmt::format("the time \"{}\" counts milliseconds or less since 1970",
                              escape_for_message(cell.text)),
                  "Write time_format: unix in the receiver");
    const std::int64_t nanoseconds = read_nanoseconds(cell, "time", shift);
    try {
        return receiver.start_gps.value_or(GpsTime()).plus_nanoseconds(nanoseconds);
    } catch (const Failure& failure) {
        cell.fail(failure.problem(), failure.remedy());
    }
}

/// Failure for a time that shows itself to be of another format than the attempt says.
void require_described(const Cell& time, TimeFormat described) {
    const bool begins_as_iso = time.text.size() > 10 && time.text[4] == '-' && time.text[7] == '-';
    if (described == TimeFormat::iso && begins_as_iso) return;
    const std::string_view date = split_date_time(time)[0].text;
    const bool has_date =
        (date.find_first_of("/-.") != std::string_view::npos || date.size() == time.text.size()) &&
        std::ranges::any_of(date, [](char c) { return !is_digit(c); }) && is_date(date);
    const bool has_colon = time.text.find(':') != std::string_view::npos;
    if (has_date && described != TimeFormat::iso)
        time.fail(fmt::format("\"{}\" is a date and time, and the attempt describes another format",
                              escape_for_message(time.text)),
                  "Write time_format: iso in the receiver");
    if (!has_date && has_colon && described != TimeFormat::time_of_day)
        time.fail(
            fmt::format("\"{}\" is a time of day, and the attempt describes another format",
                        escape_for_message(time.text)),
            "Write time_format: time_of_day in the receiver, and name the column of the date");
}

GpsTime read_whole_instant(const Fields& fields, const Description& description,
                           const Receiver& receiver) {
    const Clock clock = description.clock;
    const Cell& time = fields.cell(Column::time);
    if (time.text.empty())
        time.fail("the time is missing",
                  "Hand in the table as the logger wrote it, or another export");
    require_described(time, description.time_format);
    switch (description.time_format) {
        case TimeFormat::seconds:
            return read_seconds(time, receiver, description.time_shift);
        case TimeFormat::seconds_of_week:
            return read_week_time(fields.cell(Column::week), time, clock);
        case TimeFormat::unix:
            return read_unix(time, description.time_shift);
        case TimeFormat::iso:
            if (description.days) return read_days(time, *description.days, clock);
            if (description.date_order) {
                const auto [date, time_of_day] = split_date_time(time);
                return read_date_time(date, time_of_day, *description.date_order, clock);
            }
            return read_iso(time, clock);
        case TimeFormat::time_of_day:
            break;
    }
    Cell date = time;
    date.text = description.start_date;
    if (description.start_date.empty()) date = fields.cell(Column::date);
    if (description.date_order) return read_date_time(date, time, *description.date_order, clock);
    return read_calendar(date, time, clock);
}

GpsTime read_instant(const Fields& fields, const Description& description,
                     const Receiver& receiver) {
    const GpsTime instant = read_whole_instant(fields, description, receiver);
    if (!fields.has(Column::milliseconds)) return instant;
    return instant.plus_nanoseconds(
        read_whole(fields.cell(Column::milliseconds), "count of milliseconds", 0, 999) * 1'000'000);
}

Geodetic read_utm(const Fields& fields, const Receiver& receiver, double height_m) {
    const double easting_m = fields.real(Column::east);
    const double northing_m = fields.real(Column::north);
    try {
        return geodetic_from_utm(*receiver.frame->utm_zone, easting_m, northing_m, height_m);
    } catch (const Failure& failure) {
        fields.cell(Column::east).fail(failure.problem(), failure.remedy());
    }
}

/// A position in geodetic or Earth-centred coordinates. All the coordinates that are recorded are
/// there.
Geodetic read_place(const Fields& fields, const Description& description, const Receiver& receiver,
                    WrittenCells& written) {
    if (description.frame == CoordinateFrame::ecef)
        return checked_ecef(
            {fields.real(Column::x), fields.real(Column::y), fields.real(Column::z)},
            fields.cell(Column::x));
    const bool utm = description.frame == CoordinateFrame::utm;
    const Column height = utm ? Column::up : Column::height;
    const bool has_height = description.has_up && fields.has(height);
    const double height_m =
        has_height ? fields.real(height) : description.constant_height_m.value_or(0.0);
    const Cell& first = fields.cell(utm ? Column::east : Column::latitude);
    Geodetic position;
    if (utm) {
        position = read_utm(fields, receiver, height_m);
    } else {
        const WrittenAngle latitude = fields.coordinate(Column::latitude);
        const WrittenAngle longitude = fields.coordinate(Column::longitude);
        position = {.latitude = Angle::from_degrees(latitude.degrees()),
                    .longitude = Angle::from_degrees(longitude.degrees()),
                    .height_m = height_m};
        written.unit = latitude.unit();
        written.coordinates = {latitude.last_number(), longitude.last_number()};
    }
    return checked_geodetic(position, first, fields.cell(utm ? Column::north : Column::longitude),
                            has_height ? fields.cell(height) : first);
}

bool has_position(const Fields& fields, const Description& description) {
    const std::span<const Column> columns = position_columns(description.frame);
    return fields.has(columns[0]) && fields.has(columns[1]) &&
           (description.frame != CoordinateFrame::ecef || fields.has(columns[2]));
}

/// Deviations along the axes of a UTM grid, in its metres, as those towards true east and north
/// on the ground. Grid north has the bearing of the convergence.
StatedAccuracy accuracy_from_grid(const StatedAccuracy& grid, const UtmGeometry& geometry) {
    StatedAccuracy result;
    result.sigma_up_m = grid.sigma_up_m;
    if (!grid.sigma_east_m || !grid.sigma_north_m) return result;
    const double sine = std::sin(geometry.convergence.radians());
    const double cosine = std::cos(geometry.convergence.radians());
    Eigen::Matrix3d true_from_grid = Eigen::Matrix3d::Zero();
    true_from_grid.topLeftCorner<2, 2>() << cosine, sine, -sine, cosine;
    const Eigen::Vector3d deviations =
        Eigen::Vector3d(*grid.sigma_east_m, *grid.sigma_north_m, 0.0) / geometry.scale;
    const Eigen::Matrix3d covariance = deviations.cwiseAbs2().asDiagonal();
    const StatedAccuracy turned =
        accuracy_from_covariance(true_from_grid * covariance * true_from_grid.transpose());
    result.sigma_east_m = turned.sigma_east_m;
    result.sigma_north_m = turned.sigma_north_m;
    result.correlation_east_north = turned.correlation_east_north;
    return result;
}

StatedAccuracy read_accuracy(const Fields& fields, const Description& description,
                             const Receiver& receiver) {
    StatedAccuracy accuracy;
    accuracy.sigma_up_m = fields.deviation(Column::sigma_up);
    if (!accuracy.sigma_up_m) accuracy.sigma_up_m = fields.deviation(Column::quality_height);
    if (const auto quality = fields.deviation(Column::quality_2d)) {
        // The quality is sqrt(sigma_east^2 + sigma_north^2), and does not say how it is shared.
        accuracy.sigma_east_m = accuracy.sigma_north_m = *quality / std::sqrt(2.0);
        return accuracy;
    }
    accuracy.sigma_east_m = fields.deviation(Column::sigma_east);
    accuracy.sigma_north_m = fields.deviation(Column::sigma_north);
    if (description.frame != CoordinateFrame::utm) return accuracy;
    return accuracy_from_grid(accuracy,
                              utm_geometry(*receiver.frame->utm_zone, fields.real(Column::east),
                                           fields.real(Column::north)));
}

void set_written_coordinates(WrittenCells& written, const Fields& fields, CoordinateFrame frame) {
    if (frame == CoordinateFrame::geodetic) return;  // read_place has
    const std::span<const Column> columns = position_columns(frame);
    const std::size_t count = frame == CoordinateFrame::ecef ? 3 : 2;
    for (std::size_t i = 0; i < count; ++i)
        written.coordinates[i] = fields.cell(columns[i]).text;
}

/// The part of a time that shows its decimals; of other counts than of seconds a number with as
/// many decimals as it has of a second.
std::string_view written_time(std::string_view text, const Description& description) {
    if (description.date_order && !description.days) return seconds_text(text);
    if (description.time_shift == 0 && !description.days) return text;
    constexpr std::string_view pattern = "0.000000000";
    const std::size_t decimals = text.size() - std::min(text.find('.'), text.size() - 1) - 1;
    // Of a day's decimals five are whole seconds.
    if (description.days) return pattern.substr(0, decimals > 5 ? decimals - 3 : 1);
    return pattern.substr(0, 2 + decimals + static_cast<std::size_t>(description.time_shift));
}

/// Whether a telephone says that its network gave the position, and no satellites.
bool is_of_network(const Fields& fields) {
    if (fields.text(Column::provider).empty()) return false;
    const std::string provider = lower_case(fields.text(Column::provider));
    return provider == "network" || provider == "wifi" || provider == "cell";
}

FixType read_fix(const Fields& fields) {
    if (!fields.has(Column::fix)) return FixType::unknown;
    const Cell& cell = fields.cell(Column::fix);
    if (const auto fix = fix_by_word(cell.text)) return *fix;
    if (parse_double(cell.text)) return read_rtklib_quality(cell);
    cell.fail(fmt::format("the fix \"{}\" is not known", escape_for_message(cell.text)),
              "Words that are read: fixed, float, ppp, dgps, sbas, single, dead_reckoning, none, "
              "unknown; or RTKLIB's number Q");
}

}  // namespace

bool is_mock(std::span<const Cell> cells, const Layout& layout) {
    if (!layout[Column::mock] || *layout[Column::mock] >= cells.size()) return false;
    const std::string said = lower_case(cells[*layout[Column::mock]].text);
    return said == "true" || said == "1" || said == "yes";
}

bool is_other_sensors(std::span<const Cell> cells, const Layout& layout) {
    const auto is_empty = [&](Column column) {
        return !layout[column] || is_missing(cells[*layout[column]].text);
    };
    return layout.between_sensors && (is_empty(Column::latitude) || is_empty(Column::longitude));
}

bool is_new_fix(std::span<const Cell> cells, const Layout& layout) {
    if (!layout[Column::new_fix]) return true;
    const Cell& cell = cells[*layout[Column::new_fix]];
    return read_whole(cell, "mark of a new fix", 0, 1) == 1;
}

void read_solution(std::span<const Cell> cells, const Layout& layout,
                   const Description& description, const Receiver& receiver, TimedRow& row) {
    const Fields fields(cells, layout);
    Observation& observation = row.observation;
    observation.recorded_velocity_east_m_s = fields.optional_real(Column::velocity_east);
    observation.recorded_velocity_north_m_s = fields.optional_real(Column::velocity_north);
    observation.recorded_velocity_up_m_s = fields.optional_real(Column::velocity_up);
    if (fields.has(Column::speed))
        set_speed(observation, fields.real(Column::speed),
                  course_of(fields.optional_real(Column::course)));
    if (const auto sigma = fields.deviation(Column::sigma_speed))
        set_component_accuracy(observation, *sigma);
    if (!has_position(fields, description) || is_of_network(fields)) {
        observation.fix = FixType::none;
        return;
    }
    if (description.frame == CoordinateFrame::local_plane) {
        observation.plane_east_m = fields.real(Column::east);
        observation.plane_north_m = fields.real(Column::north);
        observation.plane_up_m = fields.optional_real(Column::up);
    } else {
        set_position(observation, read_place(fields, description, receiver, row.written));
        const Column height = position_columns(description.frame)[2];
        if (description.has_up && description.frame != CoordinateFrame::ecef && !fields.has(height))
            observation.height_m.reset();
    }
    set_written_coordinates(row.written, fields, description.frame);
    static_cast<StatedAccuracy&>(observation) = read_accuracy(fields, description, receiver);
}

TimedRow read_row(std::span<const Cell> cells, const Layout& layout, const Description& description,
                  const Receiver& receiver) {
    const Fields fields(cells, layout);
    TimedRow row;
    Observation& observation = row.observation;
    row.instant = read_instant(fields, description, receiver);
    row.written.time = fields.has(Column::milliseconds)
                           ? std::string_view("0.000")
                           : written_time(fields.cell(Column::time).text, description);
    observation.fix = read_fix(fields);
    if (fields.has(Column::satellites))
        observation.satellites =
            read_count(fields.cell(Column::satellites), description.between_fixes);
    read_solution(cells, layout, description, receiver, row);
    return row;
}

}  // namespace runcert::csv
