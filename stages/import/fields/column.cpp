#include "stages/import/fields/column.h"

#include <algorithm>

#include "core/text.h"

namespace runcert::csv {
namespace {

template <std::size_t count>
constexpr KnownNames known(Column column, const std::string_view (&names)[count]) {
    return {column, names};
}

constexpr std::string_view latitudes[] = {"latitude", "gpslatitude", "gpslat", "lat",
                                          "breite",   "breitengrad", "latitud"};
constexpr std::string_view longitudes[] = {"longitude", "gpslongitude", "gpslong",   "gpslon",
                                           "gpslng",    "long",         "lon",       "lng",
                                           "laenge",    "laengengrad",  "lngengrad", "longitud"};
constexpr std::string_view heights[] = {"height",
                                        "ellipsoidheight",
                                        "ellipsoidalheight",
                                        "hell",
                                        "altitude",
                                        "gpsaltitude",
                                        "gpsalt",
                                        "gpsheight",
                                        "elevation",
                                        "alt",
                                        "ele",
                                        "hmsl",
                                        "positionaltitude",
                                        "hoehe",
                                        "hhe"};
constexpr std::string_view ecef_x[] = {"ecefx", "xecef", "x"};
constexpr std::string_view ecef_y[] = {"ecefy", "yecef", "y"};
constexpr std::string_view ecef_z[] = {"ecefz", "zecef", "z"};
constexpr std::string_view easts[] = {"easting", "east", "utme", "e", "x"};
constexpr std::string_view norths[] = {"northing", "north", "utmn", "n", "y"};
constexpr std::string_view ups[] = {"up", "height", "elevation", "altitude", "u", "z"};
constexpr std::string_view times[] = {
    "utctime", "gpstime",    "timestamp", "datetime", "utcdatetime", "gpsdatetime", "timeutc",
    "utcunix", "utcunixs",   "time",      "utc",      "unixtime",    "unix",        "gpstow",
    "tow",     "gpsseconds", "gpssow",    "sow",      "ts",          "epoch"};
constexpr std::string_view weeks[] = {"gpsweek", "week"};
constexpr std::string_view dates[] = {"utcdate", "gpsdate", "date"};
constexpr std::string_view velocities_east[] = {"velocityeast", "eastvelocity", "veast", "vele",
                                                "ve"};
constexpr std::string_view velocities_north[] = {"velocitynorth", "northvelocity", "vnorth", "veln",
                                                 "vn"};
constexpr std::string_view velocities_up[] = {
    "velocityup",   "upvelocity",   "vup",   "velu", "vu",
    "velocitydown", "downvelocity", "vdown", "veld", "vd"};
constexpr std::string_view speeds[] = {"gpsspeed",
                                       "groundspeed",
                                       "speedoverground",
                                       "gspd",
                                       "sog",
                                       "speed",
                                       "velocity",
                                       "kph",
                                       "kmh",
                                       "mph",
                                       "spd",
                                       "gspeed",
                                       "gps2dspeed",
                                       "2dspeed",
                                       "speed2d",
                                       "speedhorizontal",
                                       "horizontalspeed",
                                       "geschwindigkeit",
                                       "vitesse",
                                       "velocidad",
                                       "velocita",
                                       "snelheid",
                                       "hastighet"};
constexpr std::string_view courses[] = {
    "courseoverground", "course",  "cog",   "gpscourse", "groundcourse", "heading",
    "gpsheading",       "bearing", "track", "hdg",       "trackangle",   "kurs"};
constexpr std::string_view sigmas_east[] = {
    "sigmaeast",   "sdeast", "stdeast", "eaststd", "eastsd", "sde", "eastpositionaccuracy",
    "eastaccuracy"};
constexpr std::string_view sigmas_north[] = {
    "sigmanorth",   "sdnorth", "stdnorth", "northstd", "northsd", "sdn", "northpositionaccuracy",
    "northaccuracy"};
constexpr std::string_view sigmas_up[] = {"sigmaup",
                                          "sdup",
                                          "stdup",
                                          "upstd",
                                          "upsd",
                                          "sdu",
                                          "sdheight",
                                          "heightsd",
                                          "heightstd",
                                          "downpositionaccuracy",
                                          "uppositionaccuracy",
                                          "downaccuracy"};
constexpr std::string_view qualities_2d[] = {"quality2d", "cq2d", "2dcq",     "horizontalaccuracy",
                                             "haccuracy", "hacc", "accuracy", "gpsaccuracy"};
constexpr std::string_view qualities_height[] = {"qualityheight",    "cq1d",      "1dcq",
                                                 "verticalaccuracy", "vaccuracy", "vacc"};
constexpr std::string_view sigmas_speed[] = {"sigmaspeed", "speedaccuracy", "sacc"};
constexpr std::string_view fixes[] = {"fix",          "fixtype", "gpsfix",          "solution",
                                      "solutiontype", "valid",   "gnsspositionmode"};
constexpr std::string_view counts[] = {"satellites", "satellitesused",
                                       "sats",       "sat",
                                       "numsv",      "numsats",
                                       "numsat",     "gpsnumsat",
                                       "nsat",       "nsats",
                                       "ns",         "numberofsatellites",
                                       "gpssats",    "svs"};
constexpr std::string_view norths_or_souths[] = {"ns",
                                                 "latns",
                                                 "latdir",
                                                 "nsindicator",
                                                 "latitudedirection",
                                                 "lathemisphere",
                                                 "latitudehemisphere",
                                                 "latref"};
constexpr std::string_view easts_or_wests[] = {"ew",
                                               "lonew",
                                               "londir",
                                               "ewindicator",
                                               "longitudedirection",
                                               "lonhemisphere",
                                               "longitudehemisphere",
                                               "lonref"};
constexpr std::string_view milliseconds_names[] = {"ms", "msec", "millis", "millisecond",
                                                   "milliseconds"};
constexpr std::string_view providers[] = {"provider", "locationprovider", "positionprovider"};

constexpr std::string_view mocks[] = {"ismocklocation", "mocklocation", "ismock",
                                      "mock",           "mocked",       "isfrommockprovider"};

constexpr KnownNames geodetic[] = {known(Column::latitude, latitudes),
                                   known(Column::longitude, longitudes),
                                   known(Column::height, heights)};
constexpr KnownNames ecef[] = {known(Column::x, ecef_x), known(Column::y, ecef_y),
                               known(Column::z, ecef_z)};
constexpr KnownNames plane[] = {known(Column::east, easts), known(Column::north, norths),
                                known(Column::up, ups)};
constexpr KnownNames others[] = {known(Column::time, times),
                                 known(Column::week, weeks),
                                 known(Column::date, dates),
                                 known(Column::velocity_east, velocities_east),
                                 known(Column::velocity_north, velocities_north),
                                 known(Column::velocity_up, velocities_up),
                                 known(Column::speed, speeds),
                                 known(Column::course, courses),
                                 known(Column::sigma_east, sigmas_east),
                                 known(Column::sigma_north, sigmas_north),
                                 known(Column::sigma_up, sigmas_up),
                                 known(Column::quality_2d, qualities_2d),
                                 known(Column::quality_height, qualities_height),
                                 known(Column::sigma_speed, sigmas_speed),
                                 known(Column::fix, fixes),
                                 known(Column::satellites, counts),
                                 known(Column::north_south, norths_or_souths),
                                 known(Column::east_west, easts_or_wests),
                                 known(Column::milliseconds, milliseconds_names),
                                 known(Column::provider, providers),
                                 known(Column::mock, mocks)};

constexpr std::string_view of_both[] = {"gps",    "latlon",      "latlong",
                                        "latlng", "coordinates", "position"};

/// Words of fix types, as OxTS, Columbus, Inertial Explorer and others write them, in letters and
/// digits.
struct FixWords {
    FixType fix;
    std::string_view words;
};
constexpr FixWords fix_words[] = {
    {FixType::fixed, " rtkinteger rtkfixed rtkfix narrowint integer fix4 "},
    {FixType::float_ambiguities, " rtkfloat narrowfloat "},
    {FixType::dgps, " differential dgnss psrdiff "},
    {FixType::single, " sps ca 3d 2d autonomous spp "},
    {FixType::none, " nofix invalid novalue searching "}};

}  // namespace

std::span<const KnownNames> geodetic_names() {
    return geodetic;
}
std::span<const KnownNames> ecef_names() {
    return ecef;
}
std::span<const KnownNames> plane_names() {
    return plane;
}
std::span<const KnownNames> other_names() {
    return others;
}
std::span<const std::string_view> names_of_both() {
    return of_both;
}

bool is_named(std::string_view name, Column column) {
    const std::string letters = letters_of(name);
    for (const auto names : {geodetic_names(), other_names()})
        for (const KnownNames& each : names)
            if (each.column == column && std::ranges::find(each.names, letters) != each.names.end())
                return true;
    return false;
}

bool counts_down(std::string_view name) {
    const std::string letters = letters_of(name);
    return letters.find("down") != std::string::npos || letters == "vd" || letters == "veld";
}

std::optional<FixType> fix_by_word(std::string_view word) {
    FixType fix{};
    if (from_text(lower_case(word), fix)) return fix;
    std::string letters = lower_case(word);
    std::erase_if(letters, [](char c) { return !((c >= 'a' && c <= 'z') || is_digit(c)); });
    if (letters.empty() || parse_double(word)) return std::nullopt;
    for (const FixWords& each : fix_words)
        if (each.words.find(" " + letters + " ") != std::string_view::npos) return each.fix;
    return std::nullopt;
}

}  // namespace runcert::csv
