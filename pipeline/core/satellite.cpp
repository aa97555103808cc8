#include "core/satellite.h"

#include <algorithm>

#include "core/text.h"

namespace runcert {
namespace {

struct SystemName {
    SatelliteSystem system;
    char letter;
    std::string_view name;
};

constexpr std::array<SystemName, 7> system_names{{{SatelliteSystem::gps, 'G', "GPS"},
                                                  {SatelliteSystem::glonass, 'R', "GLONASS"},
                                                  {SatelliteSystem::galileo, 'E', "Galileo"},
                                                  {SatelliteSystem::beidou, 'C', "BeiDou"},
                                                  {SatelliteSystem::qzss, 'J', "QZSS"},
                                                  {SatelliteSystem::sbas, 'S', "SBAS"},
                                                  {SatelliteSystem::navic, 'I', "NavIC"}}};

struct Band {
    SatelliteSystem system;
    std::uint8_t band;
    double frequency_hz;
};

constexpr std::array<Band, 22> bands{{
    {SatelliteSystem::gps, 1, 1575.42e6},     {SatelliteSystem::gps, 2, 1227.60e6},
    {SatelliteSystem::gps, 5, 1176.45e6},     {SatelliteSystem::galileo, 1, 1575.42e6},
    {SatelliteSystem::galileo, 5, 1176.45e6}, {SatelliteSystem::galileo, 6, 1278.75e6},
    {SatelliteSystem::galileo, 7, 1207.14e6}, {SatelliteSystem::galileo, 8, 1191.795e6},
    {SatelliteSystem::beidou, 1, 1575.42e6},  {SatelliteSystem::beidou, 2, 1561.098e6},
    {SatelliteSystem::beidou, 5, 1176.45e6},  {SatelliteSystem::beidou, 6, 1268.52e6},
    {SatelliteSystem::beidou, 7, 1207.14e6},  {SatelliteSystem::beidou, 8, 1191.795e6},
    {SatelliteSystem::qzss, 1, 1575.42e6},    {SatelliteSystem::qzss, 2, 1227.60e6},
    {SatelliteSystem::qzss, 5, 1176.45e6},    {SatelliteSystem::qzss, 6, 1278.75e6},
    {SatelliteSystem::sbas, 1, 1575.42e6},    {SatelliteSystem::sbas, 5, 1176.45e6},
    {SatelliteSystem::navic, 5, 1176.45e6},   {SatelliteSystem::navic, 9, 2492.028e6},
}};

constexpr char digit(int value) {
    return static_cast<char>('0' + value);
}

}  // namespace

char letter_of(SatelliteSystem system) {
    return system_names[static_cast<std::size_t>(system)].letter;
}

std::optional<SatelliteSystem> system_of_letter(char letter) {
    const auto found = std::ranges::find(system_names, letter, &SystemName::letter);
    if (found == system_names.end()) return std::nullopt;
    return found->system;
}

std::string_view name_of(SatelliteSystem system) {
    return system_names[static_cast<std::size_t>(system)].name;
}

std::array<char, 3> letters_of(Satellite satellite) {
    return {letter_of(satellite.system), digit(satellite.number / 10 % 10),
            digit(satellite.number % 10)};
}

std::array<char, 2> letters_of(SignalCode signal) {
    return {digit(signal.band), signal.attribute};
}

std::string to_text(Satellite satellite) {
    const auto letters = letters_of(satellite);
    return {letters.begin(), letters.end()};
}

std::string to_text(SignalCode signal) {
    const auto letters = letters_of(signal);
    return {letters.begin(), letters.end()};
}

bool from_text(std::string_view text, Satellite& satellite) {
    if (text.size() != 3 || !is_digit(text[1]) || !is_digit(text[2])) return false;
    const auto system = system_of_letter(text[0]);
    const int number = 10 * (text[1] - '0') + (text[2] - '0');
    if (!system || number == 0) return false;
    satellite = {*system, static_cast<std::uint8_t>(number)};
    return true;
}

bool from_text(std::string_view text, SignalCode& signal) {
    if (text.size() != 2 || text[0] < '1' || text[0] > '9' || text[1] < 'A' || text[1] > 'Z')
        return false;
    signal = {static_cast<std::uint8_t>(text[0] - '0'), text[1]};
    return true;
}

std::optional<double> carrier_frequency_hz(SatelliteSystem system, std::uint8_t band) {
    for (const Band& each : bands)
        if (each.system == system && each.band == band) return each.frequency_hz;
    return std::nullopt;
}

}  // namespace runcert
