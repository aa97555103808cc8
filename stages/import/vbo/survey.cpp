#include <algorithm>
#include <array>
#include <cmath>

#include "core/angle.h"
#include "core/text.h"
#include "stages/import/clock.h"
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

/// The way that coordinates make where they are written in one of the kinds.
struct Candidate {
    Coordinates coordinates;
    bool stated = false;  ///< by the header, or the rule of the format
    std::size_t rows = 0, impossible = 0;
    std::size_t leaps = 0;  ///< steps that no craft makes, as of minutes from 8759.9 to 8800.0
    double way_m = 0.0;
    double highest_latitude_deg = 0.0, highest_longitude_deg = 0.0;
    /// Along longitudes, and how much of it the headings call eastward where these grow.
    double headed_m = 0.0, agreeing_m = 0.0;
    std::optional<bool> east_positive = {};
    std::optional<Place> first = {}, before = {};

    /// Some rows may be damaged: of what the header says half, of anything else a fiftieth.
    bool is_possible() const { return (stated ? 2 : 50) * impossible <= rows; }
    /// Logarithm of the way over that of the speeds.
    double misfit(double recorded_m) const { return std::abs(std::log(way_m / recorded_m)); }
    bool fits(double recorded_m) const {
        return recorded_m >= enough_way_m && is_possible() && misfit(recorded_m) < most_misfit;
    }

    /// Takes in a place as written. `moves`: the step from the row before is one of the way;
    /// `eastward`: the part of the unit vector along the heading, 0 where there is none.
    void add(double latitude, double longitude, bool moves, double eastward) {
        const auto latitude_deg = degrees_of(latitude, coordinates);
        const auto longitude_deg = degrees_of(longitude, coordinates);
        std::optional<Place> here;
        if (latitude_deg && longitude_deg && std::abs(*latitude_deg) <= 90.0 &&
            std::abs(*longitude_deg) <= 360.0)
            here = {*latitude_deg, *longitude_deg};
        const std::optional<Place> from = std::exchange(before, here);
        ++rows;
        impossible += here ? 0 : 1;
        if (!here) return;
        if (!first) first = here;
        highest_latitude_deg = std::max(highest_latitude_deg, std::abs(here->latitude_deg));
        highest_longitude_deg = std::max(highest_longitude_deg, std::abs(here->longitude_deg));
        if (!from) return;
        const double north_m = metres_per_degree * (here->latitude_deg - from->latitude_deg);
        const double east_m = metres_per_degree * (here->longitude_deg - from->longitude_deg) *
                              std::cos(here->latitude_deg * radians_per_degree);
        const double step_m = std::hypot(north_m, east_m);
        if (moves && step_m <= longest_step_m) way_m += step_m;
        if (moves && step_m > longest_step_m) ++leaps;
        if (east_positive || std::abs(east_m) > longest_step_m) return;
        headed_m += std::abs(east_m * eastward);
        agreeing_m += east_m * eastward;
        if (headed_m >= enough_way_m && std::abs(agreeing_m) >= least_agreement * headed_m)
            east_positive = agreeing_m > 0.0;
    }
};

/// Ways of the candidates and of the recorded speeds, over the beginning of the rows.
class Ways {
  public:
    explicit Ways(const Layout& layout)
        : layout_(layout),
          candidates_{{{layout.coordinates, true},
                       {layout.coordinates == Coordinates::degrees ? Coordinates::minutes
                                                                   : Coordinates::degrees},
                       {Coordinates::packed}}} {}

