#include "store/yaml_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

bool is_plain_word(const std::string& text) {
    if (text.empty() || text.size() > 120) return false;
    static constexpr const char* reserved[] = {"true", "false", "null", "yes", "no", "on",
                                               "off",  "y",     "n",    "nan", "inf"};
    const std::string lower = lower_case(text);
    return has_only(text.substr(0, 1), "") && !is_digit(text.front()) && has_only(text, "_-./") &&
           std::find(std::begin(reserved), std::end(reserved), lower) == std::end(reserved);
}

[[noreturn]] void refuse_not_finite() {
    throw Failure("document", "a result is not a finite number",
                  "This is a fault of the program or of its input; please report it with the run "
                  "folder");
}

/// The shortest decimal that reads back equal. (nlohmann's own is a digit or two longer for one
/// number in a thousand: 40.146414342999996.)
std::string real_text(double value) {
    if (!std::isfinite(value)) refuse_not_finite();
    std::string text = fmt::format("{}", value);
    // YAML 1.1 takes 1e-06 for text, 1.0e-06 for a number; and 1 for an integer.
    if (text.find('.') == std::string::npos)
        text.insert(std::min(text.find('e'), text.size()), ".0");
    return text;
}

/// Letters and signs stand as they are ("±"), what cannot be seen or would steer a terminal as
/// escapes. JSON's escapes are YAML's too, but for characters beyond U+FFFF: JSON writes them as
/// two surrogates (\ud83d\ude00), YAML as one number (\U0001f600).
std::string quoted_text(const std::string& value, YamlLetters letters) {
    if (letters == YamlLetters::any && plain_text(value) == value &&
        value.find(utf8_mark) == std::string::npos)
        return Json(value).dump(-1, ' ', false, Json::error_handler_t::replace);
    const std::string json = Json(value).dump(-1, ' ', true, Json::error_handler_t::replace);
    const auto unit = [&json](std::size_t at) {
        return static_cast<unsigned>(std::stoul(json.substr(at + 2, 4), nullptr, 16));
    };
    std::string text;
    for (std::size_t at = 0; at < json.size();) {
        if (json[at] != '\\') {
            text += json[at++];
        } else if (json[at + 1] != 'u' || unit(at) < 0xD800 || unit(at) > 0xDFFF) {
            text.append(json, at, 2);
            at += 2;
        } else {
            text += fmt::format("\\U{:08x}",
                                0x10000 + ((unit(at) - 0xD800) << 10U) + (unit(at + 6) - 0xDC00));
            at += 12;
        }
    }
    return text;
}

std::string scalar_text(const YamlNode& scalar, YamlLetters letters) {
    const std::string text(scalar.scalar());
    return scalar.is_quoted() && !is_plain_word(text) ? quoted_text(text, letters) : text;
}

void write(const YamlNode& node, std::size_t indent, YamlLetters letters, std::string& out) {
    for (std::size_t i = 0; i < node.size(); ++i) {
        const YamlNode value = node.is_map() ? node.value(i) : node.item(i);
        out += std::string(indent, ' ') +
               (node.is_map() ? scalar_text(node.key(i), letters) + ":" : "-");
        if (value.is_scalar()) {
            out += ' ' + scalar_text(value, letters) + '\n';
        } else if (value.size() == 0) {
            out += value.is_map() ? " {}\n" : value.is_list() ? " []\n" : " null\n";
        } else if (node.is_list() && value.is_map()) {
            std::string block;
            write(value, indent + 2, letters, block);
            out += ' ' + block.substr(indent + 2);
        } else {
            out += '\n';
            write(value, indent + 2, letters, out);
        }
    }
}

void build(const Json& value, YamlBuilder& builder) {
    if (value.is_structured()) {
        builder.begin(value.is_object() ? YamlKind::map : YamlKind::list, {});
        for (const auto& [key, member] : value.items()) {
            if (value.is_object()) builder.scalar(key, !is_plain_word(key), {});
            build(member, builder);
        }
        (void)builder.end();
    } else if (value.is_null()) {
        builder.null({});
    } else if (value.is_string()) {
        const auto& text = value.get_ref<const std::string&>();
        builder.scalar(text, !is_plain_word(text), {});
    } else {
        builder.scalar(value.is_number_float() ? real_text(value.get<double>()) : value.dump(),
                       false, {});
    }
}

}  // namespace

YamlNode yaml_node_of(const Json& document) {
    YamlBuilder builder;
    build(document, builder);
    return std::move(builder).take();
}

std::string plain_yaml_text(const YamlNode& map) {
    std::string out;
    write(map, 0, YamlLetters::any, out);
    return out;
}

std::string to_yaml_text(const Json& document, YamlLetters letters) {
    const YamlNode root = yaml_node_of(document);
    if (root.is_scalar()) return scalar_text(root, letters) + '\n';
    if (root.size() == 0) return document.dump() + '\n';
    std::string out;
    write(root, 0, letters, out);
    return out;
}

}  // namespace runcert
