#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/text.h"
#include "stages/import/earth.h"
#include "stages/import/format.h"
#include "stages/import/rtklib_pos/columns.h"

/// RTKLIB solution files (.pos), RTKLIB 2.4.3 manual, appendix B.1, and what programs near it
/// write: all coordinates, time and separator variants, read by the names in the header line.
namespace runcert::rtklib_pos {
namespace {

constexpr std::int64_t lines_to_recognise = 200;

/// Whether a header line is the one that names the columns.
bool is_column_line(std::string_view line) {
    if (!line.starts_with('%')) return false;
    for (const std::string_view name : {"latitude(", "x-ecef(", "e-baseline("})
        if (line.find(name) != std::string_view::npos) return true;
    return false;
}

/// Failure for a header line that says that the datum is not WGS 84, or that heights are not above
/// the ellipsoid.
void require_datum(const SourceLine& line, const RecordingBytes& recording) {
    const Cell start{line.text, &recording, line.number, 1};
    if (line.text.find("=Tokyo") != std::string_view::npos)
        start.fail("the positions are in the Tokyo datum", "Export the solution again in WGS 84");
    if (line.text.find("height=WGS84/geodetic") != std::string_view::npos)
        start.fail("the heights are above a geoid (\"geodetic\"), not above the ellipsoid",
                   "Export the solution again with ellipsoidal heights");
}

/// Key and value of a header line "% key : value" (RTKLIB 2.4.3, outheader() of postpos.c); empty
/// for another line.
struct Entry {
    std::string_view key, value;
};

Entry read_entry(std::string_view line) {
    constexpr std::size_t widest_key = 16;
    const std::size_t colon = line.find(':');
    if (!line.starts_with('%') || colon > widest_key || line.find('(') < colon) return {};
    return {trim(line.substr(1, colon - 1)), trim(line.substr(colon + 1))};
}

/// Adds what an entry says of how the solution was made: program, files without their folders,
/// first and last observation, options, 40 at most.
void add_processing(const Entry& entry, std::optional<Processing>& processing) {
    constexpr std::size_t most = 40, longest = 120;
    const std::string value = escape_for_message(entry.value, longest);
    if (entry.key.empty() || value.empty()) return;
    if (!processing) processing.emplace();
    if (entry.key == "program") {
        processing->program = value;
    } else if (entry.key == "inp file") {
        if (processing->files.size() < most)
            processing->files.push_back(value.substr(value.find_last_of("/\\") + 1));
    } else if (entry.key == "obs start") {
        processing->begin = value;
    } else if (entry.key == "obs end") {
        processing->end = value;
    } else if (processing->options.size() < most) {
        processing->options.push_back(fmt::format("{}: {}", escape_for_message(entry.key), value));
    }
}

/// Degrees from one field or from three, the sign (also of "-0") on the degrees.
Angle read_angle(const Cell& first, bool dms, std::string_view meaning) {
    const double degrees = read_real(first, meaning);
    if (!dms) return Angle::from_degrees(degrees);
    const std::span<const Cell> parts(&first, 3);
    const std::int64_t minutes = read_whole(parts[1], "count of minutes", 0, 59);
    const double seconds = read_real(parts[2], meaning);
    if (degrees != std::floor(degrees))
        first.fail(fmt::format("the {} has a fraction of degrees before its minutes", meaning),
                   as_written);
    // RTKLIB rounds seconds for print, and may so write 60.
    if (seconds < 0.0 || seconds > 60.0)
        parts[2].fail(fmt::format("the seconds of the {} are not from 0 to 60", meaning),
                      as_written);
    return Angle::from_dms(std::signbit(degrees) ? -1 : 1, std::abs(degrees),
                           static_cast<double>(minutes), seconds);
}

/// The position whose angles begin at two cells.
Geodetic read_angles(const Cell& latitude, const Cell& longitude, const Cell& height, bool dms) {
    const Geodetic position{.latitude = read_angle(latitude, dms, "latitude"),
                            .longitude = read_angle(longitude, dms, "longitude"),
                            .height_m = read_real(height, "height")};
    return checked_geodetic(position, latitude, longitude, height);
}

/// The base's position from the value of "ref pos": in degrees, in three fields each, or
/// Earth-centred.
Geodetic read_reference_position(std::string_view value, const SourceLine& line,
                                 const RecordingBytes& recording) {
    constexpr double largest_degrees = 360.0;  // above it are metres from the Earth's centre
    const std::vector<Cell> cells = split_words(line, value, recording, find_separator(value));
    const bool dms = cells.size() == 7;
    if (!dms && cells.size() != 3)
        Cell{line.text, &recording, line.number, 1}.fail(
            "the base position is not three numbers, nor seven in degrees-minutes-seconds",
            as_written);
    if (!dms) {
        constexpr std::string_view meaning = "base position";
        const Eigen::Vector3d values(read_real(cells[0], meaning), read_real(cells[1], meaning),
                                     read_real(cells[2], meaning));
        if (values.head<2>().cwiseAbs().maxCoeff() > largest_degrees)
            return checked_ecef(values, cells[0]);
    }
    return read_angles(cells[0], cells[dms ? 3 : 1], cells.back(), dms);
}

/// The fields of one row, by column. `base` is that of a baseline, else null.
class Fields : public RowCells<Column> {
  public:
    Fields(std::span<const Cell> cells, const Layout& layout, const LocalFrame* base)
        : RowCells(cells, layout), layout_(layout), base_(base) {}

