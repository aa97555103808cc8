#include "reports/inspection/described.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "core/text.h"
#include "schemas/attempt/attempt.h"
#include "schemas/recognition/proposed.h"
#include "store/yaml_output.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* left_open = "...";

/// A value on one line, as YAML has it.
std::string in_line(const Json& value) {
    if (value.is_object()) {
        std::vector<std::string> parts;
        for (const auto& [key, one] : value.items())
            parts.push_back(fmt::format("{}: {}", key, in_line(one)));
        return fmt::format("{{{}}}", fmt::join(parts, ", "));
    }
    if (value == left_open) return left_open;
    std::string text = to_yaml_text({{"k", value}}).substr(3);
    text.pop_back();  // the line's end
    // Within braces these end a plain text.
    if (!text.starts_with('"') && text.find_first_of(",[]{}") != std::string::npos)
        return value.dump();
    return text;
}

/// What a line of a needed key looks like, which cannot stand as it is.
Json example_of(const NeededKey& needed) {
    const FieldRule* rule = attempt_schema().find("receivers[]." + needed.key);
    if (!rule || rule->example == left_open) return left_open;
    return json_from_yaml(YamlValue(parse_yaml(rule->example, "the example"), "the example"));
}

/// A map's lines; maps of maps take a line for each of their keys.
std::string lines_of_map(const Json& map, const std::string& blanks) {
    std::string text;
    for (const auto& [key, value] : map.items())
        text += blanks + (key == "imu" || key == "surface"
                              ? fmt::format("{}:\n{}", key, lines_of_map(value, blanks + "  "))
                              : fmt::format("{}: {}\n", key, in_line(value)));
    return text;
}

/// "One of utc, local."
std::string reason_of(const NeededKey& needed) {
    return needed.values.empty()
               ? needed.reason
               : fmt::format("{} One of {}.", needed.reason, fmt::join(needed.values, ", "));
}

std::string said_before_lines(const Recognition& is) {
    if (is.kind == RecordingKind::imu || is.kind == RecordingKind::surface)
        return "An attempt describes it so, beside its receiver's recording:";
    return is.format == "csv" ? "A table that no format recognises. An attempt's receiver may say:"
                              : "An attempt's receiver must say:";
}

Block table_of_keys(const Recognition& is) {
    Block all = table({"Key", "Is", "In", "Why"});
    for (const ProposedKey& one : is.proposed)
        add_row(all, {one.key, one.value, one.unit, one.reason});
    return all;
}

}  // namespace

std::string receiver_lines(const Recognition& is, const std::string& name) {
    Json keys = Json::object();
    if (is.kind == RecordingKind::imu) keys["imu"]["file"] = name;
    if (is.kind == RecordingKind::surface) keys["surface"]["file"] = name;
    keys.update(proposed_keys(is), true);
    for (const NeededKey& needed : is.needed)
        if (needed.required) put_at(keys, needed.key, example_of(needed));
    return is.proposed.empty() && std::ranges::none_of(is.needed, &NeededKey::required)
               ? std::string()
               : lines_of_map(keys, "");
}

Section description_section(const Recognition& is, const std::string& name) {
    Section section{.anchor = "description", .title = "Description"};
    const std::string lines = receiver_lines(is, name);
    if (lines.empty()) return section;
    add(section, {paragraph(said_before_lines(is)), code(lines)});
    if (!is.proposed.empty()) add(section, table_of_keys(is));
    if (!is.unused.empty())
        add(section,
            paragraph(fmt::format("Columns that are not used: {}.", fmt::join(is.unused, ", "))));
    if (!is.problem.empty())
        add(section, paragraph("So described, it cannot be read. " + is.problem, "warning"));
    if (!is.rows.empty() && !(is.proposed.empty() && is.problem.empty()))
        add(section, titled_list(is.problem.empty() ? "First rows, as they are read" : "First row",
                                 is.rows));
    return section;
}

Document description_of(const Recognition& is, const std::string& name) {
    Document document{.title = name, .sections = {}};
    Section description = description_section(is, std::filesystem::path(name).filename().string());
    const bool described = !is.proposed.empty();
    if (!description.blocks.empty()) document.sections.push_back(std::move(description));
    for (const FactGroup& group : is.said) {
        Section& section = document.sections.emplace_back();
        section.anchor = "said-" + std::to_string(document.sections.size());
        section.title = group.title + (described && &group == &is.said.front() &&
                                               is.kind == RecordingKind::positions
                                           ? ", so described"
                                           : "");
        Block all = facts({});
        for (const DescribedFact& fact : group.facts)
            add_fact(all, fact.name, fact.value);
        add(section, std::move(all));
    }
    std::vector<std::string> items;
    for (const NeededKey& needed : is.needed)
        items.push_back(fmt::format("{}{}: {}", needed.key, needed.required ? " (required)" : "",
                                    reason_of(needed)));
    if (!items.empty())
        document.sections.push_back({.anchor = "not-said",
                                     .title = "What it does not say",
                                     .blocks = {list_of(std::move(items))}});
    std::vector<std::string> concerns;
    for (const Concern& concern : is.concerns)
        concerns.push_back(concern.says);
    document.sections.push_back(
        {.anchor = "look-at",
         .title = "To look at",
         .blocks = {concerns.empty() ? paragraph("No obvious problems found.")
                                     : list_of(std::move(concerns))}});
    return document;
}

}  // namespace runcert
