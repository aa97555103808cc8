#include "store/yaml_input.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
std::string yaml_place(const std::string& where, const YamlNode& node) {
    const YamlMark mark = node.mark();
    if (mark.line < 0) return where;
    return fmt::format("{}:{}:{}", where, mark.line + 1, mark.column + 1);
}

YamlValue::YamlValue(YamlNode node, std::string where, std::string path)
    : YamlValue(std::move(node), std::make_shared<const std::string>(std::move(where)),
                std::move(path)) {}

YamlValue::YamlValue(YamlNode node, std::shared_ptr<const std::string> where, std::string path)
    : node_(std::move(node)), where_(std::move(where)), path_(std::move(path)) {}

void YamlValue::fail(const std::string& what, const std::string& remedy) const {
    throw Failure(place(), path_.empty() ? what : path_ + ": " + what, remedy);
}

YamlValue YamlValue::operator[](std::string_view key) const {
    std::string path = path_;
    if (!path.empty()) path += '.';
    path += key;
    return {node_[key], where_, std::move(path)};
}

std::string_view YamlValue::scalar(const char* expected) const {
    if (!exists()) fail("is missing", fmt::format("Give {}", expected));
    if (!node_.is_scalar())
        fail(fmt::format("is a {}, not {}", node_.is_map() ? "map" : "list", expected),
             fmt::format("Give {}", expected));
    return node_.scalar();
}

std::string YamlValue::text() const {
    return std::string(scalar("text"));
}

double YamlValue::real() const {
    const std::string_view value = scalar("a number");
    const auto number = parse_double(value);
    if (const auto point = with_decimal_point(value); point && !node_.is_quoted())
        fail(fmt::format("\"{}\" is not a number: it has a decimal comma",
                         escape_for_message(value)),
             fmt::format("Write it with a decimal point: {}", *point));
    if (node_.is_quoted() || !number)
        fail(fmt::format("\"{}\" is not a number", escape_for_message(value)),
             "Write a plain decimal number, with a point and without quotes or units");
    return *number;
}

std::int64_t YamlValue::integer() const {
    const std::string_view value = scalar("a whole number");
    const auto number = parse_integer(value);
    if (node_.is_quoted() || !number)
        fail(fmt::format("\"{}\" is not a whole number", escape_for_message(value)),
             "Write a whole number without quotes");
    return *number;
}

bool YamlValue::boolean() const {
    const std::string_view value = scalar("true or false");
    if (node_.is_quoted() || (value != "true" && value != "false"))
        fail(fmt::format("\"{}\" is neither true nor false", escape_for_message(value)),
             "Write true or false");
    return value == "true";
}

std::vector<YamlValue> YamlValue::list() const {
    if (!exists()) return {};
    if (!is_list()) fail("is not a list", "Write a list: [a, b] or lines that begin with -");
    std::vector<YamlValue> items;
    items.reserve(node_.size());
    for (std::size_t i = 0; i < node_.size(); ++i)
        items.push_back({node_.item(i), where_, fmt::format("{}[{}]", path_, i)});
    return items;
}

std::vector<std::string> YamlValue::keys() const {
    std::vector<std::string> names;
    if (is_map())
        for (std::size_t i = 0; i < node_.size(); ++i)
            names.emplace_back(node_.key(i).scalar());
    return names;
}

std::optional<double> YamlValue::optional_real() const {
    return exists() ? std::optional(real()) : std::nullopt;
}
std::optional<std::int64_t> YamlValue::optional_integer() const {
    return exists() ? std::optional(integer()) : std::nullopt;
}

}  // namespace runcert
