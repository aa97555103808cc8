#include "store/document_schema.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

std::vector<std::string> texts_in(const YamlValue& list) {
    std::vector<std::string> texts;
    for (const YamlValue& one : list.list())
        texts.push_back(one.text());
    return texts;
}

FieldRule read_rule(const std::string& path, const YamlValue& entry) {
    const auto is_set = [&entry](std::string_view key) {
        return entry[key].exists() && entry[key].boolean();
    };
    FieldRule rule{.path = path,
                   .unit = entry["unit"].text_or(""),
                   .required = is_set("required"),
                   .values = texts_in(entry["values"]),
                   .minimum = entry["min"].optional_real(),
                   .maximum = entry["max"].optional_real(),
                   .decimals = static_cast<int>(entry["decimals"].optional_integer().value_or(6)),
                   .default_value = entry["default"],
                   .description = entry["description"].text(),
                   .question = entry["question"].text_or(""),
                   .why = entry["why"].text_or(""),
                   .example = entry["example"].text_or("..."),
                   .always_asked = is_set("always_asked"),
                   .names_file = is_set("names_file"),
                   .apart = is_set("apart"),
                   .series = texts_in(entry["series"]),
                   .before_rule = is_set("before_rule")};
    const std::string types = entry["type"].text();
    for (std::size_t begin = 0; begin <= types.size();) {
        const std::size_t end = std::min(types.find('|', begin), types.size());
        rule.types.push_back(types.substr(begin, end - begin));
        begin = end + 1;
    }
    // What changes nothing has no list: "changes: nothing".
    const auto words = [&](std::string_view key) {
        return entry[key].is_list() ? texts_in(entry[key]) : std::vector<std::string>();
    };
    if (entry["origin"].exists())
        rule.origin = {.origin = entry["origin"].text(),
                       .changes = words("changes"),
                       .decides = words("decides"),
                       .clause = entry["clause"].text_or("")};
    if (entry["read_by"].is_list()) rule.read_by = texts_in(entry["read_by"]);
    return rule;
}

bool has_type(const FieldRule& rule, std::string_view type) {
    return std::find(rule.types.begin(), rule.types.end(), type) != rule.types.end();
}

void check_range(const FieldRule& rule, const YamlValue& value, double number) {
    const std::string unit = rule.unit.empty() ? "" : " " + rule.unit;
    if (rule.minimum && number < *rule.minimum)
        value.fail(fmt::format("{} is below {}{}", number, *rule.minimum, unit),
                   "Give a value in the range");
    if (rule.maximum && number > *rule.maximum)
        value.fail(fmt::format("{} is above {}{}", number, *rule.maximum, unit),
                   "Give a value in the range");
}

void check_values(const FieldRule& rule, const YamlValue& value) {
    if (rule.values.empty()) return;
    const std::string text = value.text();
    if (std::find(rule.values.begin(), rule.values.end(), text) == rule.values.end())
        value.fail(fmt::format("\"{}\" is not one of {}", escape_for_message(text),
                               fmt::join(rule.values, ", ")),
                   "Give one of these");
}

void check_scalar(const FieldRule& rule, const YamlValue& value) {
    if (has_type(rule, "text")) {
        check_values(rule, value);
    } else if (has_type(rule, "integer")) {
        check_range(rule, value, static_cast<double>(value.integer()));
        check_values(rule, value);
    } else if (has_type(rule, "real")) {
        check_range(rule, value, value.real());
    } else if (has_type(rule, "boolean")) {
        value.boolean();
    } else {
        value.fail(fmt::format("is a single value, not a {}", fmt::join(rule.types, " or ")),
                   "See the field table of the schema");
    }
}

std::string field_path(const std::string& path, std::string_view name) {
    std::string whole = path;
    if (!whole.empty()) whole += '.';
    whole += name;
    return whole;
}

/// The path of what a field is in.
std::string_view above(std::string_view path) {
    if (path.ends_with("[]")) return path.substr(0, path.size() - 2);
    const std::size_t point = path.rfind('.');
    return point == std::string_view::npos ? "" : path.substr(0, point);
}

}  // namespace