    void add(const Row& fields) {
        const auto time_ns = time_of_day_ns(fields.text(Column::time));
        const auto velocity = parse_double(fields.text(Column::velocity));
        const double speed_m_s = velocity ? *velocity * *layout_.velocity_m_s : 0.0;
        const double step_s =
            time_ns && before_ns_ ? static_cast<double>(*time_ns - *before_ns_) * 1e-9 : 0.0;
        const bool runs = speed_m_s >= least_speed_m_s;
        const bool moves =
            runs && step_s > 0.0 && step_s <= longest_step_s && recorded_m_ < least_way_m;
        if (moves) recorded_m_ += speed_m_s * step_s;
        before_ns_ = time_ns;
        if (!first_ns_) first_ns_ = time_ns;
        const auto latitude = parse_double(fields.text(Column::latitude));
        const auto longitude = parse_double(fields.text(Column::longitude));
        if (!latitude || !longitude || (*latitude == 0.0 && *longitude == 0.0)) return;
        const auto heading_deg = parse_double(fields.text(Column::heading));
        const double eastward = runs && heading_deg
                                    ? std::sin(std::fmod(*heading_deg, 360.0) * radians_per_degree)
                                    : 0.0;
        for (Candidate& each : candidates_)
            each.add(*latitude, *longitude, moves, eastward);
    }

    bool is_enough() const {
        return recorded_m_ >= least_way_m && first_ns_ && best().east_positive;
    }

    Survey result() const {
        const Candidate& chosen = best();
        const double sign = chosen.east_positive.value_or(false) ? 1.0 : -1.0;
        Survey result{chosen.coordinates,   {}, chosen.misfit(recorded_m_), first_ns_,
                      chosen.east_positive, {}};
        if (recorded_m_ >= enough_way_m) result.speeds_fit = chosen.fits(recorded_m_);
        if (chosen.first) result.first_longitude_deg = sign * chosen.first->longitude_deg;
        return result;
    }

  private:
    /// By the speeds; without them, by what the places can be.
    const Candidate& best() const {
        const auto& [said, other, packed] = candidates_;
        const bool by_rule = said.coordinates == Coordinates::minutes;
        const bool rather_packed =
            by_rule && packed.fits(recorded_m_) &&
            (said.highest_latitude_deg > polar_latitude_deg || packed.leaps < said.leaps ||
             packed.misfit(recorded_m_) + clear_misfit < said.misfit(recorded_m_));
        for (const Candidate& each : candidates_)
            if (each.fits(recorded_m_)) return &each == &said && rather_packed ? packed : each;
        const bool at_zero = said.highest_latitude_deg <= 1.5 && said.highest_longitude_deg <= 3.0;
        if (by_rule && at_zero && other.is_possible()) return other;
        for (const Candidate& each : candidates_)
            if (each.is_possible()) return each;
        return said;
    }

    const Layout& layout_;
    std::array<Candidate, 3> candidates_;  ///< the stated one first, packed degrees last
    double recorded_m_ = 0.0;              ///< up to least_way_m, or one step more
    std::optional<std::int64_t> first_ns_, before_ns_;
};

}  // namespace

std::optional<double> degrees_of(double written, Coordinates coordinates) {
    if (coordinates == Coordinates::degrees) return written;
    if (coordinates == Coordinates::minutes) return written / 60.0;
    const double degrees = std::trunc(written / 100.0);
    const double minutes = written - 100.0 * degrees;
    if (std::abs(minutes) >= 60.0) return std::nullopt;
    return degrees + minutes / 60.0;
}

std::optional<std::int64_t> time_of_day_ns(std::string_view text) {
    std::size_t whole = std::min(text.find('.'), text.size());
    std::string time(text);
    if (whole == 8 && text[2] == ':' && text[5] == ':') {
        time.erase(5, 1).erase(2, 1);
        whole = 6;
    }
    if (whole == 0 || whole > 6) return std::nullopt;
    return nanoseconds_of_day(time.insert(0, 6 - whole, '0'));
}

Survey survey(LineReader lines, const RecordingBytes& recording, const Layout& layout) {
    Ways ways(layout);
    for (auto line = lines.next(); line && !ways.is_enough(); line = lines.next()) {
        const std::vector<Cell> cells = split(*line, recording);
        if (cells.size() == layout.fields) ways.add(Row(cells, layout));
    }
    return ways.result();
}

}  // namespace runcert::vbo
