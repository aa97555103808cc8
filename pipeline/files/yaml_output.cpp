#include "files/yaml_output.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/text.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

bool is_plain_word(const std::string& text) {
    if (text.empty() || text.size() > 120) return false;
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    const auto inner = [&](char c) {
        return letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.' || c == '/';
    };
    static constexpr const char* reserved[] = {"true", "false", "null", "yes", "no", "on",
                                               "off",  "y",     "n",    "nan", "inf"};
    std::string lower = text;
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return letter(text.front()) && std::all_of(text.begin(), text.end(), inner) &&
           std::find(std::begin(reserved), std::end(reserved), lower) == std::end(reserved);
}

std::string scalar_text(const Json& value) {
    if (value.is_null()) return "null";
    if (value.is_string() && is_plain_word(value.get_ref<const std::string&>()))
        return value.get<std::string>();
    // A JSON string or number is a YAML scalar of the same value; invalid UTF-8 is replaced.
    std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (value.is_number_float()) {
        // YAML 1.1 takes 1e-06 for text, 1.0e-06 for a number.
        const std::size_t exponent = text.find('e');
        if (exponent != std::string::npos && text.find('.') == std::string::npos)
            text.insert(exponent, ".0");
    }
    return text;
}

void write(const Json& value, int indent, std::string& out);

void write_member(const Json& value, int indent, std::string& out) {
    if (value.is_structured() && !value.empty()) {
        out += '\n';
        write(value, indent, out);
    } else if (value.is_structured()) {
        out += value.is_object() ? " {}\n" : " []\n";
    } else {
        out += ' ' + scalar_text(value) + '\n';
    }
}

void write(const Json& value, int indent, std::string& out) {
    const std::string blanks(static_cast<std::size_t>(indent), ' ');
    if (value.is_object()) {
        for (const auto& [key, member] : value.items()) {
            out += blanks + scalar_text(Json(key)) + ':';
            write_member(member, indent + 2, out);
        }
        return;
    }
    for (const Json& item : value) {
        out += blanks + '-';
        if (item.is_object() && !item.empty()) {
            std::string block;
            write(item, indent + 2, block);
            out += ' ' + block.substr(static_cast<std::size_t>(indent) + 2);
        } else {
            write_member(item, indent + 2, out);
        }
    }
}

}  // namespace

std::string to_yaml_text(const Json& document) {
    std::string out;
    if (!document.is_structured() || document.empty()) return scalar_text(document) + '\n';
    write(document, 0, out);
    return out;
}

double rounded(double value, int decimals) {
    return parse_double(format_fixed(value, decimals)).value();
}

}  // namespace runcert
