#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/angle.h"
#include "core/text.h"
#include "stages/import/vbo/vbo.h"

namespace runcert::vbo {
namespace {

constexpr double enough_way_m = 100.0;
constexpr double least_agreement = 0.5;  // three quarters for it less one against
constexpr double least_speed_m_s = 2.0;
constexpr double longest_step_m = 200.0;
constexpr double longest_step_s = 1.5;
constexpr double least_way_m = 3000.0;  // along both axes, on most courses
/// Logarithms of a ratio of ways: a quarter; and what tells packed degrees from minutes.
constexpr double most_misfit = 0.22;
constexpr double clear_misfit = 0.06;
/// Nearer to a pole, where minutes put packed degrees from 48 on, packed ones are likelier.
constexpr double polar_latitude_deg = 80.0;
constexpr double metres_per_degree = 111'320.0;

/// A place as recorded, longitudes counting in whichever sense.
struct Place {
    double latitude_deg;
    double longitude_deg;
};

std::optional<Place> place_of(const Row& fields, Coordinates coordinates) {
    const auto latitude = parse_double(fields.text(Column::latitude));
    const auto longitude = parse_double(fields.text(Column::longitude));
    if (!latitude || !longitude || (*latitude == 0.0 && *longitude == 0.0)) return std::nullopt;
    const auto latitude_deg = degrees_of(*latitude, coordinates);
    const auto longitude_deg = degrees_of(*longitude, coordinates);
    if (!latitude_deg || !longitude_deg || std::abs(*latitude_deg) > 90.0 ||
        std::abs(*longitude_deg) > 360.0)
        return std::nullopt;
    return Place{*latitude_deg, *longitude_deg};
}

std::optional<double> speed_of(const Row& fields, const Layout& layout) {
    if (!layout.velocity_m_s) return std::nullopt;
    const auto velocity = parse_double(fields.text(Column::velocity));
    if (!velocity) return std::nullopt;
    return *velocity * *layout.velocity_m_s;
}

/// The eastward part of the unit vector along the heading; nothing where the craft hardly moves.
std::optional<double> eastward_of(const Row& fields, const Layout& layout) {
    const auto speed_m_s = speed_of(fields, layout);
    const auto heading_deg = parse_double(fields.text(Column::heading));
    if (!speed_m_s || !heading_deg || !(*speed_m_s >= least_speed_m_s)) return std::nullopt;
    return std::sin(std::fmod(*heading_deg, 360.0) * radians_per_degree);
}

/// Gathers the way along growing longitudes, and how much of it the headings call eastward.
class Headings {
  public:
    void add(const Place& from, const Place& to, double eastward) {
        const double step_m = (to.longitude_deg - from.longitude_deg) * metres_per_degree *
                              std::cos(to.latitude_deg * radians_per_degree);
        if (!(std::abs(step_m) <= longest_step_m)) return;
        agreeing_m_ += step_m * eastward;
        way_m_ += std::abs(step_m * eastward);
    }

    LongitudeSense sense() const {
        if (way_m_ < enough_way_m) return LongitudeSense::assumed_west;
        if (agreeing_m_ >= least_agreement * way_m_) return LongitudeSense::east_positive;
        if (agreeing_m_ <= -least_agreement * way_m_) return LongitudeSense::west_positive;
        return LongitudeSense::assumed_west;
    }

  private:
    double agreeing_m_ = 0.0, way_m_ = 0.0;
};

/// The way that coordinates make where they are written in one of the kinds.
struct Candidate {
    Coordinates coordinates;
    std::size_t rows = 0, impossible = 0;
    std::size_t leaps = 0;  ///< steps that no craft makes, as of minutes from 8759.9 to 8800.0
    double way_m = 0.0;
    double highest_latitude_deg = 0.0;
    double highest_longitude_deg = 0.0;
    std::optional<Place> before = {};

    /// Logarithm of the way over that of the speeds.
    double misfit(double recorded_m) const { return std::abs(std::log(way_m / recorded_m)); }
    /// Some rows may be damaged: of what the header says half, of anything else a fiftieth.
    bool possible(bool stated) const { return (stated ? 2 : 50) * impossible <= rows; }
    bool fits(double recorded_m, bool stated) const {
        return possible(stated) && misfit(recorded_m) < most_misfit;
    }
};

/// Ways of the candidates and of the recorded speeds, over the beginning of the rows.
class Ways {
  public:
    void add(const Row& fields, const Layout& layout) {
        const auto time_ns = time_of_day_ns(fields.text(Column::time));
        const auto speed_m_s = speed_of(fields, layout);
        const double step_s =
            time_ns && before_ns_ ? static_cast<double>(*time_ns - *before_ns_) * 1e-9 : 0.0;
        const bool moves =
            speed_m_s && *speed_m_s >= least_speed_m_s && step_s > 0.0 && step_s <= longest_step_s;
        if (moves) recorded_m_ += *speed_m_s * step_s;
        for (Candidate& each : candidates_)
            add(fields, moves, each);
        before_ns_ = time_ns;
    }

    bool is_enough() const { return recorded_m_ >= least_way_m; }

    /// Fills in what the ways show of coordinates that the header says to be `stated`.
    void decide(Coordinates stated, Survey& result) const {
        const Candidate& said = of(stated);
        const Candidate& packed = of(Coordinates::packed);
        result.coordinates = stated;
        if (!(recorded_m_ >= enough_way_m)) {
            result.coordinates = without_speeds(stated);
            return;
        }
        const Candidate* best = &said;
        for (const Candidate& each : candidates_)
            if (each.fits(recorded_m_, &each == &said) && !best->fits(recorded_m_, best == &said))
                best = &each;
        const bool polar = said.highest_latitude_deg > polar_latitude_deg;
        if (best == &said && stated == Coordinates::minutes && packed.fits(recorded_m_, false) &&
            (polar || packed.leaps < said.leaps ||
             packed.misfit(recorded_m_) + clear_misfit < said.misfit(recorded_m_)))
            best = &packed;
        result.speeds_fit = best->fits(recorded_m_, best == &said);
        result.misfit = best->misfit(recorded_m_);
        result.coordinates = *result.speeds_fit ? best->coordinates : without_speeds(stated);
        result.coordinates_by_speeds = *result.speeds_fit;
    }

