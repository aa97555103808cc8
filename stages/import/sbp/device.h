#pragma once

#include <string>
#include <string_view>

#include "core/text.h"

namespace runcert {

/// What a Locosys logger says of itself in its file identification (SiRF message 253): name, serial
/// number, logging rate, firmware, as printable text ("GT-31, 30003117, 1, V1.4"). Empty where
/// there is none.
inline std::string locosys_device(std::string_view file_id) {
    std::string device;
    while (!file_id.empty()) {
        const std::size_t comma = file_id.find(',');
        std::string field;
        for (const char c : file_id.substr(0, comma))
            if (c >= ' ' && c <= '~') field += c;
        const std::string_view trimmed = trim(field);
        if (!trimmed.empty()) {
            if (!device.empty()) device += ", ";
            device += trimmed;
        }
        file_id.remove_prefix(comma == std::string_view::npos ? file_id.size() : comma + 1);
    }
    return device;
}

}  // namespace runcert
