#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/enum_text.h"
#include "stages/import/csv/head.h"
#include "stages/import/csv/layout.h"

namespace runcert::csv {
namespace {

constexpr EnumWords<TimeFormat, 5> time_format_words{
    {{TimeFormat::seconds, "seconds"},
     {TimeFormat::seconds_of_week, "seconds_of_week"},
     {TimeFormat::unix, "unix"},
     {TimeFormat::iso, "iso"},
     {TimeFormat::time_of_day, "time_of_day"}}};

[[noreturn]] void fail(const Receiver& receiver, const std::string& what,
                       const std::string& remedy) {
    throw Failure(receiver.place.empty() ? fmt::format("receiver {}", receiver.id) : receiver.place,
                  what, remedy);
}

bool maps(const Receiver& receiver, Column column) {
    return receiver.columns.contains(std::string(name_of(column)));
}

void require_column(const Receiver& receiver, Column column, std::string_view reason) {
    if (!maps(receiver, column))
        fail(receiver,
             fmt::format("no column is named for \"{}\", which {} needs", name_of(column), reason),
             fmt::format("Write columns: {{{}: ...}}: a name of the header line, or a number",
                         name_of(column)));
}

constexpr Column grid_columns[] = {Column::east, Column::north, Column::up};
constexpr Column geodetic_columns[] = {Column::latitude, Column::longitude, Column::height};
constexpr Column ecef_columns[] = {Column::x, Column::y, Column::z};
constexpr Column week_columns[] = {Column::week};
constexpr Column date_columns[] = {Column::date};

void refuse_useless(const Receiver& receiver, std::span<const Column> useful,
                    std::span<const Column> others, std::string_view setting) {
    if (useful.data() == others.data()) return;
    for (const Column column : others)
        if (maps(receiver, column))
            fail(receiver,
                 fmt::format("a column is named for \"{}\", which is of no use with {}",
                             name_of(column), setting),
                 "Remove it from columns, or write another frame or time_format");
}

void check_position(const Receiver& receiver, Description& description) {
    const std::span<const Column> needed = position_columns(description.frame);
    const std::string setting = fmt::format("frame {}", to_text(description.frame));
    for (const std::span<const Column> others :
         {std::span(grid_columns), std::span(geodetic_columns), std::span(ecef_columns)})
        refuse_useless(receiver, needed, others, setting);
    require_column(receiver, needed[0], setting);
    require_column(receiver, needed[1], setting);
    description.has_up = maps(receiver, needed[2]);
    if (description.frame == CoordinateFrame::ecef) require_column(receiver, needed[2], setting);
    if (description.frame == CoordinateFrame::utm && !receiver.frame->utm_zone)
        fail(receiver, "UTM coordinates need their zone and hemisphere",
             "Write frame: {utm: {zone: 55, hemisphere: south}}");
    if (description.has_up || description.frame == CoordinateFrame::local_plane) return;
    if (!receiver.height_m)
        fail(receiver, "the recording has no column of heights, and the attempt states none",
             "Write height_m in the receiver: the course's height above the ellipsoid in metres");
    description.constant_height_m = receiver.height_m;
}

void check_pair(const Receiver& receiver, Column a, Column b) {
    if (maps(receiver, a) != maps(receiver, b))
        fail(receiver,
             fmt::format("of \"{}\" and \"{}\" only one is named", name_of(a), name_of(b)),
             "Name both columns, or neither");
}

void check_accuracy(const Receiver& receiver) {
    check_pair(receiver, Column::sigma_east, Column::sigma_north);
    check_pair(receiver, Column::velocity_east, Column::velocity_north);
    if (maps(receiver, Column::velocity_east) && maps(receiver, Column::speed))
        fail(receiver, "both velocity_east and speed are named", "Name the one to be used");
    if (maps(receiver, Column::course)) require_column(receiver, Column::speed, "course");
    if (maps(receiver, Column::sigma_speed) && !maps(receiver, Column::velocity_east))
        require_column(receiver, Column::speed, "sigma_speed");
    if (maps(receiver, Column::quality_2d) && maps(receiver, Column::sigma_east))
        fail(receiver, "both quality_2d and sigma_east are named", "Name the one to be used");
    if (maps(receiver, Column::quality_height) && maps(receiver, Column::sigma_up))
        fail(receiver, "both quality_height and sigma_up are named", "Name the one to be used");
}

void check_time(const Receiver& receiver, Description& description) {
    if (!receiver.time_format.empty() &&
        !value_of(time_format_words, receiver.time_format, description.time_format))
        fail(receiver,
             fmt::format("time_format \"{}\" is not known",
                         escape_for_message(receiver.time_format)),
             "Use seconds, seconds_of_week, unix, iso or time_of_day");
    const std::string setting =
        fmt::format("time_format {}", word_of(time_format_words, description.time_format));
    require_column(receiver, Column::time, setting);
    const bool week = description.time_format == TimeFormat::seconds_of_week;
    const bool date = description.time_format == TimeFormat::time_of_day;
    if (week) require_column(receiver, Column::week, setting);
    if (date && receiver.start_date.empty()) require_column(receiver, Column::date, setting);
    if (date && !maps(receiver, Column::date)) description.start_date = receiver.start_date;
    if (!week) refuse_useless(receiver, {}, week_columns, setting);
    if (!date) refuse_useless(receiver, {}, date_columns, setting);
    if (receiver.time_scale == "utc") description.clock = Clock::utc;
    if (receiver.time_scale != "local") return;
    if (description.time_format == TimeFormat::seconds ||
        description.time_format == TimeFormat::unix)
        fail(receiver, fmt::format("time_scale local is of no use with {}", setting),
             "Remove it, or write another time_format");
    if (!receiver.utc_offset_h)
        fail(receiver, "times are local, and nobody says what they are ahead of UTC by",
             "Write utc_offset_h: 9.5, say: local time less UTC in hours on that day");
    description.clock = Clock::local(*receiver.utc_offset_h);
}

std::optional<char> read_delimiter(const Receiver& receiver) {
    if (receiver.delimiter == "auto" || receiver.delimiter.empty()) return std::nullopt;
    std::string words;
    for (const Delimiter& known : delimiters()) {
        if (known.word == receiver.delimiter) return known.character;
        words += fmt::format("{}, ", known.word);
    }
    fail(receiver,
         fmt::format("delimiter \"{}\" is not known", escape_for_message(receiver.delimiter)),
         fmt::format("Use one of {}auto", words));
}

}  // namespace

std::span<const Column> position_columns(CoordinateFrame frame) {
    if (frame == CoordinateFrame::geodetic) return geodetic_columns;
    return frame == CoordinateFrame::ecef ? ecef_columns : grid_columns;
}

Description describe(const Receiver& receiver) {
    Description description;
    if (receiver.columns.empty())
        fail(receiver, "the recording is a table, and no columns are named",
             "Write columns: {time: ..., latitude: ..., ...}, names of the header line or numbers");
    for (const auto& [name, source] : receiver.columns)
        if (std::ranges::find(column_kinds, name, &ColumnKind::name) == column_kinds.end())
            fail(receiver, fmt::format("columns has no member \"{}\"", escape_for_message(name)),
                 "See schemas/attempt/v1.yaml for the columns that are read");
    if (!receiver.frame)
        fail(receiver, "the recording is a table, and its frame is not stated",
             "Write frame: geodetic, ecef, local_plane, or {utm: {zone: 55, hemisphere: south}}");
    description.frame = receiver.frame->kind;
    check_position(receiver, description);
    check_accuracy(receiver);
    check_time(receiver, description);
    description.delimiter = read_delimiter(receiver);
    if (!receiver.speed_unit.empty()) description.speed_unit = find_unit(receiver.speed_unit);
    return description;
}

}  // namespace runcert::csv
