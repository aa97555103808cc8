#include <fmt/format.h>

#include <array>

#include "core/geodesy.h"
#include "stages/import/cell.h"
#include "stages/import/earth.h"
#include "stages/import/format.h"

/// The text that Septentrio's sbf2asc makes of SBF: rows whose first field says what they are
/// (Septentrio, sbf2asc, its usage text; PVT modes: mosaic-X5 Reference Guide, PVTGeodetic).
/// Positions are the rows -1, PVTGeodetic; where there are none, the rows 0, PVTCartesian.
namespace runcert::septentrio {
namespace {

/// A block of a solution, and its fields counted from 0.
struct Block {
    std::string_view row;  ///< its first field
    std::string_view name;
    bool is_geodetic;  ///< latitude, longitude, height and north, east, up; else Earth-centred
    std::size_t position, velocity, satellites, fields;
};

constexpr std::size_t seconds = 1;
constexpr Block geodetic{"-1", "PVTGeodetic", true, 2, 6, 11, 16};
constexpr Block cartesian{"0", "PVTCartesian", false, 2, 5, 10, 15};
/// Behind the satellites.
constexpr std::size_t mode_behind = 1, age_behind = 2, error_behind = 3;

constexpr double no_value = -2e10;
constexpr std::int64_t no_age = 65535;
constexpr double degrees_per_written_step = Angle::from_radians(1e-11).degrees();

bool is_row(std::string_view line, const Block& block) {
    return line.starts_with(block.row) &&
           line.substr(block.row.size()).starts_with(block.row == "0" ? "  " : " ");
}

/// By the mode of a solution. 3 is of a base whose position is given: its rows are still
/// measurements.
constexpr std::array<FixType, 16> fix_of_mode{
    FixType::none,    FixType::single,  FixType::dgps,
    FixType::single,  FixType::fixed,   FixType::float_ambiguities,
    FixType::sbas,    FixType::fixed,   FixType::float_ambiguities,
    FixType::unknown, FixType::ppp,     FixType::unknown,
    FixType::unknown, FixType::unknown, FixType::unknown,
    FixType::unknown};

FixType read_mode(const Cell& cell) {
    return fix_of_mode[static_cast<std::size_t>(read_whole(cell, "PVT mode", 0, 255) & 15)];
}

class Sbf2ascReader {
  public:
    Sbf2ascReader(const RecordingBytes& recording, const Block& block)
        : recording_(recording),
          block_(block),
          timed_(recording,
                 block.is_geodetic
                     ? WrittenResolution(CoordinateUnit::degree, degrees_per_written_step, 0.01)
                     : WrittenResolution(CoordinateUnit::metre, 1e-3, 0.01)) {}

    Observations read() {
        LineReader lines(recording_);
        while (const auto line = lines.next())
            if (is_row(line->text, block_))
                timed_.add_record(RecordPlace(*line), [&] { return read_row(*line); });
        Observations observations =
            empty_observations("septentrio", block_.is_geodetic ? "geodetic" : "ecef", "gps");
        observations.variant = block_.name;
        set_rows(observations, std::move(timed_));
        observations.notes.push_back(
            fmt::format("Positions are those of the block {}.", block_.name));
        return observations;
    }

  private:
    TimedRow read_row(const SourceLine& line) {
        const std::vector<Cell> cells = split_words(line, line.text, recording_);
        if (cells.size() != block_.fields)
            cells.front().fail(fmt::format("the row has {} fields; those of {} have {}",
                                           cells.size(), block_.name, block_.fields),
                               "Take the text as sbf2asc wrote it");
        TimedRow row;
        row.instant = GpsTime().plus_nanoseconds(read_nanoseconds(cells[seconds], "time"));
        row.observation.satellites = read_satellites(cells[block_.satellites]);
        row.observation.fix = read_mode(cells[block_.satellites + mode_behind]);
        if (read_whole(cells[block_.satellites + error_behind], "PVT error", 0, 255) != 0)
            row.observation.fix = FixType::none;
        if (row.observation.fix == FixType::none) return row;
        set_place(row.observation, cells);
        const std::int64_t age =
            read_whole(cells[block_.satellites + age_behind], "age of corrections", 0, no_age);
        if (age != no_age) row.observation.age_s = static_cast<double>(age) * 0.01;
        return row;
    }

