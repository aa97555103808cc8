#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/prose.h"
#include "reports/audit/sections.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

/// The field table's rule of a stage's parameter; null where it has none.
const FieldRule* rule_of(const std::string& stage, const std::string& name) {
    if (stage == "import") return attempt_schema().find("receivers[]." + name);
    return attempt_schema().find(fmt::format("parameters.{}.{}", stage, name));
}

Json default_of(const FieldRule& rule, const std::string& craft_class) {
    return json_from_yaml(rule.default_value.is_map() ? rule.default_value[craft_class]
                                                      : rule.default_value);
}

std::string value_text(const Json& value) {
    if (value.is_number_float()) return quantity_text(value.get<double>());
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_array()) return value.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::vector<std::string> items;
    for (const Json& item : value)
        items.push_back(value_text(item));
    return listed(items);
}

bool is_same(const Json& a, const Json& b) {
    return a.is_number() && b.is_number() ? a.get<double>() == b.get<double>() : a == b;
}

std::string set_by(const Attempt& attempt, const std::string& path, bool is_default) {
    const bool stated = path.starts_with("import.") ||  // which has what the attempt states, alone
                        std::ranges::find(attempt.overrides, path) != attempt.overrides.end();
    if (stated) return is_default ? "the attempt, to the default" : "the attempt";
    return is_default ? "default" : "NOT THE ATTEMPT: another program's default, or changed";
}

struct Parameters {
    FactTable table;
    std::int64_t replaced = 0;
};

Parameters parameters_of(const Attempt& attempt, const Header& header, bool all) {
    Parameters found{.table = {.caption = {},
                               .heads = {"parameter", "used", "default", "unit", "set by"},
                               .rows = {}}};
    for (const auto& [name, used] : header.parameters->items()) {
        const FieldRule* rule = rule_of(header.stage, name);
        const Json fallback = rule ? default_of(*rule, attempt.craft.kind) : Json();
        const bool is_default = rule && is_same(used, fallback);
        found.replaced += is_default ? 0 : 1;
        if (!is_default || all)
            found.table.rows.push_back({header.stage + "." + name, value_text(used),
                                        !rule                ? "not known"
                                        : fallback.is_null() ? "none"
                                                             : value_text(fallback),
                                        rule ? rule->unit : "",
                                        set_by(attempt, header.stage + "." + name, is_default)});
    }
    return found;
}

}  // namespace

std::vector<Block> parameter_blocks(const Attempt& attempt, const Header& header, bool all) {
    if (header.parameters->empty()) return {Paragraph{"Parameters. The stage has none."}};
    auto [table, replaced] = parameters_of(attempt, header, all);
    const auto count = static_cast<std::int64_t>(header.parameters->size());
    std::vector<Block> blocks;
    if (replaced == 0)
        blocks.emplace_back(Paragraph{
            fmt::format("Parameters. All {} have the default of the class {}{}.", counted(count),
                        attempt.craft.kind, all ? "" : " (--all lists them)")});
    else
        table.caption = fmt::format("Parameters, {} of {} not the default of the class {}",
                                    counted(replaced), counted(count), attempt.craft.kind);
    if (!table.rows.empty()) blocks.emplace_back(std::move(table));
    return blocks;
}

}  // namespace runcert
