#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/decimal.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/nmea/epoch.h"

namespace runcert::nmea {
namespace {

constexpr const char* as_written = "Take the recording as the receiver wrote it";

[[noreturn]] void refuse_date(const Cell& cell) {
    cell.fail(fmt::format("\"{}\" is not a date", escape_for_message(cell.text)), as_written);
}

constexpr double largest_speed = 1e5;
constexpr double largest_height_m = 1e6;
constexpr double largest_sigma_m = 1e9;

/// The day of "ddmmyy", counted from 1980-01-06; years 80 to 99 are 1980 to 1999.
std::int64_t read_date(const Cell& cell) {
    const auto day = digits_at(cell.text, 0, 2);
    const auto month = digits_at(cell.text, 2, 2);
    const auto year = digits_at(cell.text, 4, 2);
    if (cell.text.size() != 6 || !day || !month || !year) refuse_date(cell);
    const auto found = day_number(*year + (*year >= 80 ? 1900 : 2000), *month, *day);
    if (!found) refuse_date(cell);
    return *found;
}

/// The angle of "ddmm.mmmm" or "dddmm.mmmm", with any decimals, rounded once; `positive` and
/// `negative` are the letters of its hemispheres. From 0 to `most_degrees` either way.
Angle read_angle(const Cell& cell, const Cell& hemisphere, char positive, char negative,
                 int most_degrees) {
    const std::size_t point = std::min(cell.text.find('.'), cell.text.size());
    // Further decimals of a minute are less than a picometre.
    constexpr std::size_t decimals_used = 12;
    const bool is_plain =
        point > 0 && point <= (most_degrees > 90 ? 5 : 4) && is_digit(cell.text[0]) &&
        cell.text.find_first_not_of("0123456789", point + 1) == std::string_view::npos;
    const auto number = is_plain
                            ? read_plain_decimal(cell.text.substr(0, point + 1 + decimals_used))
                            : std::nullopt;
    const std::uint64_t scale =
        number ? static_cast<std::uint64_t>(
                     exact_powers_of_ten[static_cast<std::size_t>(number->decimals)])
               : 1;
    const std::uint64_t degrees = number ? number->digits / scale / 100 : 0;
    const std::uint64_t minutes = number ? number->digits / scale % 100 : 60;
    if (minutes >= 60 || degrees > static_cast<std::uint64_t>(most_degrees))
        cell.fail(fmt::format("\"{}\" is not an angle, degrees and minutes as {}mm.mmmm",
                              escape_for_message(cell.text), most_degrees > 90 ? "ddd" : "dd"),
                  as_written);
    const bool north_or_east = hemisphere.text.size() == 1 && hemisphere.text[0] == positive;
    if (!north_or_east && !(hemisphere.text.size() == 1 && hemisphere.text[0] == negative))
        hemisphere.fail(fmt::format("the hemisphere is \"{}\", not {} or {}",
                                    escape_for_message(hemisphere.text), positive, negative),
                        as_written);
    // A quotient of whole numbers below 2^53, where the minutes have at most eleven decimals.
    const std::uint64_t scaled_minutes = number->digits - 40 * degrees * scale;
    const double magnitude_deg =
        static_cast<double>(scaled_minutes) / (60.0 * static_cast<double>(scale));
    return Angle::from_degrees(north_or_east ? magnitude_deg : -magnitude_deg);
}

/// An empty cell is an unknown number. Anything outside `least` to `most` fails.
WrittenNumber read_written(const Cell& cell, std::string_view meaning, double least, double most) {
    if (cell.text.empty()) return {};
    const double value = read_real(cell, meaning);
    if (!(value >= least && value <= most))
        cell.fail(fmt::format("the {} {} is not from {} to {}", meaning,
                              escape_for_message(cell.text), least, most),
                  as_written);
    const std::size_t point = std::min(cell.text.find('.'), cell.text.size() - 1);
    const std::size_t decimals = std::min(cell.text.size() - point - 1, std::size_t{9});
    return {value, 1.0 / exact_powers_of_ten[decimals]};
}

/// The fix type of GGA's quality, 0 to 9; unknown for an empty one. 3 is PPS: the precise code,
/// without corrections.
FixType read_quality(const Cell& cell) {
    constexpr FixType kinds[] = {FixType::none,          FixType::single,
                                 FixType::dgps,          FixType::single,
                                 FixType::fixed,         FixType::float_ambiguities,
                                 FixType::dead_reckoning};
    if (cell.text.empty()) return FixType::unknown;
    const auto quality = static_cast<std::size_t>(read_whole(cell, "quality", 0, 9));
    return quality < std::size(kinds) ? kinds[quality] : FixType::unknown;
}

/// The letters of the mode indicator (NMEA 0183 version 2.3 on), the best one first.
constexpr std::pair<char, FixType> modes[] = {
    {'R', FixType::fixed},  {'F', FixType::float_ambiguities},
    {'D', FixType::dgps},   {'P', FixType::single},
    {'A', FixType::single}, {'E', FixType::dead_reckoning},
    {'N', FixType::none}};

/// The fix type of the best of the systems' modes; unknown where they have other letters.
FixType best_of_modes(std::string_view systems) {
    for (const auto& [letter, fix] : modes)
        if (systems.find(letter) != std::string_view::npos) return fix;
    return FixType::unknown;
}

/// Reads latitude and longitude of four fields from `first` on, and a height above the ellipsoid
/// that is known to be in the last cell where it is impossible.
void read_position(const Sentence& sentence, std::size_t first, double height_m, const Cell& height,
                   Solution& solution) {
    if (sentence[first].empty() && sentence[first + 2].empty()) return;
    const Cell latitude = sentence.cell(first), longitude = sentence.cell(first + 2);
    const Geodetic position{
        .latitude = read_angle(latitude, sentence.cell(first + 1), 'N', 'S', 90),
        .longitude = read_angle(longitude, sentence.cell(first + 3), 'E', 'W', 180),
        .height_m = height_m};
    solution.position = checked_geodetic(position, latitude, longitude, height);
    solution.coordinates = {latitude.text, longitude.text};
}

void require_metres(const Cell& unit) {
    if (!unit.text.empty() && unit.text != "M")
        unit.fail(
            fmt::format("the unit is \"{}\", not M for metres", escape_for_message(unit.text)),
            as_written);
}

/// A position with its height, of an altitude above mean sea level and the geoid's separation.
void read_position_and_height(const Sentence& sentence, std::size_t first, std::size_t altitude,
                              std::size_t separation, Solution& solution) {
    const Cell cell = sentence.cell(altitude);
    const WrittenNumber above_geoid_m =
        read_written(cell, "altitude", -largest_height_m, largest_height_m);
    const WrittenNumber separation_m = read_written(sentence.cell(separation), "geoid separation",
                                                    -largest_height_m, largest_height_m);
    solution.has_height = above_geoid_m.value.has_value();
    solution.above_sea_level = solution.has_height && !separation_m.value;
    solution.separation_m = separation_m.value;
    read_position(sentence, first,
                  above_geoid_m.value.value_or(0.0) + separation_m.value.value_or(0.0), cell,
                  solution);
}

void read_corrections(const Sentence& sentence, std::size_t satellites, std::size_t age,
                      Solution& solution) {
    if (!sentence[satellites].empty())
        solution.satellites = read_satellites(sentence.cell(satellites));
    solution.age_s = read_written(sentence.cell(age), "age of corrections", 0.0, 1e6).value;
}

Solution begin_solution(const Sentence& sentence, FixType fix) {
    Solution solution;
    solution.given = true;
    solution.place = sentence.line;
    solution.fix = fix;
    return solution;
}

/// A (valid), V (not), or empty, which receivers write that have never had a position.
bool rmc_is_valid(const Sentence& rmc) {
    if (rmc[2] == "A") return rmc[12] != "N";
    if (rmc[2] == "V" || rmc[2].empty()) return false;
    rmc.cell(2).fail(fmt::format("the status is \"{}\", not A or V", escape_for_message(rmc[2])),
                     as_written);
}

/// The day of separate day, month and full year.
std::int64_t read_date(const Cell& day, const Cell& month, const Cell& year) {
    const auto found = day_number(static_cast<int>(read_whole(year, "year", 0, 9999)),
                                  static_cast<int>(read_whole(month, "month", 0, 99)),
                                  static_cast<int>(read_whole(day, "day", 0, 99)));
    if (!found) refuse_date(year);
    return *found;
}

Solution read_gga(const Sentence& gga) {
    Solution solution = begin_solution(gga, read_quality(gga.cell(6)));
    read_corrections(gga, 7, 13, solution);
    if (solution.fix == FixType::none) return solution;
    require_metres(gga.cell(10));
    require_metres(gga.cell(12));
    read_position_and_height(gga, 2, 9, 11, solution);
    return solution;
}

Solution read_gns(const Sentence& gns) {
    Solution solution = begin_solution(gns, best_of_modes(gns[6]));
    read_corrections(gns, 7, 11, solution);
    if (solution.fix != FixType::none) read_position_and_height(gns, 2, 9, 10, solution);
    return solution;
}

/// All or nothing.
void read_rmc(const Sentence& rmc, Epoch& epoch) {
    OptionalInteger date;
    if (!rmc[9].empty()) date = read_date(rmc.cell(9));
    Solution solution = begin_solution(rmc, FixType::none);
    GroundVelocity velocity;
    if (rmc_is_valid(rmc)) {
        solution.fix = rmc[12].size() == 1 ? best_of_modes(rmc[12]) : FixType::unknown;
        read_position(rmc, 3, 0.0, rmc.cell(3), solution);
        velocity = {read_written(rmc.cell(7), "speed", 0.0, largest_speed).times(knot_in_m_s),
                    read_written(rmc.cell(8), "course", 0.0, 360.0)};
    }
    epoch.rmc = solution;
    epoch.rmc_velocity = velocity;
    if (date) epoch.date = date;
}

/// Empty where the receiver says that it is not valid.
GroundVelocity read_vtg(const Sentence& vtg) {
    if (vtg[9] == "N") return {};
    for (const auto& [field, letter] :
         {std::pair{std::size_t{2}, "T"}, {std::size_t{6}, "N"}, {std::size_t{8}, "K"}})
        if (!vtg[field].empty() && vtg[field] != letter)
            vtg.cell(field).fail(fmt::format("field {} is \"{}\", not {}", field,
                                             escape_for_message(vtg[field]), letter),
                                 as_written);
    return {finer(read_written(vtg.cell(7), "speed", 0.0, largest_speed).times(km_h_in_m_s),
                  read_written(vtg.cell(5), "speed", 0.0, largest_speed).times(knot_in_m_s)),
            read_written(vtg.cell(1), "course", 0.0, 360.0)};
}

ErrorStatistics read_gst(const Sentence& gst) {
    const auto sigma = [&](std::size_t field) {
        const WrittenNumber read =
            read_written(gst.cell(field), "standard deviation", 0.0, largest_sigma_m);
        return read.value.value_or(0.0) > 0.0 ? read : WrittenNumber();
    };
    return {.semi_major_m = sigma(3),
            .semi_minor_m = sigma(4),
            .orientation_deg = read_written(gst.cell(5), "orientation", -360.0, 360.0).value,
            .sigma_north_m = sigma(6),
            .sigma_east_m = sigma(7),
            .sigma_up_m = sigma(8).value};
}

void count_gsa(const Sentence& gsa, Epoch& epoch) {
    if (gsa[2].empty()) return;
    const auto mode = read_whole(gsa.cell(2), "mode", 1, 3);
    ++epoch.satellite_lists;
    if (mode == 1) ++epoch.satellite_lists_without_fix;
    if (mode == 2) ++epoch.satellite_lists_in_plane;
}

}  // namespace

std::int64_t read_time_of_day(const Cell& cell) {
    constexpr std::size_t longest = std::string_view("hhmmss.").size() + 9;
    const auto time_ns = cell.text.size() > longest ? std::nullopt : nanoseconds_of_day(cell.text);
    if (!time_ns)
        cell.fail(
            fmt::format("\"{}\" is not a time of day, hhmmss.ss", escape_for_message(cell.text)),
            as_written);
    return *time_ns;
}

void require_whole(const Sentence& sentence) {
    const SentenceKind& kind = sentence_kinds[static_cast<std::size_t>(sentence.type)];
    const std::size_t needed = sentence.has_checksum ? kind.least : kind.full;
    if (sentence.size < needed)
        sentence.cell(sentence.size)
            .fail(fmt::format("the sentence \"{}\" ends after {} fields of {}",
                              escape_for_message(sentence[0]), sentence.size, needed),
                  "It is cut off; take the recording as the receiver wrote it");
}

void add_sentence(const Sentence& sentence, Epoch& epoch) {
    switch (sentence.type) {
        case SentenceType::gga:
            epoch.gga = read_gga(sentence);
            return;
        case SentenceType::gns:
            epoch.gns = read_gns(sentence);
            return;
        case SentenceType::rmc:
            return read_rmc(sentence, epoch);
        case SentenceType::vtg:
            epoch.vtg_velocity = read_vtg(sentence);
            return;
        case SentenceType::gst:
            epoch.errors = read_gst(sentence);
            return;
        case SentenceType::gsa:
            return count_gsa(sentence, epoch);
        case SentenceType::zda:
            if (!sentence[2].empty() && !epoch.date)
                epoch.date = read_date(sentence.cell(2), sentence.cell(3), sentence.cell(4));
            return;
        case SentenceType::txt:
            return;
    }
}

}  // namespace runcert::nmea
