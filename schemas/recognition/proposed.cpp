#include "schemas/recognition/proposed.h"

#include <string>

#include "core/text.h"
#include "schemas/recognition/declared.h"

namespace runcert {

using Json = nlohmann::ordered_json;

void put_at(Json& map, std::string_view path, Json value) {
    const std::size_t point = path.find('.');
    const std::string name(path.substr(0, point));
    if (point == std::string_view::npos)
        map[name] = std::move(value);
    else
        put_at(map[name], path.substr(point + 1), std::move(value));
}

Json proposed_keys(const Recognition& is) {
    Json keys = Json::object();
    if (is.format == "csv" && is.kind != RecordingKind::imu && !is.proposed.empty())
        keys = {{"format", is.format}, {"columns", Json::object()}};
    for (const ProposedKey& one : is.proposed) {
        const auto whole = parse_integer(one.value);
        const auto real = is.kind == RecordingKind::imu ? parse_double(one.value) : std::nullopt;
        put_at(keys, one.key, whole ? Json(*whole) : real ? Json(*real) : Json(one.value));
    }
    return keys;
}

}  // namespace runcert
