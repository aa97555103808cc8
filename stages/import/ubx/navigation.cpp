#include <cmath>

#include "stages/import/bits.h"
#include "stages/import/byte_order.h"
#include "stages/import/ubx/frames.h"
#include "stages/import/ubx/raw.h"

namespace runcert::ubx {
namespace {

constexpr std::size_t words_at = 8;
constexpr std::size_t lnav_words = 10;
constexpr std::size_t inav_words = 8;
constexpr std::uint8_t galileo = 2, e1_b = 1;

std::uint32_t word_at(std::string_view payload, std::size_t i) {
    return little_endian<std::uint32_t>(payload, words_at + 4 * i);
}

/// Clock and orbit of GPS subframes 1, 2, 3, without parity; the issues were compared.
Ephemeris lnav_ephemeris(const std::array<std::vector<std::uint8_t>, 6>& page, GpsTime near) {
    Ephemeris e;
    constexpr std::size_t after_handover = 48;
    Bits one(page[0], after_handover);
    one.skip(10 + 2 + 4);
    e.healthy = one.whole(6) == 0;
    one.skip(2 + 88);
    e.group_delay_s = one.scaled_with_sign(8, -31);
    one.skip(8);
    e.clock_reference = nearest_of_week(16.0 * one.whole(16), near);
    e.clock_drift_rate = one.scaled_with_sign(8, -55);
    e.clock_drift = one.scaled_with_sign(16, -43);
    e.clock_offset_s = one.scaled_with_sign(22, -31);
    Bits two(page[1], after_handover);
    e.issue = static_cast<std::int32_t>(two.whole(8));
    e.crs = two.scaled_with_sign(16, -5);
    e.mean_motion_difference = two.angle(16, -43);
    e.mean_anomaly = two.angle(32, -31);
    e.cuc = two.scaled_with_sign(16, -29);
    e.eccentricity = two.scaled(32, -33);
    e.cus = two.scaled_with_sign(16, -29);
    e.root_of_semi_major_axis = two.scaled(32, -19);
    e.reference = nearest_of_week(16.0 * two.whole(16), near);
    Bits three(page[2], after_handover);
    e.cic = three.scaled_with_sign(16, -29);
    e.right_ascension = three.angle(32, -31);
    e.cis = three.scaled_with_sign(16, -29);
    e.inclination = three.angle(32, -31);
    e.crc = three.scaled_with_sign(16, -5);
    e.argument_of_perigee = three.angle(32, -31);
    e.right_ascension_rate = three.angle(24, -43);
    three.skip(8);
    e.inclination_rate = three.angle(14, -43);
    return e;
}

std::uint32_t inav_issue(const std::vector<std::uint8_t>& page) {
    return Bits(page, 6).whole(10);
}

/// Orbit and clock of Galileo's words 1 to 4; health and group delay of 5, where it was there.
Ephemeris inav_ephemeris(const std::array<std::vector<std::uint8_t>, 6>& page, GpsTime near) {
    Ephemeris e;
    constexpr std::size_t after_issue = 16;
    Bits one(page[1], after_issue);
    e.issue = static_cast<std::int32_t>(inav_issue(page[1]));
    e.reference = nearest_of_week(60.0 * one.whole(14), near);
    e.mean_anomaly = one.angle(32, -31);
    e.eccentricity = one.scaled(32, -33);
    e.root_of_semi_major_axis = one.scaled(32, -19);
    Bits two(page[2], after_issue);
    e.right_ascension = two.angle(32, -31);
    e.inclination = two.angle(32, -31);
    e.argument_of_perigee = two.angle(32, -31);
    e.inclination_rate = two.angle(14, -43);
    Bits three(page[3], after_issue);
    e.right_ascension_rate = three.angle(24, -43);
    e.mean_motion_difference = three.angle(16, -43);
    e.cuc = three.scaled_with_sign(16, -29);
    e.cus = three.scaled_with_sign(16, -29);
    e.crc = three.scaled_with_sign(16, -5);
    e.crs = three.scaled_with_sign(16, -5);
    Bits four(page[4], after_issue + 6);
    e.cic = four.scaled_with_sign(16, -29);
    e.cis = four.scaled_with_sign(16, -29);
    e.clock_reference = nearest_of_week(60.0 * four.whole(14), near);
    e.clock_offset_s = four.scaled_with_sign(31, -34);
    e.clock_drift = four.scaled_with_sign(21, -46);
    e.clock_drift_rate = four.scaled_with_sign(6, -59);
    if (!page[5].empty()) {
        Bits five(page[5], 6 + 11 + 11 + 14 + 5 + 10);
        e.group_delay_s = five.scaled_with_sign(10, -32);
        five.skip(2);
        const std::uint32_t status = five.whole(2);
        five.skip(1);
        e.healthy = status == 0 && five.whole(1) == 0;
    }
    return e;
}

std::array<std::uint8_t, 32> inav_bits(std::string_view payload) {
    std::array<std::uint8_t, 32> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = static_cast<std::uint8_t>(word_at(payload, i / 4) >> (24 - 8 * (i % 4)) & 0xffU);
    return bytes;
}

}  // namespace

std::optional<E1Page> e1_page(std::string_view payload) {
    if (payload.size() < words_at + 4 * inav_words) return std::nullopt;
    const auto at = [&](std::size_t i) { return little_endian<std::uint8_t>(payload, i); };
    if (at(0) != galileo || at(2) != e1_b || at(4) < inav_words) return std::nullopt;
    return E1Page{.satellite = at(1), .page = inav_page(inav_bits(payload))};
}

bool NavigationCollector::take(std::string_view payload, std::int64_t byte, GpsTime near) {
    constexpr std::uint8_t gps = 0;
    if (payload.size() < words_at) return false;
    const auto at = [&](std::size_t i) { return little_endian<std::uint8_t>(payload, i); };
    const std::uint8_t system = at(0), number = at(1), signal = at(2), words = at(4);
    if (number < 1 || number > 99 || payload.size() < words_at + 4 * std::size_t{words})
        return false;
    if (system == gps && signal == 0 && words == lnav_words)
        return take_lnav({SatelliteSystem::gps, number}, payload, byte, near);
    const bool is_inav = signal == e1_b || signal == 5;
    if (system == galileo && is_inav && words >= inav_words)
        return take_inav({SatelliteSystem::galileo, number}, payload, byte, near);
    return false;
}

bool NavigationCollector::take_lnav(Satellite satellite, std::string_view payload,
                                    std::int64_t byte, GpsTime near) {
    BitWriter writer;
    for (std::size_t i = 0; i < lnav_words; ++i)
        writer.put(word_at(payload, i) >> 6 & 0xffffffU, 24);
    std::vector<std::uint8_t> subframe = std::move(writer).take();
    constexpr std::uint8_t preamble = 0x8b;
    if (subframe[0] != preamble) return false;
    const std::uint32_t id = Bits(subframe, 43).whole(3);
    if (id < 1 || id > 5) return false;
    if (id > 3) return true;
    Pages& pages = pages_[satellite];
    if (id == 1) pages.byte = byte;
    pages.page[id - 1] = std::move(subframe);
    for (std::size_t i = 0; i < 3; ++i)
        if (pages.page[i].empty()) return true;
    const std::uint32_t clock_issue = Bits(pages.page[0], 168).whole(8);
    const std::uint32_t orbit_issue = Bits(pages.page[1], 48).whole(8);
    if (clock_issue != orbit_issue || orbit_issue != Bits(pages.page[2], 216).whole(8)) return true;
    Ephemeris ephemeris = lnav_ephemeris(pages.page, near);
    ephemeris.satellite = satellite;
    ephemeris.place = pages.byte;
    add(ephemeris);
    return true;
}

bool NavigationCollector::take_inav(Satellite satellite, std::string_view payload,
                                    std::int64_t byte, GpsTime near) {
    const std::optional<InavPage> read = inav_page(inav_bits(payload));
    if (!read) return false;
    std::vector<std::uint8_t> word(read->word.begin(), read->word.end());
    const std::uint32_t type = Bits(word, 0).whole(6);
    if (type < 1 || type > 5) return true;
    Pages& pages = pages_[satellite];
    if (type == 1) pages.byte = byte;
    pages.page[type] = std::move(word);
    for (std::size_t i = 1; i <= 4; ++i)
        if (pages.page[i].empty() || inav_issue(pages.page[i]) != inav_issue(pages.page[1]))
            return true;
    // Whether the satellite is healthy must be known, and is said every 30 s.
    if (pages.page[5].empty()) return true;
    Ephemeris ephemeris = inav_ephemeris(pages.page, near);
    ephemeris.satellite = satellite;
    ephemeris.place = pages.byte;
    add(ephemeris);
    return true;
}

void NavigationCollector::add(Ephemeris ephemeris) {
    if (!is_plausible(ephemeris)) return;
    for (const Ephemeris& known : whole_)
        if (known.satellite == ephemeris.satellite && known.issue == ephemeris.issue &&
            known.reference == ephemeris.reference && known.healthy == ephemeris.healthy)
            return;
    whole_.push_back(ephemeris);
}

}  // namespace runcert::ubx
