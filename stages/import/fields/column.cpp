#include "stages/import/fields/column.h"

#include <algorithm>

#include "core/text.h"

namespace runcert::csv {
namespace {

constexpr KnownNames geodetic[] = {
    {Column::latitude, "latitude gpslatitude gpslat lat breite breitengrad latitud"},
    {Column::longitude,
     "longitude gpslongitude gpslong gpslon gpslng long lon lng laenge laengengrad longitud"},
    {Column::height,
     "height ellipsoidheight ellipsoidalheight hell altitude gpsaltitude gpsalt gpsheight "
     "elevation alt ele hmsl positionaltitude hoehe hhe"}};
constexpr KnownNames ecef[] = {
    {Column::x, "ecefx xecef x"}, {Column::y, "ecefy yecef y"}, {Column::z, "ecefz zecef z"}};
constexpr KnownNames plane[] = {{Column::east, "easting east utme e x"},
                                {Column::north, "northing north utmn n y"},
                                {Column::up, "up height elevation altitude u z"}};
constexpr KnownNames others[] = {
    {Column::time,
     "utctime gpstime timestamp datetime utcdatetime gpsdatetime timeutc utcunix utcunixs time "
     "utc unixtime unix gpstow tow gpsseconds gpssow sow ts epoch"},
    {Column::week, "gpsweek week"},
    {Column::date, "utcdate gpsdate date"},
    {Column::velocity_east, "velocityeast eastvelocity veast vele ve"},
    {Column::velocity_north, "velocitynorth northvelocity vnorth veln vn"},
    {Column::velocity_up,
     "velocityup upvelocity vup velu vu velocitydown downvelocity vdown veld vd"},
    {Column::speed,
     "gpsspeed groundspeed speedoverground gspd sog speed velocity kph kmh mph spd gspeed "
     "gps2dspeed 2dspeed speed2d speedhorizontal horizontalspeed geschwindigkeit vitesse "
     "velocidad velocita snelheid hastighet"},
    {Column::course,
     "courseoverground course cog gpscourse groundcourse heading gpsheading bearing track hdg "
     "trackangle kurs"},
    {Column::sigma_east,
     "sigmaeast sdeast stdeast eaststd eastsd sde eastpositionaccuracy eastaccuracy"},
    {Column::sigma_north,
     "sigmanorth sdnorth stdnorth northstd northsd sdn northpositionaccuracy northaccuracy"},
    {Column::sigma_up,
     "sigmaup sdup stdup upstd upsd sdu sdheight heightsd heightstd downpositionaccuracy "
     "uppositionaccuracy downaccuracy"},
    {Column::quality_2d,
     "quality2d cq2d 2dcq horizontalaccuracy haccuracy hacc accuracy gpsaccuracy"},
    {Column::quality_height, "qualityheight cq1d 1dcq verticalaccuracy vaccuracy vacc"},
    {Column::sigma_speed, "sigmaspeed speedaccuracy sacc"},
    {Column::fix, "fix fixtype gpsfix solution solutiontype valid gnsspositionmode"},
    {Column::satellites,
     "satellites satellitesused sats sat numsv numsats numsat gpsnumsat nsat nsats ns "
     "numberofsatellites gpssats svs"},
    {Column::north_south,
     "ns latns latdir nsindicator latitudedirection lathemisphere latitudehemisphere latref"},
    {Column::east_west,
     "ew lonew londir ewindicator longitudedirection lonhemisphere longitudehemisphere lonref"},
    {Column::milliseconds, "ms msec millis millisecond milliseconds"},
    {Column::provider, "provider locationprovider positionprovider"},
    {Column::mock, "ismocklocation mocklocation ismock mock mocked isfrommockprovider"}};
constexpr std::string_view of_both = "gps latlon latlong latlng coordinates position";

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
std::vector<std::string_view> names_of_both() {
    return words_of(of_both);
}

std::vector<std::string_view> words_of(std::string_view text) {
    std::vector<std::string_view> words;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        words.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return words;
}

bool is_named(std::string_view name, Column column) {
    const std::string letters = letters_of(name);
    for (const auto names : {geodetic_names(), other_names()})
        for (const KnownNames& each : names)
            if (each.column == column)
                for (const std::string_view word : words_of(each.names))
                    if (word == letters) return true;
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
