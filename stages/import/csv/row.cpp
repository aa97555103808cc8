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

/// The halves of a cell that holds two values, which blanks or one , ; or / parts; the second is
/// empty where nothing does.
std::array<Cell, 2> halves_of(const Cell& cell) {
    Cell first = cell, second = cell;
    const std::size_t end = std::min(cell.text.find_first_of(" \t,;/"), cell.text.size());
    const std::size_t begin =
        std::min(cell.text.find_first_not_of(" \t,;/", end), cell.text.size());
    first.text = cell.text.substr(0, end);
    second.text = cell.text.substr(begin);
    second.column += begin;
    return {first, second};
}

/// A latitude or longitude as written: with a sign, or with the letter of its hemisphere.
struct Coordinate {
    Cell number;
    std::string_view meaning;
    char letter = '\0';  ///< lower case

    /// In degrees, south and west negative. Failure where it is no number, or two.
    double value() const {
        const bool has_point = number.text.find('.') != std::string_view::npos;  // "1,5" is one
        if (has_point && parse_double(halves_of(number)[0].text) &&
            parse_double(halves_of(number)[1].text))
            number.fail(
                fmt::format("the {} \"{}\" is two numbers, both coordinates in one cell", meaning,
                            escape_for_message(number.text)),
                "Name this column for latitude and for longitude: it is read in that order");
        const double degrees = read_real(number, meaning);
        if (letter != '\0' && degrees < 0.0)
            number.fail(fmt::format("the {} has a sign, and the letter of a hemisphere", meaning),
                        "Hand in the table as the logger wrote it, or another export");
        return letter == 's' || letter == 'w' ? -degrees : degrees;
    }
};

/// The coordinate in a cell; `letters` are those of its two hemispheres, in lower case ("ns").
Coordinate coordinate_in(const Cell& cell, std::string_view meaning, std::string_view letters) {
    Coordinate coordinate{.number = cell, .meaning = meaning};
    std::string_view& text = coordinate.number.text;
    if (text.empty()) return coordinate;
    const auto lower = [](char c) { return static_cast<char>(c | 0x20); };
    if (letters.find(lower(text.back())) != std::string_view::npos) {
        coordinate.letter = lower(text.back());
        text.remove_suffix(1);
    } else if (letters.find(lower(text.front())) != std::string_view::npos) {
        coordinate.letter = lower(text.front());
        text.remove_prefix(1);
        ++coordinate.number.column;
    }
    constexpr std::string_view degree_sign = "\xc2\xb0";
    if (text.ends_with(degree_sign)) text.remove_suffix(degree_sign.size());
    text = trim(text);
    return coordinate;
}

/// The fields of one row, by column.
class Fields : public RowCells<Column> {
  public:
    Fields(std::span<const Cell> cells, const Layout& layout)
        : RowCells(cells, layout), layout_(layout) {}

    /// Whether the column is there and its field not empty.
    bool has(Column column) const { return !text(column).empty(); }
    double real(Column column) const {
        return RowCells::real(column, name_of(column)) * layout_.factor[index(column)];
    }
    std::optional<double> optional_real(Column column) const {
        if (!has(column)) return std::nullopt;
        return real(column);
    }
    /// Latitude or longitude, each a half of its cell where one column holds both.
    Coordinate coordinate(Column column) const {
        const bool north = column == Column::latitude;
        const Cell& whole = cell(column);
        return coordinate_in(layout_.both_in_one ? halves_of(whole)[north ? 0 : 1] : whole,
                             name_of(column), north ? "ns" : "ew");
    }
    /// Empty, and zero, are unknown.
    std::optional<double> deviation(Column column) const {
        if (!has(column)) return std::nullopt;
        const double value =
            read_deviation(cell(column), name_of(column)) * layout_.factor[index(column)];
        return value > 0.0 ? std::optional(value) : std::nullopt;
    }

  private:
    static std::size_t index(Column column) { return static_cast<std::size_t>(column); }

    const Layout& layout_;
};

