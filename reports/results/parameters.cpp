#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/figures.h"
#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

std::string value_text(const Json& value) {
    if (value.is_number_float()) return quantity_text(value.get<double>());
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_array()) return value.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::vector<std::string> items;
    for (const Json& item : value)
        items.push_back(value_text(item));
    return listed(items);
}

std::string set_by(const Attempt& attempt, const std::string& path, bool is_default) {
    const bool stated = path.starts_with("import.") ||  // which has what the attempt states, alone
                        std::ranges::find(attempt.overrides, path) != attempt.overrides.end();
    if (stated) return is_default ? "the attempt, to the default" : "the attempt";
    return is_default ? "default" : "NOT THE ATTEMPT: another program's default, or changed";
}

}  // namespace

std::vector<Block> parameter_blocks(const Attempt& attempt,
                                    const std::vector<const Header*>& headers, Level level) {
    Block block = table({"Parameter|30", "Used|16", "Default|16", "Unit|14", "Set by|24"});
    std::int64_t count = 0, replaced = 0;
    for (const Header* header : headers)
        for (const auto& [name, used] : header->parameters->items()) {
            const std::string path = header->stage + "." + name;
            const FieldRule* rule = attempt_schema().find(
                header->stage == "import" ? "receivers[]." + name
                                          : fmt::format("parameters.{}.{}", header->stage, name));
            const Json fallback = rule
                                      ? json_from_yaml(rule->default_value.is_map()
                                                           ? rule->default_value[attempt.craft.kind]
                                                           : rule->default_value)
                                      : Json();
            const bool is_default = rule && used == fallback;
            ++count;
            replaced += is_default ? 0 : 1;
            if (is_default && level != Level::all) continue;
            TableRow& row = add_row(block,
                                    {path, value_text(used),
                                     !rule                ? "not known"
                                     : fallback.is_null() ? "none"
                                                          : value_text(fallback),
                                     rule ? rule->unit : "", set_by(attempt, path, is_default)},
                                    is_default ? "" : "changed");
            // What it means, of what somebody chose.
            if (rule && !is_default) row.further = {sentence(rule->description)};
        }
    if (count == 0) return {paragraph("Parameters. The stage has none.")};
    block.text = fmt::format("Parameters, {} of {} not the default of the class {}",
                             counted(replaced), counted(count), attempt.craft.kind);
    std::vector<Block> blocks;
    if (!block.rows.empty()) blocks.push_back(std::move(block));
    if (level != Level::all)
        blocks.push_back(paragraph(
            fmt::format("{} the default of the class {} (runcert audit --all lists them).",
                        replaced == 0 ? fmt::format("Parameters. All {} have", counted(count))
                                      : "All others have",
                        attempt.craft.kind),
            replaced == 0 ? "" : "note"));
    return blocks;
}

}  // namespace runcert
