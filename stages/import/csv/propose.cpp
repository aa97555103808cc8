#include "stages/import/csv/propose.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/csv/columns.h"
#include "stages/import/csv/csv.h"
#include "stages/import/import.h"
#include "stages/import/inspect.h"
#include "stages/import/recognise.h"

namespace runcert::csv {
namespace {

constexpr std::size_t cells_shown = 40;

/// In the order in which an attempt names them.
constexpr std::array named_columns{Column::date,
                                   Column::time,
                                   Column::week,
                                   Column::latitude,
                                   Column::longitude,
                                   Column::height,
                                   Column::x,
                                   Column::y,
                                   Column::z,
                                   Column::east,
                                   Column::north,
                                   Column::up,
                                   Column::sigma_east,
                                   Column::sigma_north,
                                   Column::sigma_up,
                                   Column::quality_2d,
                                   Column::quality_height,
                                   Column::velocity_east,
                                   Column::velocity_north,
                                   Column::velocity_up,
                                   Column::speed,
                                   Column::course,
                                   Column::sigma_speed,
                                   Column::fix,
                                   Column::satellites};

std::string_view cell_of(const SeenTable& table, const Layout& layout, Column column) {
    const auto& place = layout[column];
    return place ? table.first(*place) : std::string_view();
}

void add_unsure(Proposal& proposal, std::string sentence) {
    proposal.is.concerns.push_back({.code = ConcernCode::columns, .says = std::move(sentence)});
}

/// The proposal while it is made.
class Proposing {
  public:
    Proposing(const SeenTable& table, const CsvColumns& given)
        : table_(table), given_(given), layout_(find_columns(table, given)) {}

    Proposal made() {
        layout_.both_in_one =
            layout_[Column::latitude] && layout_[Column::latitude] == layout_[Column::longitude];
        proposal_.first_row = first_row();
        proposal_.receiver.format = "csv";
        set_frame();
        set_time();
        if (layout_.both_in_one)
            say("One column holds both coordinates: it is read as latitude, then longitude.");
        if (!table_.has_names) say("There is no header line: give columns by number, from 1.");
        set_columns();
        set_heights();
        set_speed_unit();
        set_unused();
        for (const Column column : named_columns)
            if (layout_[column] && has_decimal_commas(table_, *layout_[column])) {
                say(fmt::format(
                    "Numbers have decimal commas (\"{}\"), which are not read: export the "
                    "table with decimal points.",
                    escape_for_message(table_.first(*layout_[column]))));
                break;
            }
        return std::move(proposal_);
    }

  private:
    void propose(std::string key, std::string value, std::string reason, std::string unit = {}) {
        proposal_.is.proposed.push_back({.key = std::move(key),
                                         .value = std::move(value),
                                         .unit = std::move(unit),
                                         .reason = std::move(reason)});
    }
    void need(const std::string& key, std::string reason, bool required = true) {
        NeededKey one = needed_key(key, required);
        one.reason = std::move(reason);
        proposal_.is.needed.push_back(std::move(one));
    }
    void say(std::string sentence) { add_unsure(proposal_, std::move(sentence)); }

    std::string first_row() const {
        std::string text;
        const std::vector<Cell>& row = table_.rows.front();
        for (std::size_t i = 0; i < std::min(row.size(), cells_shown); ++i) {
            const std::string_view name = table_.has_names && i < table_.head.names.size()
                                              ? table_.head.names[i].text
                                              : std::string_view();
            text +=
                fmt::format("{}{} {}", i == 0 ? "" : ", ",
                            name.empty() ? fmt::format("{}:", i + 1) : escape_for_message(name, 40),
                            escape_for_message(row[i].text, 40));
        }
        return text;
    }