/// A count of satellites, which is interpolated too where rows are.
std::int16_t read_count(const Cell& cell, bool between_fixes) {
    if (!between_fixes) return read_satellites(cell);
    Cell whole = cell;
    whole.text = cell.text.substr(0, cell.text.find('.'));
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
    const std::string_view date = split_date_time(time)[0].text;
    const bool has_date = date.find_first_of("/-.") != std::string_view::npos && is_date(date);
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

GpsTime read_instant(const Fields& fields, const Description& description,
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
Geodetic read_place(const Fields& fields, const Description& description,
                    const Receiver& receiver) {
    if (description.frame == CoordinateFrame::ecef)
        return checked_ecef(
            {fields.real(Column::x), fields.real(Column::y), fields.real(Column::z)},
            fields.cell(Column::x));
    const bool utm = description.frame == CoordinateFrame::utm;
    const Column height = utm ? Column::up : Column::height;
    const double height_m =
        description.has_up ? fields.real(height) : *description.constant_height_m;
    const Cell& first = fields.cell(utm ? Column::east : Column::latitude);
    const Geodetic position =
        utm ? read_utm(fields, receiver, height_m)
            : Geodetic{
                  .latitude = Angle::from_degrees(fields.coordinate(Column::latitude).value()),
                  .longitude = Angle::from_degrees(fields.coordinate(Column::longitude).value()),
                  .height_m = height_m};
    return checked_geodetic(position, first, fields.cell(utm ? Column::north : Column::longitude),
                            description.has_up ? fields.cell(height) : first);
}

bool has_position(const Fields& fields, const Description& description) {
    const std::span<const Column> columns = position_columns(description.frame);
    return fields.has(columns[0]) && fields.has(columns[1]) &&
           (!description.has_up || fields.has(columns[2]));
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
    const std::span<const Column> columns = position_columns(frame);
    if (frame == CoordinateFrame::geodetic) {
        written.unit = CoordinateUnit::degree;
        written.coordinates = {fields.coordinate(columns[0]).number.text,
                               fields.coordinate(columns[1]).number.text};
        return;
    }
    const std::size_t count = frame == CoordinateFrame::ecef ? 3 : 2;
    for (std::size_t i = 0; i < count; ++i)
        written.coordinates[i] = fields.cell(columns[i]).text;
}

/// The part of a time that shows its decimals.
std::string_view written_time(std::string_view text, const Description& description) {
    if (description.date_order) return seconds_text(text);
    if (description.time_shift == 0) return text;
    constexpr std::string_view pattern = "0.000000000";
    const std::size_t point = text.find('.');
    const std::size_t decimals = point == std::string_view::npos ? 0 : text.size() - point - 1;
    return pattern.substr(0, 2 + decimals + static_cast<std::size_t>(description.time_shift));
}

FixType read_fix(const Fields& fields) {
    if (!fields.has(Column::fix)) return FixType::unknown;
    const Cell& cell = fields.cell(Column::fix);
    FixType fix{};
    if (from_text(lower_case(cell.text), fix)) return fix;
    if (cell.text == "SPS") return FixType::single;  // standard positioning service, by Columbus
    if (parse_double(cell.text)) return read_rtklib_quality(cell);
    cell.fail(fmt::format("the fix \"{}\" is not known", escape_for_message(cell.text)),
              "Words that are read: fixed, float, ppp, dgps, sbas, single, dead_reckoning, none, "
              "unknown; or RTKLIB's number Q");
}

}  // namespace

bool is_new_fix(std::span<const Cell> cells, const Layout& layout) {
    if (!layout[Column::new_fix]) return true;
    const Cell& cell = cells[*layout[Column::new_fix]];
    return read_whole(cell, "mark of a new fix", 0, 1) == 1;
}

TimedRow read_row(std::span<const Cell> cells, const Layout& layout, const Description& description,
                  const Receiver& receiver) {
    const Fields fields(cells, layout);
    TimedRow row;
    Observation& observation = row.observation;
    row.instant = read_instant(fields, description, receiver);
    row.written.time = written_time(fields.cell(Column::time).text, description);
    observation.fix = read_fix(fields);
    if (fields.has(Column::satellites))
        observation.satellites =
            read_count(fields.cell(Column::satellites), description.between_fixes);
    observation.recorded_velocity_east_m_s = fields.optional_real(Column::velocity_east);
    observation.recorded_velocity_north_m_s = fields.optional_real(Column::velocity_north);
    observation.recorded_velocity_up_m_s = fields.optional_real(Column::velocity_up);
    if (fields.has(Column::speed))
        set_speed(observation, fields.real(Column::speed),
                  course_of(fields.optional_real(Column::course)));
    if (const auto sigma = fields.deviation(Column::sigma_speed))
        set_component_accuracy(observation, *sigma);
    if (!has_position(fields, description)) {
        observation.fix = FixType::none;
        return row;
    }
    if (description.frame == CoordinateFrame::local_plane) {
        observation.plane_east_m = fields.real(Column::east);
        observation.plane_north_m = fields.real(Column::north);
        observation.plane_up_m = fields.optional_real(Column::up);
    } else {
        set_position(observation, read_place(fields, description, receiver));
    }
    set_written_coordinates(row.written, fields, description.frame);
    static_cast<StatedAccuracy&>(observation) = read_accuracy(fields, description, receiver);
    return row;
}

}  // namespace runcert::csv
