#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "core/failure.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "core/written_unit.h"
#include "stages/import/vbo/vbo.h"

namespace runcert::vbo {
namespace {

constexpr std::size_t most_channels = 10'000;
constexpr std::size_t comments_kept = 100;
constexpr std::string_view created_on = "file created on";

/// The names of each column, in the order of Column: Racelogic's, then those of other writers. Of
/// several columns for one meaning, the one whose name comes first here counts.
constexpr std::array<std::array<std::string_view, 8>, static_cast<std::size_t>(Column::count)>
    names{{{"satellites", "sats", "satcount", "numsats", "numsv", "nsat"},
           {"time", "utctime", "gpstime", "utc"},
           {"latitude", "lat", "gpslatitude", "gpslat"},
           {"longitude", "long", "lon", "lng", "gpslongitude", "gpslong", "gpslon", "gpslng"},
           {"velocity", "gpsspeed", "groundspeed", "speed", "vel"},
           {"heading", "gpsheading", "course", "bearing"},
           {"height", "altitude", "gpsaltitude", "elevation", "alt"},
           {"verticalvelocity", "verticalvel", "vertvel"},
           {"solutiontype"}}};

/// A channel by its name.
struct Channel {
    std::string_view name;  ///< of `names`
    Column column;
    std::string unit;  ///< empty where the name has none
};

/// The letters and digits of a name, in lower case: "vert-vel" and "Vert Vel" are one.
std::string letters(std::string_view name) {
    std::string text = lower_case(name);
    std::erase_if(text, [](char c) { return !((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')); });
    return text;
}

bool is_speed(Column column) {
    return column == Column::velocity || column == Column::vertical_velocity;
}

/// "velocity kmh" is the velocity, "velocity quality" is none of the columns.
std::optional<Channel> channel_of(std::string_view text) {
    const std::string name = letters(text);
    for (std::size_t i = 0; i < names.size(); ++i)
        for (const std::string_view known : names[i]) {
            if (known.empty() || !name.starts_with(known)) continue;
            const auto column = static_cast<Column>(i);
            const std::string unit = name.substr(known.size());
            if (unit.empty() || unit == "utc" ||
                (is_speed(column) ? find_unit(unit, Quantity::speed) : find_unit(unit)))
                return Channel{known, column, unit};
        }
    return std::nullopt;
}

/// The unit of a column: of its own name, else of its name in [header], else in [channel units]
/// where that has a line for every column.
std::string unit_of(const Header& header, const Channel& channel, std::size_t field,
                    std::size_t fields) {
    if (!channel.unit.empty()) return channel.unit;
    for (const std::string_view text : header.channels)
        if (const auto named = channel_of(text);
            named && named->column == channel.column && !named->unit.empty())
            return named->unit;
    return header.units.size() == fields ? letters(header.units[field]) : std::string();
}

void set_unit(Layout& layout, Column column, const std::string& unit) {
    const auto speed = find_unit(unit, Quantity::speed);
    if (column == Column::velocity) layout.velocity_m_s = speed ? speed->factor : km_h_in_m_s;
    if (column == Column::vertical_velocity && speed) layout.vertical_velocity_m_s = speed->factor;
    if (column == Column::longitude && unit.starts_with("deg"))
        layout.coordinates = Coordinates::degrees;
}

/// "[comments]" gives "comments"; nothing for a line that begins no section.
std::optional<std::string> section_of(std::string_view text) {
    if (!text.starts_with('[') || !text.ends_with(']')) return std::nullopt;
    return lower_case(trim(text.substr(1, text.size() - 2)));
}

void add_channel(std::vector<std::string_view>& channels, std::string_view text,
                 const SourceLine& line, const RecordingBytes& recording) {
    if (channels.size() == most_channels)
        throw Failure(place_in(recording, line),
                      fmt::format("the header names more than {} channels", most_channels),
                      "Take the recording as the logger wrote it");
    channels.push_back(text);
}

/// Takes in a line of a section.
void read_line(Header& header, const std::string& section, std::string_view text,
               const SourceLine& line, const RecordingBytes& recording) {
    if (section == "header") {
        if (header.channels.empty() && header.columns.empty()) header.names_line = line.number;
        add_channel(header.channels, text, line, recording);
    } else if (section == "channel units") {
        add_channel(header.units, text, line, recording);
    } else if (section == "column names") {
        if (header.columns.empty()) header.names_line = line.number;
        for (const Cell& word : split(line, recording))
            add_channel(header.columns, word.text, line, recording);
    } else if (section == "comments" && header.comments.size() < comments_kept) {
        header.comments.push_back(text);
    }
}

/// What stands behind the colon of the first comment of one of these names.
std::string_view comment_of(const Header& header,
                            std::initializer_list<std::string_view> its_names) {
    for (const std::string_view comment : header.comments) {
        const std::size_t colon = comment.find(':');
        if (colon == std::string_view::npos) continue;
        const std::string name = letters(comment.substr(0, colon));
        if (std::find(its_names.begin(), its_names.end(), name) != its_names.end())
            return trim(comment.substr(colon + 1));
    }
    return {};
}

}  // namespace

std::vector<Cell> split(const SourceLine& line, const RecordingBytes& recording) {
    return split_words(line, line.text, recording, '\0', " \t\r");
}

Header read_header(LineReader& lines, const RecordingBytes& recording) {
    Header header;
    std::string section;
    while (const auto line = lines.next()) {
        const std::string_view text = trim(line->text);
        if (const auto begun = section_of(text)) {
            section = *begun;
            if (section == "data") return header;
        } else if (section.empty() && lower_case(text.substr(0, created_on.size())) == created_on) {
            header.created = trim(text.substr(created_on.size()));
        } else if (!text.empty()) {
            read_line(header, section, text, *line, recording);
        }
    }
    throw Failure(place_in(recording, 1, 1), "the VBO file has no section [data]",
                  "It holds a header at most; take the whole recording");
}

Layout find_layout(const Header& header, std::size_t fields, const RecordingBytes& recording) {
    const bool by_header = header.columns.size() != fields && header.channels.size() == fields;
    const std::vector<std::string_view>& named =
        by_header || header.columns.empty() ? header.channels : header.columns;
    Layout layout;
    layout.fields = fields > 0 ? fields : named.size();
    layout.named = named.size();
    for (std::size_t i = 0; i < names.size(); ++i)
        for (const std::string_view name : names[i])
            for (std::size_t field = 0; field < named.size() && !layout.place[i]; ++field) {
                const auto channel = channel_of(named[field]);
                if (!channel || channel->name != name || field >= layout.fields) continue;
                layout.place[i] = field;
                set_unit(layout, channel->column, unit_of(header, *channel, field, named.size()));
            }
    for (const auto& [column, name] :
         {std::pair{Column::time, "time"}, {Column::latitude, "lat"}, {Column::longitude, "long"}})
        if (!layout[column])
            throw Failure(
                place_in(recording, header.names_line, 1),
                fmt::format("no column is named \"{}\", or as other writers call it, among {} "
                            "names for {} fields in a row",
                            name, named.size(), layout.fields),
                "Export the recording again with time, latitude and longitude, or as CSV "
                "with columns: in the receiver");
    return layout;
}

std::optional<double> degrees_of(double written, Coordinates coordinates) {
    if (coordinates == Coordinates::degrees) return written;
    if (coordinates == Coordinates::minutes) return written / 60.0;
    const double degrees = std::trunc(written / 100.0);
    const double minutes = written - 100.0 * degrees;
    if (std::abs(minutes) >= 60.0) return std::nullopt;
    return degrees + minutes / 60.0;
}

Instrument instrument_of(const Header& header) {
    return {.model = instrument_part(comment_of(header, {"type"})),
            .serial = instrument_part(comment_of(header, {"serial", "serialnumber"})),
            .firmware = instrument_part(comment_of(header, {"firmware"}))};
}

std::string device_of(const Header& header) {
    const Instrument said = instrument_of(header);
    std::string device = said.model;
    if (device.empty())
        for (const std::string_view comment : header.comments)
            if (comment.find(':') == std::string_view::npos && !comment.starts_with('(') &&
                !comment.starts_with('<')) {
                device = instrument_part(comment);
                break;
            }
    const auto add = [&](std::string_view what, const std::string& text) {
        if (!text.empty()) device += fmt::format("{}{} {}", device.empty() ? "" : ", ", what, text);
    };
    add("serial number", said.serial);
    add("firmware", said.firmware);
    return device;
}

}  // namespace runcert::vbo