    Eigen::Vector3d three(Column first, std::string_view meaning) const {
        return {real(first, meaning), real(after(first, 1), meaning),
                real(after(first, 2), meaning)};
    }
    Geodetic position() const {
        const Cell& first = cell(layout_.coordinates);
        if (layout_.coordinates == Column::latitude)
            return read_angles(first, cell(Column::longitude), cell(Column::height), layout_.dms);
        Eigen::Vector3d place_m = three(layout_.coordinates, "coordinate");
        if (base_) place_m = ecef_from_geodetic(base_->geodetic_from_enu(Enu{place_m})).m;
        return checked_ecef(place_m, first);
    }
    /// The velocity towards east, north, up of the place; nothing where there is none.
    std::optional<Eigen::Vector3d> velocity(const Geodetic& place) const {
        const bool is_ecef = has(Column::velocity_xyz);
        if (!is_ecef && !has(Column::velocity_enu)) return std::nullopt;
        return turn(is_ecef, place) *
               three(is_ecef ? Column::velocity_xyz : Column::velocity_enu, "velocity");
    }
    /// The accuracy towards east, north, up of the place that the covariance from `ecef` on, or
    /// else from `enu` on, states.
    StatedAccuracy accuracy(Column enu, Column ecef, const Geodetic& place) const {
        const bool is_ecef = has(ecef);
        if (!is_ecef && !has(enu)) return {};
        const Eigen::Matrix3d stated = covariance(is_ecef ? ecef : enu);
        if (!is_ecef && !base_) return accuracy_from_covariance(stated);
        // Without the deviation of an axis none of the turned ones is known.
        if (stated.diagonal().minCoeff() <= 0.0) return {};
        const Eigen::Matrix3d turned = turn(is_ecef, place);
        return accuracy_from_covariance(turned * stated * turned.transpose());
    }
    void set_written(WrittenCells& written) const {
        if (layout_.coordinates == Column::latitude)
            written.unit = layout_.dms ? CoordinateUnit::arc_second : CoordinateUnit::degree;
        for (std::size_t i = 0; i < (layout_.coordinates == Column::x ? 3 : 2); ++i)
            written.coordinates[i] = cell(after(layout_.coordinates, i), layout_.dms ? 2 : 0).text;
    }

  private:
    Eigen::Matrix3d covariance(Column first) const {
        Eigen::Vector3d deviations, roots;
        for (const int i : {0, 1, 2}) {
            const Column column = after(first, static_cast<std::size_t>(i));
            const Cell& root = cell(after(column, 3));
            deviations(i) = read_deviation(cell(column), "standard deviation");
            roots(i) = read_real(root, "root of a covariance");
            if (std::abs(roots(i)) > 1e9)
                root.fail("the root of a covariance is above 1e9", as_written);
        }
        return covariance_from_rtklib(deviations, roots);
    }
    /// From the axes that the values of a row are along, those of the base for a baseline, into
    /// those of the place.
    Eigen::Matrix3d turn(bool is_ecef, const Geodetic& place) const {
        if (is_ecef) return rotation_enu_from_ecef(place.latitude, place.longitude);
        if (!base_) return Eigen::Matrix3d::Identity();
        return base_->rotation_from_local(place.latitude, place.longitude).transpose();
    }