void DocumentSchema::add(FieldRule rule) {
    const std::size_t index = fields_.size();
    const std::size_t point = rule.path.rfind('.');
    const bool is_top = point == std::string::npos;
    const std::string name = is_top ? rule.path : rule.path.substr(point + 1);
    if (!name.ends_with("[]") && name != "*")
        children_[is_top ? std::string() : rule.path.substr(0, point)].push_back(index);
    by_path_.try_emplace(rule.path, index);
    fields_.push_back(std::move(rule));
}

DocumentSchema DocumentSchema::read(const YamlNode& table, const std::string& where,
                                    const DocumentSchema* common) {
    DocumentSchema schema;
    schema.source_ = YamlValue(table, where);
    schema.name_ = schema.source_["schema"].text();
    schema.version_ = schema.source_["version"].text();
    if (common)
        for (const FieldRule& rule : common->fields_)
            schema.add(rule);
    const YamlValue fields = schema.source_["fields"];
    for (const std::string& path : fields.keys())
        schema.add(read_rule(path, fields[path]));
    return schema;
}

DocumentSchema DocumentSchema::parse(std::string_view text, const std::string& where,
                                     const DocumentSchema* common) {
    return read(parse_yaml(text, where), where, common);
}

const FieldRule* DocumentSchema::find(std::string_view path) const {
    const auto found = by_path_.find(path);
    return found == by_path_.end() ? nullptr : &fields_[found->second];
}

const FieldOrigin* DocumentSchema::origin_of(std::string_view path) const {
    for (; !path.empty(); path = above(path))
        if (const FieldRule* rule = find(path); rule && rule->origin) return &*rule->origin;
    return nullptr;
}

bool DocumentSchema::is_read_by(std::string_view path, std::string_view stage) const {
    for (; !path.empty(); path = above(path))
        if (const FieldRule* rule = find(path); rule && rule->read_by)
            return std::ranges::count(*rule->read_by, stage) > 0;
    return false;
}

YamlNode DocumentSchema::part_read_by(const YamlValue& document, std::string_view stage) const {
    YamlBuilder builder;
    add_part(document.node(), "", stage, builder);
    return std::move(builder).take();
}

bool DocumentSchema::has_part(const YamlNode& node, const std::string& path,
                              std::string_view stage) const {
    if (node.is_map()) {
        for (std::size_t i = 0; i < node.size(); ++i)
            if (has_part(node.value(i), field_path(path, node.key(i).scalar()), stage)) return true;
        return false;
    }
    if (node.is_list() && node.size() > 0 && node.item(0).is_map()) {
        for (std::size_t i = 0; i < node.size(); ++i)
            if (has_part(node.item(i), path + "[]", stage)) return true;
        return false;
    }
    return is_read_by(path, stage);
}

void DocumentSchema::add_part(const YamlNode& node, const std::string& path, std::string_view stage,
                              YamlBuilder& builder) const {
    if (node.is_map()) {
        builder.begin(YamlKind::map, node.mark());
        for (std::size_t i = 0; i < node.size(); ++i) {
            const std::string below = field_path(path, node.key(i).scalar());
            if (!has_part(node.value(i), below, stage)) continue;
            builder.copy(node.key(i));
            add_part(node.value(i), below, stage, builder);
        }
        (void)builder.end();
    } else if (node.is_list() && node.size() > 0 && node.item(0).is_map()) {
        builder.begin(YamlKind::list, node.mark());
        for (std::size_t i = 0; i < node.size(); ++i)
            add_part(node.item(i), path + "[]", stage, builder);
        (void)builder.end();
    } else {
        builder.copy(node);
    }
}

std::vector<std::string_view> DocumentSchema::children(std::string_view path) const {
    std::vector<std::string_view> names;
    const auto found = children_.find(path);
    if (found == children_.end()) return names;
    const std::size_t prefix = path.empty() ? 0 : path.size() + 1;
    for (const std::size_t index : found->second)
        names.push_back(std::string_view(fields_[index].path).substr(prefix));
    return names;
}

/// The check of one document.
class DocumentSchema::Validation {
  public:
    Validation(const DocumentSchema& schema, Completeness completeness)
        : schema_(schema), completeness_(completeness) {}