    void set_frame() {
        const CoordinateFrame frame = frame_of(table_, layout_);
        proposal_.receiver.frame = StatedFrame{frame};
        if (frame == CoordinateFrame::utm) {
            proposal_.receiver.frame->utm_zone = UtmZone{.zone = 31, .northern = true};
            need("frame",
                 "The coordinates look like those of a UTM grid, and no column says its zone.");
            return;
        }
        propose("frame", std::string(to_text(frame)),
                frame == CoordinateFrame::ecef ? "the distance from the Earth's centre fits"
                : frame == CoordinateFrame::local_plane ? "the coordinates are those of a plane"
                                                        : "the columns are latitude and longitude");
    }

    /// What the time column holds, by its first cell.
    std::string time_format(std::string_view time, std::string_view date) {
        if (!is_date(time) && is_date(date) && !time.empty()) return "time_of_day";
        if (day_count_of(time) && is_close(1.0 / 1440.0)) return "iso";
        if (parse_double(time)) {
            if (unix_shift(time)) return "unix";
            return layout_[Column::week] ? "seconds_of_week" : "seconds";
        }
        Cell cell;
        cell.text = time;
        const std::string_view day = split_date_time(cell)[0].text;
        if (time.find(':') != std::string_view::npos && !is_date(day)) return "time_of_day";
        return time.find(':') != std::string_view::npos || is_date(time) ? "iso" : "seconds";
    }

    /// Whether the times of the first rows are less apart.
    bool is_close(double most) const {
        const std::size_t column = *layout_[Column::time];
        for (std::size_t i = 1; i < table_.rows.size(); ++i) {
            const auto& a = table_.rows[i - 1];
            const auto& b = table_.rows[i];
            if (column >= a.size() || column >= b.size()) continue;
            const auto first = parse_double(a[column].text), second = parse_double(b[column].text);
            if (first && second && *first != *second) return std::abs(*second - *first) < most;
        }
        return false;
    }

    void set_time() {
        // A column "date" may hold both.
        if (!layout_[Column::time] && layout_[Column::date])
            layout_[Column::time] = std::exchange(layout_[Column::date], std::nullopt);
        if (!layout_[Column::time]) {
            proposal_.receiver.time_format = "seconds";
            propose("time_format", "seconds", "");
            return;
        }
        const std::string_view time = cell_of(table_, layout_, Column::time);
        const std::string_view date = cell_of(table_, layout_, Column::date);
        const std::string format = time_format(time, date);
        proposal_.receiver.time_format = format;
        if (format != "time_of_day") layout_[Column::date].reset();
        if (format != "seconds_of_week") layout_[Column::week].reset();
        const std::string shown = escape_for_message(time);
        if (format == "unix") {
            const int shift = unix_shift(time).value_or(0);
            propose("time_format", format,
                    fmt::format("{} counts {} since 1970, by its size", shown,
                                shift == 0   ? "seconds"
                                : shift == 3 ? "milliseconds"
                                : shift == 6 ? "microseconds"
                                             : "nanoseconds"));
        } else if (format == "seconds") {
            propose("time_format", format, fmt::format("{} is a count of seconds", shown));
            need("start_gps",
                 "Times count from an unknown start, so that the report could not say when the run "
                 "was.",
                 false);
        } else if (format == "seconds_of_week") {
            propose("time_format", format,
                    fmt::format("{} is a second of the GPS week beside it", shown));
        } else {
            propose("time_format", format,
                    format == "iso" ? fmt::format("{} holds date and time of day", shown)
                                    : fmt::format("{} is a time of day", shown));
            set_scale(time);
            if (format == "time_of_day" && !layout_[Column::date]) need_date();
        }
    }

    void need_date() {
        proposal_.receiver.start_date = "2000-01-01";
        need("start_date", "Times of day have no date beside them: the UTC date of the first row.");
    }

