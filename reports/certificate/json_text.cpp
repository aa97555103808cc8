#include "reports/certificate/json_text.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t indentation = 2;

bool is_list_of_numbers(const Json& json) {
    return json.is_array() && !json.empty() &&
           std::all_of(json.begin(), json.end(),
                       [](const Json& item) { return item.is_number() || item.is_null(); });
}

std::string one_line(const Json& json) {
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string out;
    out.reserve(text.size());
    for (const char c : text)
        if (c == '<')
            out += "\\u003c";
        else if (c == '>')
            out += "\\u003e";
        else if (c == '&')
            out += "\\u0026";
        else
            out += c;
    return out;
}

void append(std::string& out, const Json& json, std::size_t depth) {
    if (!json.is_structured() || json.empty() || is_list_of_numbers(json)) {
        out += one_line(json);
        return;
    }
    const std::string indent(indentation * (depth + 1), ' ');
    const bool object = json.is_object();
    out += object ? "{\n" : "[\n";
    bool first = true;
    for (const auto& [key, value] : json.items()) {
        if (!first) out += ",\n";
        first = false;
        out += indent;
        if (object) out += one_line(Json(key)) + ": ";
        append(out, value, depth + 1);
    }
    out += '\n' + std::string(indentation * depth, ' ') + (object ? '}' : ']');
}

}  // namespace

std::string report_text_of(const Json& report) {
    std::string out;
    append(out, report, 0);
    return out + '\n';
}

}  // namespace runcert
