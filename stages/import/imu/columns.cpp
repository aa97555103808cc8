#include "stages/import/imu/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/text.h"

namespace runcert::imu {
namespace {

/// Letters and digits of a name, in lower case, with its unit: "gyroxdegs" of "Gyro X (deg/s)".
std::string plain_name(std::string_view name) {
    std::string plain;
    for (const char c : lower_case(name))
        if (is_digit(c) || (c >= 'a' && c <= 'z')) plain += c;
    return plain;
}

/// A unit as names end with it, and as an attempt writes it.
struct NamedUnit {
    std::string_view ending, unit;
};
constexpr std::array<NamedUnit, 9> gyro_units{{{"rads", "rad/s"},
                                               {"radps", "rad/s"},
                                               {"rps", "rad/s"},
                                               {"radsec", "rad/s"},
                                               {"degs", "deg/s"},
                                               {"degps", "deg/s"},
                                               {"dps", "deg/s"},
                                               {"degsec", "deg/s"},
                                               {"", ""}}};
constexpr std::array<NamedUnit, 6> accelerometer_units{
    {{"ms2", "m/s2"}, {"mps2", "m/s2"}, {"mss", "m/s2"}, {"msec2", "m/s2"}, {"g", "g"}, {"", ""}}};
constexpr std::array<NamedUnit, 8> time_units{{{"us", "us"},
                                               {"ms", "ms"},
                                               {"msec", "ms"},
                                               {"ns", "ns"},
                                               {"nanos", "ns"},
                                               {"sec", "s"},
                                               {"s", "s"},
                                               {"", ""}}};
/// Longer ones first: of what begins a name the longest counts.
constexpr std::array<std::string_view, 8> gyro_stems{
    "angularvelocity", "angularrate", "rotationrate", "gyroscope", "gyro", "gyr", "w", "g"};
constexpr std::array<std::string_view, 7> accelerometer_stems{
    "accelerometer", "specificforce", "acceleration", "accel", "acc", "f", "a"};
constexpr std::array<std::string_view, 8> time_stems{"hosttime", "timestamp", "systime", "elapsed",
                                                     "time",     "stamp",     "tick",    "t"};

/// An axis and the unit's word of a name; nothing for another name.
template <class Stems, class Units>
std::optional<std::pair<int, std::string_view>> axis_of(std::string_view name, const Stems& stems,
                                                        const Units& units) {
    for (const std::string_view stem : stems)
        for (int axis = 0; axis < 3; ++axis) {
            const char letter = "xyz"[axis];
            for (const std::string& beginning :
                 {fmt::format("{}{}", stem, letter), fmt::format("{}{}", letter, stem)})
                if (name.starts_with(beginning))
                    for (const NamedUnit& unit : units)
                        if (name.substr(beginning.size()) == unit.ending)
                            return std::pair(axis, unit.unit);
        }
    return std::nullopt;
}

std::optional<std::string_view> time_unit_of(std::string_view name) {
    for (const std::string_view stem : time_stems)
        if (name.starts_with(stem))
            for (const NamedUnit& unit : time_units)
                if (name.substr(stem.size()) == unit.ending) return unit.unit;
    return std::nullopt;
}

constexpr std::array<const char*, 3> gyro_keys{"gyro_x", "gyro_y", "gyro_z"};
constexpr std::array<const char*, 3> accelerometer_keys{"accelerometer_x", "accelerometer_y",
                                                        "accelerometer_z"};

std::optional<FoundColumns> by_names(const csv::SeenTable& table) {
    FoundColumns found{.columns = {}, .by_names = true};
    for (const Cell& cell : table.head.names) {
        const std::string name = plain_name(cell.text);
        const std::string written(cell.text);
        if (const auto gyro = axis_of(name, gyro_stems, gyro_units)) {
            found.columns.emplace(gyro_keys[static_cast<std::size_t>(gyro->first)], written);
            if (!gyro->second.empty()) found.gyro_unit = gyro->second;
        } else if (const auto force = axis_of(name, accelerometer_stems, accelerometer_units)) {
            found.columns.emplace(accelerometer_keys[static_cast<std::size_t>(force->first)],
                                  written);
            if (!force->second.empty()) found.accelerometer_unit = force->second;
        } else if (const auto unit = time_unit_of(name)) {
            if (found.columns.emplace("time", written).second) found.time_unit = *unit;
        }
    }
    if (found.columns.size() < 7 || !found.columns.contains("time")) return std::nullopt;
    return found;
}

/// The columns of the rows as numbers; nothing where a cell is none.
std::optional<std::vector<std::vector<double>>> numbers_of(const csv::SeenTable& table) {
    // A file may begin within a line.
    const std::size_t columns = table.rows.back().size();
    std::vector<std::vector<double>> numbers(columns);
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        if (table.rows[row].size() != columns && row == 0) continue;
        if (table.rows[row].size() != columns) return std::nullopt;
        for (std::size_t i = 0; i < columns; ++i) {
            const auto number = parse_double(table.rows[row][i].text);
            if (!number) return std::nullopt;
            numbers[i].push_back(*number);
        }
    }
    return numbers;
}

bool only_grows(const std::vector<double>& values) {
    return std::ranges::is_sorted(values) && values.back() > values.front();
}

/// Whether three columns are accelerometers: of one length, that of gravity in g or m/s^2.
bool is_gravity(std::span<const std::vector<double>> three) {
    double sum = 0.0, squares = 0.0;
    const auto n = static_cast<double>(three[0].size());
    for (std::size_t i = 0; i < three[0].size(); ++i) {
        const double length = std::hypot(three[0][i], three[1][i], three[2][i]);
        sum += length / n;
        squares += length * length / n;
    }
    const auto near = [&](double gravity) { return std::abs(sum / gravity - 1.0) < 0.2; };
    constexpr double steady = 0.25;
    return (near(1.0) || near(9.81)) &&
           std::sqrt(std::max(squares - sum * sum, 0.0)) < steady * sum;
}

/// Fewer may be of one length by chance.
constexpr std::size_t least_rows = 20;

std::optional<FoundColumns> by_numbers(const csv::SeenTable& table) {
    const auto numbers = numbers_of(table);
    if (!numbers || numbers->size() != 7 || numbers->front().size() < least_rows)
        return std::nullopt;
    std::optional<std::size_t> time;
    for (const std::size_t i : {std::size_t{0}, std::size_t{6}})
        if (only_grows((*numbers)[i]) && !time) time = i;
    if (!time) return std::nullopt;
    const std::size_t begin = *time == 0 ? 1 : 0;
    const std::span<const std::vector<double>> six(numbers->data() + begin, 6);
    const bool first = is_gravity(six.first(3)), second = is_gravity(six.subspan(3));
    if (first == second) return std::nullopt;
    FoundColumns found;
    found.columns.emplace("time", std::to_string(*time + 1));
    for (std::size_t i = 0; i < 3; ++i) {
        found.columns.emplace(accelerometer_keys[i], std::to_string(begin + i + (first ? 1 : 4)));
        found.columns.emplace(gyro_keys[i], std::to_string(begin + i + (first ? 4 : 1)));
    }
    return found;
}

}  // namespace

std::optional<FoundColumns> find_imu_columns(const csv::SeenTable& table) {
    return table.has_names ? by_names(table) : by_numbers(table);
}

}  // namespace runcert::imu
