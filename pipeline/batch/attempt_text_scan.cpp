#include "batch/attempt_text_scan.h"

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "files/yaml_input.h"
#include "schemas/common/strict_texts.h"

namespace runcert {
namespace {

bool is_plain(std::string_view value) {
    return !value.empty() && std::all_of(value.begin(), value.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view("_-./").find(c) != std::string_view::npos;
    });
}

/// The value on a line after its key, without quotes and comment.
std::string_view value_on_line(std::string_view rest) {
    if (const std::size_t comment = rest.find(" #"); comment != std::string_view::npos)
        rest = rest.substr(0, comment);
    rest = trim(rest);
    const bool quoted = rest.size() >= 2 && (rest.front() == '"' || rest.front() == '\'') &&
                        rest.back() == rest.front();
    return quoted ? rest.substr(1, rest.size() - 2) : rest;
}

/// The value of a key that begins a line, of letters, digits and _ - . / alone; nothing where there
/// is none such, or more than one line begins with the key.
std::optional<std::string> top_value(std::string_view text, std::string_view key) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    std::optional<std::string> found;
    for (bool more = !text.empty(); more;) {
        const std::size_t end = text.find('\n');
        const std::string_view line = text.substr(0, end);
        more = end != std::string_view::npos;
        if (more) text.remove_prefix(end + 1);
        if (!line.starts_with(key) || !line.substr(key.size()).starts_with(": ")) continue;
        const std::string_view value = value_on_line(line.substr(key.size() + 1));
        if (found || !is_plain(value)) return std::nullopt;
        found = std::string(value);
    }
    return found;
}

}  // namespace

std::string written_schema(std::string_view text) {
    if (auto schema = top_value(text, "schema")) return *schema;
    // Parsing is slow, and a folder may hold any number of YAML files of other programs.
    if (text.find("attempt/") == std::string_view::npos &&
        text.find("day/") == std::string_view::npos)
        return {};
    try {
        const YamlValue document(parse_yaml(text, "file"), "file");
        return document.is_map() ? document["schema"].text_or("") : "";
    } catch (const Failure&) {
        return {};
    }
}

std::optional<std::string> quick_id(std::string_view text) {
    auto id = top_value(text, "id");
    return id && is_id(*id) ? id : std::nullopt;
}

}  // namespace runcert
