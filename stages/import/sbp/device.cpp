#include "stages/import/sbp/device.h"

#include "core/text.h"

namespace runcert {

std::string locosys_device(std::string_view file_id) {
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
