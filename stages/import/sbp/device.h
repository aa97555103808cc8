#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/text.h"
#include "schemas/common/declared.h"

namespace runcert {

/// What a Locosys logger says of itself in its file identification (SiRF message 253): name, serial
/// number, logging rate, firmware, as printable text. The name is one that its owner gives it.
inline std::vector<std::string> locosys_identity(std::string_view file_id) {
    std::vector<std::string> fields;
    while (!file_id.empty()) {
        const std::size_t comma = file_id.find(',');
        std::string field;
        for (const char c : file_id.substr(0, comma))
            if (c >= ' ' && c <= '~') field += c;
        fields.emplace_back(trim(field));
        file_id.remove_prefix(comma == std::string_view::npos ? file_id.size() : comma + 1);
    }
    return fields;
}

/// The same in one line, without what is empty: "GT-31, 30003117, 1, V1.4".
inline std::string locosys_device(std::string_view file_id) {
    std::string device;
    for (const std::string& field : locosys_identity(file_id))
        if (!field.empty()) device += (device.empty() ? "" : ", ") + field;
    return device;
}

/// Serial number and firmware, where all four are there.
inline Instrument locosys_instrument(std::string_view file_id) {
    const std::vector<std::string> fields = locosys_identity(file_id);
    if (fields.size() != 4) return {};
    return {.serial = fields[1], .firmware = fields[3]};
}

}  // namespace runcert