    void set_scale(std::string_view time) {
        Cell cell;
        cell.text = time;
        const std::string_view time_of_day = split_date_time(cell)[1].text;
        if (zone_of(time_of_day.empty() ? time : time_of_day)) return;
        proposal_.receiver.time_scale = "utc";
        // With what stands in brackets: "Time (UTC)".
        const auto name_at = [&](Column column) {
            return layout_[column] ? lower_case(table_.head.names[*layout_[column]].text)
                                   : std::string();
        };
        const std::string name = name_at(Column::time), date = name_at(Column::date);
        if (name.find("utc") != std::string::npos || date.find("utc") != std::string::npos)
            return propose("time_scale", "utc", "the column's name says UTC");
        if (name.find("gps") != std::string::npos) {
            proposal_.receiver.time_scale = "gps";
            return propose("time_scale", "gps", "the column's name says GPS time");
        }
        need("time_scale",
             "Nothing in the table says whether its times are UTC, local or GPS time.");
        proposal_.is.needed.back().values = {"utc", "local", "gps"};  // the first reads it
    }

    void set_columns() {
        for (const Column column : named_columns) {
            const auto& place = layout_[column];
            const std::string key = fmt::format("columns.{}", name_of(column));
            if (!place) continue;
            const std::string source = source_of(*place);
            proposal_.receiver.columns[std::string(name_of(column))] = source;
            const std::string_view first = table_.first(*place);
            const bool is_given = given_.contains(std::string(name_of(column)));
            std::string reason = fmt::format("{}; the first is {}",
                                             is_given           ? "as you say"
                                             : table_.has_names ? "by its name"
                                                                : "by its numbers",
                                             escape_for_message(first));
            if (column == Column::quality_2d)
                reason += "; taken as the root of the sum of both horizontal variances";
            propose(key, source, std::move(reason), unit_text(column));
        }
        Description description;
        description.frame = proposal_.receiver.frame->kind;
        description.time_format = proposal_.receiver.time_format == "iso" ? TimeFormat::iso
                                  : proposal_.receiver.time_format == "time_of_day"
                                      ? TimeFormat::time_of_day
                                      : TimeFormat::seconds;
        find_beside(layout_, description, table_.rows);
        const bool geodetic = proposal_.receiver.frame->kind == CoordinateFrame::geodetic;
        for (const Column column : {Column::time, Column::latitude, Column::longitude})
            if (!layout_[column] && (geodetic || column == Column::time))
                need(fmt::format("columns.{}", name_of(column)),
                     fmt::format("No column's name says which holds the {}.", name_of(column)));
    }

    /// What the numbers of a column are in, where they have a unit that is known.
    std::string unit_text(Column column) const {
        const auto quantity = column_kinds[static_cast<std::size_t>(column)].quantity;
        if (!quantity || column == Column::time) return {};
        if (const auto unit = unit_of_column(layout_.head, *layout_[column], *quantity))
            return std::string(unit->name);
        constexpr std::string_view units[] = {"", "m", "deg", "s"};
        return std::string(units[static_cast<std::size_t>(*quantity)]);
    }

    void set_heights() {
        const bool is_missing = proposal_.receiver.frame->kind == CoordinateFrame::utm
                                    ? !layout_[Column::up]
                                    : proposal_.receiver.frame->kind == CoordinateFrame::geodetic &&
                                          !layout_[Column::height];
        if (!is_missing) return;
        proposal_.receiver.height_m = 0.0;
        need("height_m",
             "No column holds heights, and each kilometre of it changes the speed by 0.016 %.");
    }

    /// By the name where no unit stands in brackets, in cells or under it.
    void set_speed_unit() {
        const auto& place =
            layout_[Column::speed] ? layout_[Column::speed] : layout_[Column::velocity_east];
        if (!place || unit_of_column(layout_.head, *place, Quantity::speed, false)) return;
        std::string_view cell = table_.first(*place);
        if (take_unit(cell, Quantity::speed)) return;
        const auto unit = unit_of_column(layout_.head, *place, Quantity::speed);
        // Others than these an attempt has no word for, and import reads them itself.
        if (unit && speed_unit_of_ratio(1.0 / unit->factor)) {
            proposal_.receiver.speed_unit = unit->name;
            return propose("speed_unit", std::string(unit->name), "the column's name ends so");
        }
        proposal_.speed_unit_unknown = layout_[Column::speed].has_value() && !unit;
    }

