#include "stages/import/vbo/survey.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/text.h"
#include "stages/import/vbo/row.h"

namespace runcert::vbo {
namespace {

constexpr double enough_way_m = 100.0;
constexpr double least_agreement = 0.5;  // three quarters for it less one against
constexpr double least_speed_m_s = 2.0;
constexpr double longest_step_m = 200.0;
constexpr double metres_per_degree = 111'320.0;
constexpr double radians_per_degree = std::numbers::pi / 180.0;

/// A place as recorded, longitudes counting in whichever sense.
struct Place {
    double latitude_deg;
    double longitude_deg;
};

std::optional<Place> place_of(const Row& fields, const Layout& layout) {
    const auto latitude = parse_double(fields.text(Column::latitude));
    const auto longitude = parse_double(fields.text(Column::longitude));
    if (!latitude || !longitude || (*latitude == 0.0 && *longitude == 0.0)) return std::nullopt;
    const double per_degree = layout.coordinates == CoordinateUnit::degree ? 1.0 : 60.0;
    const Place place{*latitude / per_degree, *longitude / per_degree};
    if (std::abs(place.latitude_deg) > 90.0 || std::abs(place.longitude_deg) > 360.0)
        return std::nullopt;
    return place;
}

/// The eastward part of the unit vector along the heading; nothing where the craft hardly moves.
std::optional<double> eastward_of(const Row& fields, const Layout& layout) {
    if (!layout.velocity_m_s) return std::nullopt;
    const auto velocity = parse_double(fields.text(Column::velocity));
    const auto heading_deg = parse_double(fields.text(Column::heading));
    if (!velocity || !heading_deg || !(*velocity * *layout.velocity_m_s >= least_speed_m_s))
        return std::nullopt;
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

}  // namespace

Survey survey(LineReader lines, const RecordingBytes& recording, const Layout& layout) {
    Survey result;
    Headings headings;
    std::optional<Place> first, before;
    while (const auto line = lines.next()) {
        const std::vector<Cell> cells = split(*line, recording);
        if (cells.size() != layout.fields) continue;
        const Row fields(cells, layout);
        if (!result.first_time_ns) result.first_time_ns = time_of_day_ns(fields.text(Column::time));
        const std::optional<Place> here = place_of(fields, layout);
        if (!first) first = here;
        if (const auto eastward = eastward_of(fields, layout); eastward && before && here)
            headings.add(*before, *here, *eastward);
        before = here;
        result.longitudes = headings.sense();
        if (result.first_time_ns && result.longitudes != LongitudeSense::assumed_west) break;
    }
    if (first)
        result.first_longitude_deg = result.longitudes == LongitudeSense::east_positive
                                         ? first->longitude_deg
                                         : -first->longitude_deg;
    return result;
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