    const Layout& layout_;
    const LocalFrame* base_;
};

TimedRow read_row(std::span<const Cell> cells, const Layout& layout, const LocalFrame* base) {
    const Fields fields(cells, layout, base);
    TimedRow row;
    const bool is_date = cells[0].text.find('/') != std::string_view::npos;
    row.instant = is_date ? read_calendar(cells[0], cells[1], layout.clock)
                          : read_week_time(cells[0], cells[1], layout.clock);
    row.written.time = cells[1].text;
    Observation& seen = row.observation;
    seen.fix = read_rtklib_quality(fields.cell(Column::quality));
    if (fields.has(Column::satellites))
        seen.satellites = read_satellites(fields.cell(Column::satellites));
    if (fields.has(Column::age)) seen.age_s = fields.real(Column::age, "age");
    if (fields.has(Column::ratio)) seen.ratio = fields.real(Column::ratio, "ratio");
    // RTKLIB has no position where Q is 0, and other programs then write zeros.
    if (seen.fix == FixType::none && fields.three(layout.coordinates, "position").isZero(0.0))
        return row;
    const Geodetic place = fields.position();
    set_position(seen, place);
    fields.set_written(row.written);
    static_cast<StatedAccuracy&>(seen) =
        fields.accuracy(Column::covariance_enu, Column::covariance_xyz, place);
    const auto velocity = fields.velocity(place);
    if (!velocity) return row;
    set_velocity(seen, velocity->x(), velocity->y());
    seen.recorded_velocity_up_m_s = velocity->z();
    const StatedAccuracy accuracy =
        fields.accuracy(Column::velocity_covariance_enu, Column::velocity_covariance_xyz, place);
    seen.sigma_recorded_velocity_east_m_s = accuracy.sigma_east_m;
    seen.sigma_recorded_velocity_north_m_s = accuracy.sigma_north_m;
    seen.sigma_recorded_velocity_up_m_s = accuracy.sigma_up_m;
    return row;
}

/// Whether a line begins as a row: a date and a time of day, or a week and its seconds, and
/// enough after them.
bool is_row_without_header(const SourceLine& line) {
    const RecordingBytes nameless;
    const auto fields = split_words(line, line.text, nameless);
    if (fields.size() < 14) return false;
    const std::string_view date = fields[0].text;
    const bool calendar = date.size() == 10 && date[4] == '/' && date[7] == '/' &&
                          fields[1].text.find(':') != std::string_view::npos;
    return (calendar || date.size() == 4) &&
           std::all_of(fields.begin() + (calendar ? 2 : 0), fields.end(),
                       [](const Cell& cell) { return parse_double(cell.text).has_value(); });
}

/// The columns of an Emlid Reach's .LLH, which has no header line (Emlid documentation, "Solution
/// formats": times are GPST).
constexpr std::string_view llh_columns =
    "% GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) "
    "sdun(m) age(s) ratio";

/// By the file's name: its rows do not say themselves in what time they are.
bool is_llh(const RecordingBytes& recording) {
    if (!lower_case(recording.name).ends_with(".llh")) return false;
    const auto first = LineReader(recording.bytes).next();
    return first && !first->text.starts_with('%');
}

/// Reads a recording line by line, header lines wherever they stand.
class SolutionReader {
  public:
    /// Holds the rows, or gives them to `take` where there is one.
    explicit SolutionReader(const RecordingBytes& recording, TakeRow take = {})
        : recording_(recording), lines_(recording), timed_(recording, std::move(take)) {}

    /// Of what read() read.
    const RowSummary& summary() const { return summary_; }

    Observations read() {
        if (is_llh(recording_)) read_columns({.text = llh_columns, .number = 1});
        while (const auto line = lines_.next()) {
            if (line->text.starts_with('%'))
                read_header_line(*line);
            else if (!trim(line->text).empty())
                read_row_line(*line);
        }
        if (!layout_) refuse_without_columns(1);
        if (other_headers_ > 0)
            observations_.notes.push_back(fmt::format(
                "The file holds {} solutions, one after the other.", other_headers_ + 1));
        if (inertial_)
            observations_.notes.push_back(
                "The header's mode names an inertial unit: positions are estimates of both, and "
                "between solutions predicted.");
        summary_ = timed_.summary();
        set_rows(observations_, std::move(timed_));
        return std::move(observations_);
    }

  private:
    [[noreturn]] void refuse_without_columns(std::int64_t line) const {
        throw Failure(
            place_in(recording_, line, 1),
            "the .pos has no header line that names the columns (\"%  GPST  latitude(deg) ...\")",
            "Export the solution again with its header (RTKLIB: out-outhead = on)");
    }

