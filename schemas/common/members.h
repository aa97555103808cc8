#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/speed_unit.h"
#include "core/text.h"
#include "schemas/common/codec.h"
#include "schemas/common/header.h"
#include "store/yaml_input.h"

// How generated codecs convert a member of a struct to an entry of a document's map, and back. An
// enumeration needs `to_text(Enum)` and `bool from_text(std::string_view, Enum&)`.

namespace runcert {

namespace member {

template <class T>
struct Unwrapped {
    using type = T;
    static constexpr bool optional = false, list = false;
};
template <class T>
struct Unwrapped<std::optional<T>> {
    using type = T;
    static constexpr bool optional = true, list = false;
};
template <class T>
struct Unwrapped<std::vector<T>> {
    using type = T;
    static constexpr bool optional = false, list = true;
};

template <class T>
nlohmann::ordered_json json_of(const T& value) {
    if constexpr (Unwrapped<T>::list) {
        auto list = nlohmann::ordered_json::array();
        for (const auto& item : value)
            list.push_back(json_of(item));
        return list;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
        return value;
    } else if constexpr (std::is_enum_v<T>) {
        return std::string(to_text(value));
    } else {
        return members_json(value);
    }
}

/// Writes a value. Empty texts, empty optionals and infinite ones are left out of the file.
template <class T>
void write(nlohmann::ordered_json& map, const char* name, const T& value) {
    if constexpr (std::is_same_v<T, std::optional<double>>) {
        if (value && !std::isinf(*value)) map[name] = *value;
    } else if constexpr (Unwrapped<T>::optional) {
        if (value) write(map, name, *value);
    } else if constexpr (std::is_same_v<T, std::string>) {
        if (!value.empty()) map[name] = value;
    } else if constexpr (std::is_same_v<T, GpsTime>) {
        map[name] = to_iso(value, 9);
    } else {
        map[name] = json_of(value);
    }
}

template <class T>
T read(const YamlValue& value) {
    if constexpr (std::is_same_v<T, std::optional<GpsTime>>) {
        return read_gps_time(value);
    } else if constexpr (std::is_same_v<T, GpsTime>) {
        return *read_gps_time(value);
    } else if constexpr (Unwrapped<T>::optional) {
        return read<typename Unwrapped<T>::type>(value);
    } else if constexpr (Unwrapped<T>::list) {
        T list;
        for (const YamlValue& item : value.list())
            list.push_back(read<typename Unwrapped<T>::type>(item));
        return list;
    } else if constexpr (std::is_same_v<T, bool>) {
        return value.boolean();
    } else if constexpr (std::is_integral_v<T>) {
        return value.integer();
    } else if constexpr (std::is_floating_point_v<T>) {
        return value.real();
    } else if constexpr (std::is_same_v<T, std::string>) {
        return value.text();
    } else if constexpr (std::is_enum_v<T>) {
        T word{};
        if (!from_text(value.text(), word))
            value.fail("\"" + escape_for_message(value.text()) + "\" is not one of the known words",
                       take_the_original);
        return word;
    } else {
        return read_members<T>(value);
    }
}

/// Reads the member with this name, if the map has it.
template <class T>
void take(const YamlValue& map, const char* name, T& value) {
    if (const YamlValue found = map[name]; found.exists()) value = read<T>(found);
}

/// Reads a struct whose members are in the map of the struct that contains it.
template <class T>
void take_all(const YamlValue& map, T& value) {
    value = read_members<T>(map);
}

/// Writes a speed in the four units people use.
inline void put_speed(nlohmann::ordered_json& map, const std::string& name,
                      const std::optional<double>& speed_m_s) {
    if (!speed_m_s) return;
    map[name + "_km_h"] = *speed_m_s * km_h_per_m_s;
    map[name + "_m_s"] = *speed_m_s;
    map[name + "_knots"] = *speed_m_s * 3600.0 / metres_per_nautical_mile;
    map[name + "_mph"] = *speed_m_s * 3600.0 / metres_per_statute_mile;
}
template <class T>
void take_speed(const YamlValue& map, const std::string& name, T& speed_m_s) {
    take(map, (name + "_m_s").c_str(), speed_m_s);
}

}  // namespace member

}  // namespace runcert
