#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "schemas/generator/declaration.h"

namespace runcert {
namespace {

/// What a declaration says for C++ alone, or in other words than a field table.
constexpr std::array<std::string_view, 15> not_of_tables{
    "member", "of",   "item",     "flat",        "initially", "scale", "omit",    "always",
    "about",  "bits", "computed", "item_values", "apart",     "base",  "optional"};

/// Types that a field table knows as texts.
constexpr std::array<std::string_view, 7> kinds_of_text{"gps_time", "satellite", "signal", "date",
                                                        "utc_time", "id",        "role"};

std::string yaml_text(const YamlNode& node) {
    if (node.is_list()) {
        std::string out;
        for (std::size_t i = 0; i < node.size(); ++i)
            out += (i ? ", " : "") + yaml_text(node.item(i));
        return "[" + out + "]";
    }
    if (node.is_map()) {
        std::string out;
        for (std::size_t i = 0; i < node.size(); ++i)
            out += fmt::format("{}{}: {}", i ? ", " : "", node.key(i).scalar(),
                               yaml_text(node.value(i)));
        return "{" + out + "}";
    }
    return node.is_quoted() ? in_quotes(node.scalar()) : std::string(node.scalar());
}

class Table {
  public:
    explicit Table(const Declaration& declaration) : declaration_(declaration) {}

    void fields(const DeclaredStruct& made, const std::string& prefix, const std::string& unit) {
        for (const YamlValue& rule : made.rules)
            add_rule(prefix, rule, made);
        const auto& top = declaration_.top();
        for (std::size_t i = 0; i < top.names.size(); ++i)
            if (top.names[i] == made.rules_of)
                for (const YamlValue& rule : declaration_.map(top.fields[i]["type"].text())->rules)
                    add_rule(prefix, rule, made, made.rules_of);
        for (std::size_t i = 0; i < made.fields.size(); ++i)
            field(prefix, made.names[i], made.fields[i], unit);
    }

    /// The rules, each with the path of the map that it is of. Failure for a key that there is none
    /// of.
    std::string rules() const {
        for (const auto& [place, path] : named_)
            if (!paths_.contains(path)) place.fail("there is no field " + path, "Correct the rule");
        return text_of_rules_.empty() ? "" : "rules:\n" + text_of_rules_;
    }

    void columns() {
        if (declaration_.columns().empty()) return;
        text_ += "columns:\n";
        for (const DeclaredColumn& column : declaration_.columns())
            text_ += "  - {" + facts(column.entry, "") + "}\n";
    }

    std::string take() && { return std::move(text_); }

  private:
    /// A rule of the map whose keys have that prefix; `of`, where it is given, has the keys that
    /// the map itself has not.
    void add_rule(const std::string& prefix, const YamlValue& rule, const DeclaredStruct& map,
                  const std::string& of = {}) {
        const auto key_text = [&](const YamlValue& place, const std::string& key) {
            const bool own = of.empty() || std::ranges::count(map.names, key) > 0;
            std::string used = own || key.starts_with('/') ? key : "/" + of + "." + key;
            named_.emplace_back(place, used.starts_with('/') ? used.substr(1) : prefix + used);
            return used;
        };
        text_of_rules_ +=
            fmt::format("  - {{at: {}", in_quotes(prefix.substr(0, prefix.rfind('.'))));
        for (const std::string& part : rule.keys()) {
            const YamlValue said = rule[part];
            std::vector<std::string> texts;
            if (said.is_list())
                for (const YamlValue& key : said.list())
                    texts.push_back(key_text(key, key.text()));
            for (const std::string& key : said.keys())
                texts.push_back(key_text(said, key) + ": " + yaml_text(said[key].node()));
            text_of_rules_ +=
                fmt::format(", {}: {}", part,
                            said.is_list()  ? fmt::format("[{}]", fmt::join(texts, ", "))
                            : said.is_map() ? fmt::format("{{{}}}", fmt::join(texts, ", "))
                                            : yaml_text(said.node()));
        }
        text_of_rules_ += "}\n";
    }