    void map(const YamlValue& map, const std::string& path) const {
        const YamlNode& node = map.node();
        const std::vector<std::string_view> known = schema_.children(path);
        for (std::size_t i = 0; i < node.size(); ++i) {
            const std::string_view key = node.key(i).scalar();
            // Not by the whole path: a key may be written "craft.name", which is no field.
            if (std::find(known.begin(), known.end(), key) != known.end()) {
                value(map[key], field_path(path, key));
            } else if (const std::string any = field_path(path, "*"); schema_.find(any)) {
                value(map[key], any);
            } else {
                if (i > 0) refuse_decimal_comma(map, i);
                refuse_key(map, node.key(i), path, known);
            }
        }
        if (completeness_ == Completeness::begun) return;
        for (const std::string_view name : known) {
            const FieldRule& rule = *schema_.find(field_path(path, name));
            if (rule.required && node[name].is_null())
                map.fail(fmt::format("the key \"{}\" is missing ({})", name, rule.description),
                         "Add it");
        }
    }

  private:
    /// Between braces a decimal comma parts a number: {speed: 440,5} has the key 5.
    static void refuse_decimal_comma(const YamlValue& map, std::size_t unknown) {
        const YamlNode number = map.node().value(unknown - 1);
        const std::string_view decimals = map.node().key(unknown).scalar();
        const std::string written = fmt::format("{},{}", number.scalar(), decimals);
        if (!map.node().value(unknown).is_null() || number.is_quoted() ||
            !parse_integer(decimals) || !is_digit(decimals.front()) ||
            !parse_integer(number.scalar()))
            return;
        map[map.node().key(unknown - 1).scalar()].fail(
            fmt::format("\"{}\" is not a number: it has a decimal comma",
                        escape_for_message(written)),
            fmt::format("Write it with a decimal point: {}.{}", number.scalar(), decimals));
    }

    [[noreturn]] static void refuse_key(const YamlValue& map, const YamlNode& key,
                                        const std::string& path,
                                        const std::vector<std::string_view>& known) {
        const std::string remedy =
            known.empty() ? "Remove it"
                          : fmt::format("Did you mean \"{}\"? Known keys here: {}",
                                        nearest(key.scalar(), known), fmt::join(known, ", "));
        throw Failure(yaml_place(map.where(), key),
                      fmt::format("unknown key \"{}\"{}", escape_for_message(key.scalar()),
                                  path.empty() ? "" : " in " + path),
                      remedy);
    }

    void value(const YamlValue& value, const std::string& path) const {
        const FieldRule& rule = *schema_.find(path);
        if (!value.exists() || rule.apart || has_type(rule, "any")) return;
        if (value.is_map() && has_type(rule, "map")) return map(value, path);
        if (value.is_list() && has_type(rule, "list")) return list(value, path);
        if (value.is_map() || value.is_list())
            value.fail(fmt::format("is a {}, not {}", value.is_map() ? "map" : "list",
                                   fmt::join(rule.types, " or ")),
                       "See the field table of the schema");
        check_scalar(rule, value);
    }

    void list(const YamlValue& list, const std::string& path) const {
        const std::string item_path = path + "[]";
        const FieldRule* rule = schema_.find(item_path);
        if (rule && rule->apart) return;
        for (const YamlValue& item : list.list()) {
            if (!item.exists()) item.fail("is empty", "Give it a value, or remove it");
            if (rule) value(item, item_path);
        }
    }

    const DocumentSchema& schema_;
    Completeness completeness_;
};

void DocumentSchema::validate(const YamlValue& document, Completeness completeness) const {
    if (!document.is_map())
        document.fail("the document is not a map of keys and values",
                      fmt::format("See the field table of {}/{}", name_, version_));
    Validation(*this, completeness).map(document, "");
    check_rules(document, completeness);
}

void DocumentSchema::validate_part(const YamlValue& map, const std::string& path) const {
    if (!map.exists()) map.fail("is empty", "Give it a value, or remove it");
    if (!map.is_map()) map.fail("is not a map", "Write {key: value}; see the field table");
    Validation(*this, Completeness::whole).map(map, path);
}

std::string DocumentSchema::field_table() const {
    std::string out;
    for (const FieldRule& rule : fields_) {
        std::string facts = fmt::format("{}", fmt::join(rule.types, " or "));
        if (!rule.unit.empty()) facts += ", " + rule.unit;
        if (rule.required) facts += ", required";
        if (!rule.values.empty()) facts += fmt::format(", one of: {}", fmt::join(rule.values, " "));
        out += fmt::format("  {:<42} {} ({})\n", rule.path, rule.description, facts);
    }
    return out;
}

}  // namespace runcert
