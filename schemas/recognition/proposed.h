#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace runcert {

struct Recognition;

/// Puts a value where a path of keys ("imu.columns.time") leads, in maps that are made as needed.
void put_at(nlohmann::ordered_json& map, std::string_view path, nlohmann::ordered_json value);

/// The keys of a receiver that a recording suggests, as an attempt has them; numbers as such. Of an
/// IMU's file its key `imu`, without the file.
nlohmann::ordered_json proposed_keys(const Recognition& is);

}  // namespace runcert