    void set_unused() {
        for (std::size_t i = 0; i < table_.head.names.size() && table_.has_names; ++i) {
            const std::string_view name = table_.head.names[i].text;
            if (!name.empty() &&
                std::ranges::find(layout_.place, std::optional(i)) == layout_.place.end())
                proposal_.is.unused.push_back(escape_for_message(name, 60));
        }
    }

    /// A column's name, or its number where its name is there twice or empty.
    std::string source_of(std::size_t place) const {
        const std::string_view name = table_.head.names[place].text;
        const auto same = std::count_if(table_.head.names.begin(), table_.head.names.end(),
                                        [&](const Cell& cell) { return cell.text == name; });
        if (!table_.has_names || name.empty() || same > 1 || !is_printable_ascii(name))
            return fmt::format("{}", place + 1);
        return std::string(name);
    }

    const SeenTable& table_;
    const CsvColumns& given_;
    Layout layout_;
    Proposal proposal_;
};

bool lacks_columns(const Proposal& proposal) {
    return std::ranges::any_of(
        proposal.is.needed, [](const NeededKey& one) { return one.key.starts_with("columns."); });
}

/// The dates that a first date may be, as the importer finds that no row shows which.
void settle_date_order(Proposal& proposal, const RecordingBytes& recording) {
    if (proposal.receiver.time_format != "iso" && proposal.receiver.time_format != "time_of_day")
        return;
    if (!proposal.receiver.start_date.empty()) return;
    const std::vector<std::string> dates = dates_in_doubt(proposal.receiver, recording);
    if (dates.size() < 2) return;
    proposal.receiver.start_date = dates.front();
    proposal.is.needed.push_back({.key = "start_date",
                                  .reason = "No row shows which part of a date is the day: the UTC "
                                            "date of the first row.",
                                  .values = dates,
                                  .required = true});
}

/// Reads the recording as it is proposed.
void read_as(Proposal& proposal, const RecordingBytes& recording) {
    const auto read = [&] {
        proposal.read = import_recording(proposal.receiver, recording);
        note_origins(proposal.receiver, *proposal.read);
        note_written_by(recording, false, *proposal.read);
        // Of a height that stands in for one that is asked for nothing is said.
        if (proposal.receiver.height_m)
            std::erase_if(proposal.read->notes, [](const std::string& note) {
                return note.starts_with("Heights are not recorded");
            });
    };
    settle_date_order(proposal, recording);
    read();
    if (!proposal.speed_unit_unknown) return;
    const Inspection first = inspect(*proposal.read);
    if (!first.best_by_position || !first.best_by_velocity) return;
    const auto unit =
        speed_unit_of_ratio(first.best_by_velocity->speed_m_s / first.best_by_position->speed_m_s);
    if (!unit) {
        proposal.is.needed.push_back(needed_key("speed_unit", true));
        proposal.is.needed.back().reason =
            "The unit of speeds is not named, and none fits the positions.";
        return;
    }
    proposal.receiver.speed_unit = unit->name;
    proposal.is.proposed.push_back({.key = "speed_unit",
                                    .value = std::string(unit->name),
                                    .unit = {},
                                    .reason = "no name says it, and it fits the positions"});
    add_unsure(proposal,
               fmt::format("The unit of speeds is not named: {} fits the positions.", unit->name));
    read();
}

}  // namespace

std::optional<Proposal> propose(const RecordingBytes& recording, const CsvColumns& given) {
    const auto table = find_table(recording);
    if (!table) return std::nullopt;
    Proposal proposal = Proposing(*table, given).made();
    proposal.receiver.id = "proposed";
    proposal.receiver.place = recording.name;
    if (lacks_columns(proposal)) {
        proposal.is.problem = "Nothing says which columns hold the positions and their times.";
        return proposal;
    }
    try {
        read_as(proposal, recording);
    } catch (const Failure& failure) {
        proposal.read.reset();
        proposal.is.problem = fmt::format("{}: {} {}", failure.where(), sentence(failure.problem()),
                                          sentence(failure.remedy()));
    }
    return proposal;
}

}  // namespace runcert::csv
