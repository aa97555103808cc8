#include "schemas/generator/declaration.h"

#include <array>
#include <utility>

#include "store/atomic_file.h"

namespace runcert {
namespace {

YamlValue parsed(const std::filesystem::path& path) {
    return {parse_yaml(read_file(path), path.string()), path.string()};
}

DeclaredWords read_words(const std::string& name, const YamlValue& entry) {
    DeclaredWords words{.name = name,
                        .about = entry["about"].text(),
                        .words = {},
                        .each = entry["each"].text_or("")};
    const YamlValue list = entry["words"];
    for (const std::string& word : list.keys()) {
        const YamlValue said = list[word];
        if (!said.is_map()) {
            words.words.push_back({word, word, said.text(), {}});
            continue;
        }
        DeclaredWord& made = words.words.emplace_back(
            DeclaredWord{word, said["enumerator"].text_or(word), said["description"].text(),
                         said["phrase"].text_or("")});
        for (const std::string& key : said.keys())
            if (said[key].is_list())
                for (const YamlValue& item : said[key].list())
                    made.lists[key].push_back(item.text());
    }
    return words;
}

void add_fields(const YamlValue& fields, DeclaredStruct& made) {
    for (const std::string& key : fields.keys()) {
        made.names.push_back(key);
        made.fields.push_back(fields[key]);
    }
}

DeclaredStruct read_struct(const std::string& name, const YamlValue& entry) {
    DeclaredStruct made{.name = name,
                        .about = entry["about"].text(),
                        .fields = {},
                        .names = {},
                        .by_hand = is_set(entry, "by_hand"),
                        .comparable = is_set(entry, "comparable"),
                        .or_text = is_set(entry, "or_text"),
                        .placed = entry["placed"].text_or(""),
                        .compact = is_set(entry, "compact"),
                        .rules = entry["rules"].list(),
                        .rules_of = entry["rules_of"].text_or("")};
    for (const YamlValue& function : entry["functions"].list())
        made.functions.push_back(function.text());
    add_fields(entry["fields"], made);
    for (const YamlValue& column : entry["columns"].list()) {
        made.names.push_back(column["name"].text());
        made.fields.push_back(column);
    }
    return made;
}

template <class Item>
const Item* find(const std::map<std::string, Item>& items, const std::string& name) {
    const auto found = items.find(name);
    return found == items.end() ? nullptr : &found->second;
}

/// What the name of a column's member ends with, by the column's unit.
constexpr std::array<std::pair<std::string_view, std::string_view>, 10> column_units{
    {{"m", "_m"},
     {"m / s", "_m_s"},
     {"m / s2", "_m_s2"},
     {"s", "_s"},
     {"deg", "_deg"},
     {"deg / s", "_deg_s"},
     {"rad / s", "_rad_s"},
     {"cycle", "_cycles"},
     {"Hz", "_hz"},
     {"dB Hz", "_db_hz"}}};

}  // namespace

bool is_set(const YamlValue& entry, std::string_view key) {
    return entry[key].exists() && entry[key].boolean();
}

Declaration::Declaration(const std::string& path, const std::filesystem::path& products) {
    source_ = parsed(path);
    folder_ = std::filesystem::path(path).parent_path().filename().string();
    const std::string extended = source_["row"]["extends"].text_or("");
    for (const YamlValue& product : source_["uses"].list()) {
        const YamlValue other = parsed(products / product.text() / "v1.yaml");
        read(other, false);
        if (product.text() != extended) continue;
        extended_row_ = other["row"]["name"].text();
        read_columns(other, true);
    }
    read(source_, true);
    read_columns(source_, false);
}

void Declaration::read_columns(const YamlValue& table, bool inherited) {
    for (const YamlValue& entry : table["columns"].list()) {
        if (!entry["group"].exists()) {
            columns_.push_back({entry, nullptr, {}, inherited});
            continue;
        }
        const DeclaredStruct* columns = group(entry["group"].text());
        if (!columns) entry["group"].fail("is no group of columns", "Declare it under groups");
        for (const YamlValue& column : columns->fields)
            columns_.push_back({column, columns, entry["member"].text_or(""), inherited});
    }
}

void Declaration::read(const YamlValue& table, bool own) {
    const auto each = [&](const char* section, auto make, auto& all, auto& mine) {
        for (const std::string& name : table[section].keys()) {
            auto made = make(name, table[section][name]);
            if (own) mine.push_back(made);
            all.insert_or_assign(name, std::move(made));
        }
    };
    each("words", read_words, words_, own_words_);
    each("maps", read_struct, maps_, own_maps_);
    each("groups", read_struct, groups_, own_groups_);
    if (!own) return;
    for (const char* const holder : {"struct", "input"})
        if (const YamlValue named = table[holder]; named.exists())
            top_ = read_struct(named["name"].text(), named);
    top_.rules = table["rules"].list();
    add_fields(table["fields"], top_);
}

const DeclaredWords* Declaration::words(const std::string& name) const {
    return find(words_, name);
}
const DeclaredStruct* Declaration::map(const std::string& name) const {
    return find(maps_, name);
}
const DeclaredStruct* Declaration::group(const std::string& name) const {
    return find(groups_, name);
}

std::string member_name(const std::string& field, const YamlValue& entry) {
    if (entry["member"].exists()) return entry["member"].text();
    if (entry["type"].text() == "speed") return field + "_m_s";
    return field;
}

std::string column_member_name(const YamlValue& column) {
    if (column["member"].exists()) return column["member"].text();
    const std::string name = column["name"].text();
    if (column["type"].text() == "elapsed") return name;
    const std::string unit = column["unit"].text_or("");
    for (const auto& [known, end] : column_units)
        if (unit == known) return name + std::string(end);
    return name;
}

std::string in_quotes(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + "\"";
}

}  // namespace runcert
