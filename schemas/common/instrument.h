#pragma once

#include <string>

#include "schemas/common/codec.h"

namespace runcert {

/// What recorded: a receiver or logger, and its antenna. What is not known is empty.
struct Instrument {
    std::string make = {};
    std::string model = {};
    std::string serial = {};
    std::string firmware = {};
    std::string antenna = {};

    bool empty() const { return *this == Instrument{}; }
    bool operator==(const Instrument&) const = default;
};

template <>
nlohmann::ordered_json members_json(const Instrument& instrument);
template <>
Instrument read_members(const YamlValue& map);

}  // namespace runcert