    void read_header_line(const SourceLine& line) {
        require_datum(line, recording_);
        const Entry entry = read_entry(line.text);
        if (!layout_) add_processing(entry, observations_.processing);
        if (entry.key == "ref pos") {
            base_.emplace(read_reference_position(entry.value, line, recording_));
            base_line_ = line.number;
        }
        // As GINav writes it: "% mode      : PPK/INS TC".
        if (entry.key == "mode" && entry.value.find("INS") != std::string_view::npos)
            inertial_ = true;
        if (is_column_line(line.text)) read_columns(line);
    }

    void read_columns(const SourceLine& line) {
        const Layout layout = read_column_line(line, recording_);
        const Cell start{line.text, &recording_, line.number, 1};
        if (layout_ && (layout_->clock != layout.clock ||
                        layout_->coordinates != layout.coordinates || layout_->dms != layout.dms))
            start.fail(
                "a second header has another time system or other coordinates than the first",
                "Give each solution to the program as a recording of its own");
        if (layout.coordinates == Column::east && !base_)
            start.fail("the positions are a baseline, and no line \"% ref pos\" says from where",
                       "Export the solution as latitude/longitude/height, or with RTKLIB's "
                       "processing options in its header");
        if (std::exchange(layout_, layout)) {
            ++other_headers_;
            return;
        }
        observations_.format = "rtklib-pos";
        observations_.frame = layout.coordinates == Column::latitude ? "geodetic" : "ecef";
        observations_.time_scale = layout.clock == Clock::gps ? "gps" : "utc";
        if (layout.clock == Clock::jst)
            observations_.notes.push_back(
                "Times are recorded in Japan Standard Time; 9 h were taken off for UTC.");
        if (!layout.passed_over.empty())
            observations_.notes.push_back(
                fmt::format("Columns that are not used: {}.", fmt::join(layout.passed_over, ", ")));
        if (layout.coordinates == Column::east)
            observations_.notes.push_back(fmt::format(
                "Positions are recorded as a baseline from the base station of line {}, and were "
                "added to its position.",
                base_line_));
    }

    void read_row_line(const SourceLine& line) {
        if (!layout_) refuse_without_columns(line.number);
        timed_.add_record(line, [&] {
            const std::vector<Cell> fields =
                split_words(line, line.text, recording_, layout_->separator);
            require_count(fields.size(), layout_->fields, line, recording_, lines_.at_end(),
                          "its header names", as_written);
            return read_row(fields, *layout_,
                            layout_->coordinates == Column::east ? &*base_ : nullptr);
        });
    }

    const RecordingBytes& recording_;
    LineReader lines_;
    std::optional<Layout> layout_;
    std::optional<LocalFrame> base_;
    std::int64_t base_line_ = 0;
    std::size_t other_headers_ = 0;
    bool inertial_ = false;
    Observations observations_;
    RowCollector timed_;
    RowSummary summary_;
};

/// Whether the bytes hold an RTKLIB column header line, or rows that look as if one were missing.
bool recognises(std::string_view bytes) {
    LineReader lines(bytes);
    bool header_lines_only = true;
    while (const auto line = lines.next()) {
        if (line->number > lines_to_recognise) break;
        if (is_column_line(line->text)) return true;
        if (line->text.starts_with('%') || trim(line->text).empty()) continue;
        if (header_lines_only && is_row_without_header(*line)) return true;
        header_lines_only = false;
    }
    return false;
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    Observations observations = SolutionReader(recording).read();
    apply_attempt(observations, receiver);
    note_text(observations, recording);
    return observations;
}

/// The same without holding its rows: the recording is read once for what they show as a whole, and
/// again when they are asked for.
StreamedRecording read_streamed(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    SolutionReader first_pass(recording, [](const Observation&) {});
    StreamedRecording result{
        .head = first_pass.read(), .rows = first_pass.summary().rows, .give = {}};
    const RowChanges changes = apply_attempt(result.head, first_pass.summary(), receiver);
    note_text(result.head, recording);
    result.give = [recording, changes, first = first_pass.summary().first](const TakeRow& take) {
        SolutionReader(recording, [&](Observation& row) {
            row.time.nanoseconds -= first.nanoseconds();
            changes.apply(row);
            take(row);
        }).read();
    };
    return result;
}

}  // namespace

extern const Format format{
    .name = "rtklib-pos",
    .what = "RTKLIB solution, .pos, and Emlid's .LLH",
    .place = 10,
    .stamps_satellite_time = true,
    .time_origin = "GPS time of the receiver's measurements, as RTKLIB solved it",
    .recognises = recognises,
    .read = read,
    .read_streamed = read_streamed,
};

}  // namespace runcert::rtklib_pos