  private:
    static void add(const Row& fields, bool moves, Candidate& each) {
        const auto latitude = parse_double(fields.text(Column::latitude));
        const auto longitude = parse_double(fields.text(Column::longitude));
        if (!latitude || !longitude || (*latitude == 0.0 && *longitude == 0.0)) return;
        const auto here = place_of(fields, each.coordinates);
        ++each.rows;
        each.impossible += here ? 0 : 1;
        if (here) {
            each.highest_latitude_deg =
                std::max(each.highest_latitude_deg, std::abs(here->latitude_deg));
            each.highest_longitude_deg =
                std::max(each.highest_longitude_deg, std::abs(here->longitude_deg));
        }
        if (moves && here && each.before) {
            const double step_m = metres_per_degree *
                                  std::hypot(here->latitude_deg - each.before->latitude_deg,
                                             (here->longitude_deg - each.before->longitude_deg) *
                                                 std::cos(here->latitude_deg * radians_per_degree));
            if (step_m <= longest_step_m)
                each.way_m += step_m;
            else
                ++each.leaps;
        }
        each.before = here;
    }

    const Candidate& of(Coordinates coordinates) const {
        return candidates_[static_cast<std::size_t>(coordinates)];
    }

    Coordinates without_speeds(Coordinates stated) const {
        const Candidate& minutes = of(Coordinates::minutes);
        const bool at_zero =
            minutes.highest_latitude_deg <= 1.5 && minutes.highest_longitude_deg <= 3.0;
        if (stated == Coordinates::minutes && at_zero && of(Coordinates::degrees).possible(false))
            return Coordinates::degrees;
        if (of(stated).possible(true)) return stated;
        for (const Candidate& each : candidates_)
            if (each.possible(false)) return each.coordinates;
        return stated;
    }

    std::array<Candidate, 3> candidates_{
        {{Coordinates::minutes}, {Coordinates::degrees}, {Coordinates::packed}}};
    double recorded_m_ = 0.0;
    std::optional<std::int64_t> before_ns_;
};

/// Calls `look` with each row that has as many fields as the layout, until it says so.
template <class Look>
void each_row(LineReader lines, const RecordingBytes& recording, const Layout& layout,
              const Look& look) {
    while (const auto line = lines.next()) {
        const std::vector<Cell> cells = split(*line, recording);
        if (cells.size() == layout.fields && look(Row(cells, layout))) return;
    }
}

}  // namespace

Survey survey(const LineReader& lines, const RecordingBytes& recording, const Layout& layout) {
    Survey result;
    Ways ways;
    each_row(lines, recording, layout, [&](const Row& fields) {
        ways.add(fields, layout);
        return ways.is_enough();
    });
    ways.decide(layout.coordinates, result);
    Headings headings;
    std::optional<Place> first, before;
    each_row(lines, recording, layout, [&](const Row& fields) {
        if (!result.first_time_ns) result.first_time_ns = time_of_day_ns(fields.text(Column::time));
        const std::optional<Place> here = place_of(fields, result.coordinates);
        if (!first) first = here;
        if (const auto eastward = eastward_of(fields, layout); eastward && before && here)
            headings.add(*before, *here, *eastward);
        before = here;
        result.longitudes = headings.sense();
        return result.first_time_ns && result.longitudes != LongitudeSense::assumed_west;
    });
    if (first)
        result.first_longitude_deg = result.longitudes == LongitudeSense::east_positive
                                         ? first->longitude_deg
                                         : -first->longitude_deg;
    return result;
}

std::string coordinates_note(const Survey& survey, const Layout& layout) {
    if (survey.coordinates == layout.coordinates) return {};
    constexpr std::array<std::string_view, 3> words{"minutes of arc", "decimal degrees",
                                                    "degrees and minutes (DDMM.MMMM)"};
    const auto word = [&](Coordinates coordinates) {
        return words[static_cast<std::size_t>(coordinates)];
    };
    return fmt::format("Coordinates were taken as {}, not as {}: {}.", word(survey.coordinates),
                       word(layout.coordinates),
                       survey.coordinates_by_speeds
                           ? "the recorded speeds fit the positions so"
                           : "the positions lie so on the Earth, and no speeds confirm it");
}

std::string longitude_note(LongitudeSense sense, double latitude_deg, double longitude_deg) {
    const std::string place = fmt::format(
        "{} {}, {} {}", format_fixed(std::abs(latitude_deg), 5), latitude_deg < 0.0 ? "S" : "N",
        format_fixed(std::abs(longitude_deg), 5), longitude_deg < 0.0 ? "W" : "E");
    switch (sense) {
        case LongitudeSense::west_positive:
            return fmt::format(
                "Longitudes are recorded positive to the west, as the headings "
                "confirm; the first position is {}.",
                place);
        case LongitudeSense::east_positive:
            return fmt::format(
                "Longitudes are recorded positive to the east, as the headings "
                "show, though the format has them positive to the west; the first "
                "position is {}.",
                place);
        case LongitudeSense::assumed_west:
            break;
    }
    return fmt::format(
        "Longitudes were taken as positive to the west, the rule of the format, which nothing in "
        "the recording confirms: look whether the first position, {}, is on the right side of the "
        "world.",
        place);
}

}  // namespace runcert::vbo
