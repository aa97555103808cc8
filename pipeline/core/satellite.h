#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace runcert {

/// Speed of light in vacuum (exact).
inline constexpr double speed_of_light_m_s = 299'792'458.0;

enum class SatelliteSystem : std::uint8_t { gps, glonass, galileo, beidou, qzss, sbas, navic };

/// The letter of a system in RINEX ([RINEX3] section 3.5): G, R, E, C, J, S, I.
char letter_of(SatelliteSystem system);
/// The system of a RINEX letter. Empty for any other letter.
std::optional<SatelliteSystem> system_of_letter(char letter);
/// "GPS", "Galileo".
std::string_view name_of(SatelliteSystem system);

/// A satellite as RINEX names it: "G02" is number 2 of GPS.
struct Satellite {
    SatelliteSystem system = SatelliteSystem::gps;
    std::uint8_t number = 0;  ///< 1 to 99

    friend auto operator<=>(const Satellite&, const Satellite&) = default;
};

/// A signal by its RINEX 3 observation code without the letter of the observation type ([RINEX3]
/// tables 4 to 10): "1C" is band 1, attribute C.
struct SignalCode {
    std::uint8_t band = 0;  ///< 1 to 9
    char attribute = ' ';   ///< A to Z

    friend auto operator<=>(const SignalCode&, const SignalCode&) = default;
};

/// The RINEX text of a satellite ("G02") or of a signal code ("1C").
std::string to_text(Satellite satellite);
std::string to_text(SignalCode signal);
/// The same texts as fixed-size characters that need no allocation, for tables.
std::array<char, 3> letters_of(Satellite satellite);
std::array<char, 2> letters_of(SignalCode signal);
/// Reads a satellite ("G02") or signal code ("1C"). Returns false, and leaves the value unchanged,
/// where the text is not one.
bool from_text(std::string_view text, Satellite& satellite);
bool from_text(std::string_view text, SignalCode& signal);

/// Carrier frequency (Hz) of a band ([IS-GPS-200], [GAL-ICD], [RINEX3] tables 4 to 10). Empty if
/// the system has no such band, and for GLONASS, whose satellites each have their own frequency.
std::optional<double> carrier_frequency_hz(SatelliteSystem system, std::uint8_t band);

}  // namespace runcert