    static std::optional<Eigen::Vector3d> three(const std::vector<Cell>& cells, std::size_t first,
                                                std::string_view meaning) {
        Eigen::Vector3d values;
        for (std::size_t i = 0; i < 3; ++i) {
            values[static_cast<int>(i)] = read_real(cells[first + i], meaning);
            if (values[static_cast<int>(i)] == no_value) return std::nullopt;
        }
        return values;
    }

    void set_place(Observation& row, const std::vector<Cell>& cells) const {
        const auto place = three(cells, block_.position, "position");
        if (!place) {
            row.fix = FixType::none;
            return;
        }
        const Cell& first = cells[block_.position];
        const Geodetic position =
            block_.is_geodetic
                ? checked_geodetic({.latitude = Angle::from_radians((*place)[0]),
                                    .longitude = Angle::from_radians((*place)[1]),
                                    .height_m = (*place)[2]},
                                   first, cells[block_.position + 1], cells[block_.position + 2])
                : checked_ecef(*place, first);
        set_position(row, position);
        auto velocity = three(cells, block_.velocity, "velocity");
        if (!velocity) return;
        if (block_.is_geodetic)
            velocity = Eigen::Vector3d((*velocity)[1], (*velocity)[0], (*velocity)[2]);
        else
            velocity = rotation_enu_from_ecef(position.latitude, position.longitude) * *velocity;
        set_velocity(row, (*velocity)[0], (*velocity)[1]);
        row.recorded_velocity_up_m_s = (*velocity)[2];
    }

    const RecordingBytes& recording_;
    const Block& block_;
    RowCollector timed_;
};

/// The block whose row a line is; null where it is no row.
const Block* block_of(std::string_view line) {
    if (is_row(line, geodetic)) return &geodetic;
    return is_row(line, cartesian) ? &cartesian : nullptr;
}

/// The block that positions are taken from; null where there is none.
const Block* find_block(std::string_view bytes) {
    const Block* found = nullptr;
    LineReader lines(bytes);
    while (const auto line = lines.next())
        if (const Block* block = block_of(line->text)) {
            if (block->is_geodetic) return block;
            found = block;
        }
    return found;
}

/// Whether one of the lines is a row of a solution: its fields, and seconds of the GPS era with two
/// decimals.
bool recognises(std::string_view bytes) {
    const RecordingBytes unnamed{.name = {}, .bytes = bytes};
    LineReader lines(bytes);
    while (const auto line = lines.next()) {
        const Block* block = block_of(line->text);
        if (!block) continue;
        try {
            const auto cells = split_words(*line, line->text, unnamed);
            if (cells.size() != block->fields) continue;
            const std::string_view time = cells[seconds].text;
            if (time.size() == 13 && time[10] == '.' && digits_at(time, 0, 9)) return true;
        } catch (const Failure&) {
            continue;
        }
    }
    return false;
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    const Block* block = find_block(recording.bytes);
    if (!block)
        throw Failure(place_in(recording, RecordPlace(std::size_t{0})),
                      "the text has no rows of PVTGeodetic (-1) or PVTCartesian (0)",
                      "Convert the SBF file with: sbf2asc -g -f FILE -o run.asc");
    Observations observations = Sbf2ascReader(recording, *block).read();
    apply_attempt(observations, receiver);
    note_text(observations, recording);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "septentrio",
    .what = "Septentrio sbf2asc text",
    .place = 37,
    .stamps_satellite_time = true,
    .time_origin = "GPS time of the receiver's solutions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::septentrio
