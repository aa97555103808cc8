#include "core/written_unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/angle.h"
#include "core/speed_unit.h"
#include "core/text.h"

namespace runcert {
namespace {

/// A unit, and how it is written: letters and digits alone, in lower case, without "per". The
/// factors are exact by the units' definitions (BIPM, SI Brochure; 1959 yard).
struct Spelled {
    Unit unit;
    std::array<std::string_view, 9> spellings;
};
constexpr Spelled spelled[] = {
    {{"m/s", Quantity::speed, 1.0},
     {"ms", "mps", "msec", "meterssecond", "metressecond", "meterssec", "metersecond", "ms1"}},
    {{"km/h", Quantity::speed, km_h_in_m_s},
     {"kmh", "kph", "kmph", "kmhr", "kmhour", "kilometershour", "kilometreshour"}},
    {{"mph", Quantity::speed, mph_in_m_s}, {"mph", "mih", "mileshour"}},
    {{"kn", Quantity::speed, knot_in_m_s}, {"kn", "kt", "kts", "kns", "knot", "knots"}},
    {{"ft/s", Quantity::speed, 0.3048}, {"fts", "fps", "feetsecond"}},
    {{"cm/s", Quantity::speed, 0.01}, {"cms", "cmps", "cmsec"}},
    {{"mm/s", Quantity::speed, 0.001}, {"mms", "mmps", "mmsec"}},
    {{"m", Quantity::length, 1.0}, {"m", "meter", "meters", "metre", "metres"}},
    {{"cm", Quantity::length, 0.01}, {"cm"}},
    {{"mm", Quantity::length, 0.001}, {"mm"}},
    {{"km", Quantity::length, 1000.0}, {"km"}},
    {{"ft", Quantity::length, 0.3048}, {"ft", "feet", "foot"}},
    {{"US survey ft", Quantity::length, 1200.0 / 3937.0},
     {"usft", "ftus", "usfeet", "usfoot", "ussurveyfeet", "ussurveyfoot", "ussurveyft",
      "surveyfeet", "surveyft"}},
    {{"yd", Quantity::length, 0.9144}, {"yd", "yds", "yard", "yards"}},
    {{"mi", Quantity::length, metres_per_statute_mile}, {"mi", "mile", "miles"}},
    {{"deg", Quantity::angle, 1.0}, {"deg", "degs", "degree", "degrees", "\xc2\xb0"}},
    {{"rad", Quantity::angle, Angle::from_radians(1.0).degrees()},
     {"rad", "rads", "radian", "radians"}},
    {{"min", Quantity::angle, 1.0 / 60.0}, {"min", "mins", "arcmin", "minutes"}},
    {{"s", Quantity::time, 1.0}, {"s", "sec", "secs", "second", "seconds"}},
    {{"ms", Quantity::time, 1e-3},
     {"ms", "msec", "msecs", "millis", "0001s", "millisecond", "milliseconds"}},
    {{"us", Quantity::time, 1e-6}, {"us", "usec", "micros", "microseconds", "\xc2\xb5s"}},
    {{"ns", Quantity::time, 1e-9}, {"ns", "nanos", "nanoseconds"}}};
/// Of speeds that programs write: of those above, the first.
constexpr std::size_t usual_speeds = 4;

bool is_letter_or_digit(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || (c & 0x80) != 0;
}

bool is_upper(char c) {
    return c >= 'A' && c <= 'Z';
}

/// As `spelled` has units.
std::string as_spelled(std::string_view text) {
    std::string letters = lower_case(text);
    std::erase_if(letters, [](char c) { return !is_letter_or_digit(c); });
    if (const std::size_t per = letters.find("per"); per > 0 && per != std::string::npos)
        letters.erase(per, 3);
    return letters;
}

/// Where the brackets at the end of a name begin; its size where there are none.
std::size_t brackets_of(std::string_view name) {
    if (!name.ends_with(')') && !name.ends_with(']')) return name.size();
    const std::size_t open = name.rfind(name.back() == ')' ? '(' : '[');
    return open == std::string_view::npos ? name.size() : open;
}

std::string_view in_brackets(std::string_view name) {
    const std::size_t open = brackets_of(name);
    return open == name.size() ? std::string_view()
                               : trim(name.substr(open + 1, name.size() - open - 2));
}

/// Where the last words of a name begin, the last first: words are parted by anything that is no
/// letter or digit, and by a capital behind a small letter.
std::vector<std::size_t> words_from_the_end(std::string_view name) {
    std::vector<std::size_t> begins;
    for (std::size_t i = name.size(); i-- > 0;) {
        if (!is_letter_or_digit(name[i])) continue;
        const bool begins_here = i == 0 || !is_letter_or_digit(name[i - 1]) ||
                                 (is_upper(name[i]) && name[i - 1] >= 'a' && name[i - 1] <= 'z');
        if (begins_here) begins.push_back(i);
    }
    return begins;
}

bool is_number_character(char c) {
    return is_digit(c) || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E' || c == ',';
}

}  // namespace

std::optional<Unit> find_unit(std::string_view text, Quantity quantity) {
    const std::string letters = as_spelled(text);
    if (letters.empty()) return std::nullopt;
    for (const Spelled& each : spelled)
        if (each.unit.quantity == quantity &&
            std::ranges::find(each.spellings, letters) != each.spellings.end())
            return each.unit;
    return std::nullopt;
}

std::optional<Unit> find_unit(std::string_view text) {
    for (const Quantity quantity :
         {Quantity::speed, Quantity::length, Quantity::angle, Quantity::time})
        if (const auto unit = find_unit(text, quantity)) return unit;
    return std::nullopt;
}

std::optional<Unit> unit_in_brackets(std::string_view name, Quantity quantity) {
    if (const std::string_view inside = in_brackets(trim(name)); !inside.empty())
        return find_unit(inside, quantity);
    // "M" is rather a name.
    return quantity == Quantity::speed ? find_unit(name, quantity) : std::nullopt;
}

std::optional<Unit> unit_in_name(std::string_view name, Quantity quantity) {
    if (const auto unit = unit_in_brackets(name, quantity)) return unit;
    name = without_unit(name);
    const std::vector<std::size_t> words = words_from_the_end(name);
    constexpr std::size_t most_words = 3;
    for (std::size_t count = std::min(most_words, words.size()); count > 0; --count) {
        const std::string_view last = name.substr(words[count - 1]);
        if (count == words.size()) continue;
        // "hAccM" and "T" say no unit; "height_m" does.
        const bool apart = words[count - 1] > 0 && !is_letter_or_digit(name[words[count - 1] - 1]);
        if (as_spelled(last).size() < 2 && !apart) continue;
        if (const auto unit = find_unit(last, quantity)) return unit;
    }
    if (quantity == Quantity::angle)
        for (const std::string_view ending : {"rad", "radian", "radians"})
            if (const std::string letters = as_spelled(name);
                letters.ends_with(ending) && !letters.ends_with("grad"))
                return find_unit(ending, quantity);  // "latrad"
    if (quantity != Quantity::speed) return std::nullopt;
    // "speedkmh": of several endings the longest.
    const std::string letters = as_spelled(name);
    std::optional<Unit> found;
    std::size_t longest = 1;
    for (const Spelled& each : spelled)
        for (const std::string_view ending : each.spellings)
            if (each.unit.quantity == quantity && ending.size() > longest &&
                letters.ends_with(ending)) {
                longest = ending.size();
                found = each.unit;
            }
    return found;
}

std::string_view unknown_speed_unit(std::string_view name) {
    const std::string_view inside = in_brackets(trim(name));
    const bool as_unit = inside.find('/') != std::string_view::npos;
    return as_unit && !find_unit(inside, Quantity::speed) ? inside : std::string_view();
}

std::string_view without_unit(std::string_view name) {
    name = trim(name);
    return trim(name.substr(0, brackets_of(name)));
}

std::string letters_of(std::string_view name) {
    std::string text = lower_case(without_unit(name));
    std::erase_if(text, [](char c) { return !((c >= 'a' && c <= 'z') || is_digit(c)); });
    return text;
}

std::optional<Unit> take_unit(std::string_view& cell, Quantity quantity) {
    if (cell.empty() || is_digit(cell.back()) || cell.back() == '.') return std::nullopt;
    const std::size_t end =
        std::min(static_cast<std::size_t>(std::ranges::find_if_not(cell, is_number_character) -
                                          cell.begin()),
                 cell.size());
    const std::string_view number = trim(cell.substr(0, end));
    if (number.empty() || !is_digit(number.back())) return std::nullopt;
    const auto unit = find_unit(cell.substr(end), quantity);
    if (unit) cell = number;
    return unit;
}

std::optional<double> number_in(std::string_view cell) {
    if (const auto number = parse_double(cell)) return number;
    for (const Quantity quantity : {Quantity::speed, Quantity::length, Quantity::angle})
        if (take_unit(cell, quantity)) return parse_double(cell);
    return std::nullopt;
}

bool is_missing(std::string_view cell) {
    if (cell.empty()) return true;
    if (is_digit(cell.back()) || cell.size() > 5) return false;
    const std::string lower = lower_case(cell);
    constexpr std::array<std::string_view, 11> words{"-",    "--",  "---", "n/a",  "na", "null",
                                                     "none", "\\n", "nan", "-nan", "nil"};
    return std::ranges::find(words, lower) != words.end();
}

std::optional<Unit> speed_unit_of_ratio(double ratio) {
    for (const Spelled& each : std::span(spelled).first(usual_speeds))
        if (std::abs(ratio * each.unit.factor - 1.0) < 0.07) return each.unit;
    return std::nullopt;
}

}  // namespace runcert