    /// The entry's facts, but its type's where `type` is given; "*" as a unit is the one of the
    /// field that the map is used for.
    std::string facts(const YamlValue& entry, const std::string& type,
                      const std::string& unit_of_use = {}) const {
        std::string out;
        const auto add = [&](std::string_view key, const std::string& value) {
            if (!out.empty()) out += ", ";
            out += fmt::format("{}: {}", key, value);
        };
        for (const std::string& key : entry.keys()) {
            if (std::ranges::find(not_of_tables, key) != not_of_tables.end()) continue;
            const std::string said = key == "type" ? entry[key].text() : std::string();
            if (key == "unit" && !type.empty()) continue;
            if (key == "unit" && entry[key].text() == "*") {
                if (!unit_of_use.empty()) add(key, unit_of_use);
            } else if (!said.empty() && !type.empty()) {
                add(key, type);
            } else if (said == "file") {
                add(key, "text, names_file: true");
            } else if (said == "elapsed") {
                add(key, "real, unit: s, decimals: 9");
            } else if (std::ranges::find(kinds_of_text, said) != kinds_of_text.end()) {
                add(key, "text");
            } else if (const DeclaredWords* words = declaration_.words(said)) {
                std::string list;
                for (const DeclaredWord& word : words->words)
                    list += (list.empty() ? "" : ", ") + in_quotes(word.word);
                add(key, "text, values: [" + list + "]");
            } else {
                add(key, yaml_text(entry[key].node()));
            }
        }
        return out;
    }

    void line(const std::string& path, const std::string& facts) {
        text_ += fmt::format("  \"{}\": {{{}}}\n", path, facts);
        paths_.insert(path);
    }

    void field(const std::string& prefix, const std::string& name, const YamlValue& entry,
               const std::string& unit_of_use) {
        const std::string path = prefix + name;
        const std::string type = entry["type"].text();
        const std::string unit =
            entry["unit"].exists() ? yaml_text(entry["unit"].node()) : std::string();
        if (const DeclaredStruct* map = declaration_.map(type)) {
            const bool flat = entry["flat"].exists() && entry["flat"].boolean();
            if (!flat) line(path, facts(entry, map->or_text ? "text|map" : "map"));
            fields(*map, flat ? prefix : path + ".", unit);
        } else if (type == "files" || (type == "list" && entry["of"].exists())) {
            line(path, facts(entry, type == "files" ? "text|list, names_file: true" : "list"));
            const std::string of = entry["of"].text_or("text");
            const DeclaredStruct* item = declaration_.map(of);
            const YamlValue words = entry["item_values"];
            line(path + "[]",
                 fmt::format("type: {}{}, description: {}", item ? "map" : of,
                             words.exists() ? ", values: " + yaml_text(words.node()) : "",
                             in_quotes(entry["item"].text_or("one of them"))));
            if (item) fields(*item, path + "[].", unit);
        } else if (type == "speed") {
            constexpr std::array<std::pair<const char*, const char*>, 4> units{
                {{"_km_h", "unit: km/h, decimals: 4"},
                 {"_m_s", "unit: m / s, decimals: 6"},
                 {"_knots", "unit: kn, decimals: 4"},
                 {"_mph", "unit: mph, decimals: 4"}}};
            for (const auto& [end, said] : units)
                line(path + end, facts(entry, fmt::format("real, {}", said)));
        } else {
            line(path, facts(entry, "", unit_of_use));
        }
    }

    const Declaration& declaration_;
    std::string text_, text_of_rules_;
    std::set<std::string> paths_;
    std::vector<std::pair<YamlValue, std::string>> named_;  ///< keys of rules, and their paths
};

}  // namespace

std::string field_table_text(const Declaration& declaration) {
    Table table(declaration);
    table.fields(declaration.top(), "", "");
    const std::string rules = table.rules();
    std::string fields = std::move(table).take();
    Table columns(declaration);
    columns.columns();
    return fmt::format(
        "schema: {}\nversion: \"{}\"\nfields:\n{}{}{}", declaration.source()["schema"].text(),
        declaration.source()["version"].text(), fields, std::move(columns).take(), rules);
}

}  // namespace runcert
