#include "stages/import/nmea/sentence_content.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/earth.h"
#include "stages/import/fix.h"

namespace runcert::nmea {
namespace {

constexpr double mps_per_knot = 1852.0 / 3600.0;
constexpr double mps_per_kmh = 1.0 / 3.6;
constexpr double largest_speed = 1e5;
constexpr double largest_height_m = 1e6;
constexpr double largest_sigma_m = 1e9;

/// How many fields, the address included, a type must have, and has in full.
struct FieldCount {
    std::size_t least;
    std::size_t full;
};

FieldCount fields_of(SentenceType type) {
    switch (type) {
        case SentenceType::gga:
            return {10, 15};
        case SentenceType::gns:
            return {10, 13};
        case SentenceType::rmc:
            return {10, 12};
        case SentenceType::vtg:
            return {8, 9};
        case SentenceType::gst:
            return {9, 9};
        case SentenceType::gsa:
            return {3, 18};
        case SentenceType::zda:
            return {5, 7};
        case SentenceType::txt:
            break;
    }
    return {0, 0};
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
            "Take the recording as the receiver wrote it");
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

/// The best of the systems' modes.
FixType best_of_modes(std::string_view modes) {
    constexpr std::string_view best_first = "RFDPAEN";
    for (const char mode : best_first)
        if (modes.find(mode) != std::string_view::npos) return fix_of_mode(mode);
    return FixType::unknown;
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
                     "Take the recording as the receiver wrote it");
}

}  // namespace

void require_whole(const Sentence& sentence) {
    const FieldCount count = fields_of(sentence.type);
    const std::size_t needed = sentence.has_checksum ? count.least : count.full;
    if (sentence.size < needed)
        sentence.cell(sentence.size)
            .fail(fmt::format("the sentence \"{}\" ends after {} fields of {}",
                              escape_for_message(sentence[0]), sentence.size, needed),
                  "It is cut off; take the recording as the receiver wrote it");
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

void take_in_rmc(const Sentence& rmc, Epoch& epoch) {
    OptionalInteger date;
    if (!rmc[9].empty()) date = read_date(rmc.cell(9));
    Solution solution = begin_solution(rmc, FixType::none);
    GroundVelocity velocity;
    if (rmc_is_valid(rmc)) {
        solution.fix = rmc[12].size() == 1 ? fix_of_mode(rmc[12][0]) : FixType::unknown;
        read_position(rmc, 3, 0.0, rmc.cell(3), solution);
        velocity = {read_written(rmc.cell(7), "speed", 0.0, largest_speed).times(mps_per_knot),
                    read_written(rmc.cell(8), "course", 0.0, 360.0)};
    }
    epoch.rmc = solution;
    epoch.rmc_velocity = velocity;
    if (date) epoch.date = date;
}

GroundVelocity read_vtg(const Sentence& vtg) {
    if (vtg[9] == "N") return {};
    for (const auto& [field, letter] : {std::pair{2, "T"}, std::pair{6, "N"}, std::pair{8, "K"}}) {
        const auto index = static_cast<std::size_t>(field);
        if (!vtg[index].empty() && vtg[index] != letter)
            vtg.cell(index).fail(fmt::format("field {} is \"{}\", not {}", field,
                                             escape_for_message(vtg[index]), letter),
                                 "Take the recording as the receiver wrote it");
    }
    return {finer(read_written(vtg.cell(7), "speed", 0.0, largest_speed).times(mps_per_kmh),
                  read_written(vtg.cell(5), "speed", 0.0, largest_speed).times(mps_per_knot)),
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

void take_in_gsa(const Sentence& gsa, Epoch& epoch) {
    if (gsa[2].empty()) return;
    const auto mode = read_whole(gsa.cell(2), "mode", 1, 3);
    ++epoch.satellite_lists;
    if (mode == 1) ++epoch.satellite_lists_without_fix;
    if (mode == 2) ++epoch.satellite_lists_in_plane;
}

}  // namespace runcert::nmea
