#include "store/document_schema.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

std::optional<FieldOrigin> read_origin(const YamlValue& entry) {
    if (!entry["origin"].exists()) return std::nullopt;
    const auto words = [&entry](std::string_view key) {
        std::vector<std::string> all;
        if (const YamlValue list = entry[key]; list.is_list())
            for (const YamlValue& one : list.list())
                all.push_back(one.text());
        return all;
    };
    return FieldOrigin{.origin = entry["origin"].text(),
                       .changes = words("changes"),
                       .decides = words("decides"),
                       .clause = entry["clause"].text_or("")};
}

FieldRule read_rule(const std::string& path, const YamlValue& entry) {
    FieldRule rule{.path = path, .default_value = entry["default"]};
    const std::string types = entry["type"].text();
    for (std::size_t begin = 0; begin <= types.size();) {
        const std::size_t end = std::min(types.find('|', begin), types.size());
        rule.types.push_back(types.substr(begin, end - begin));
        begin = end + 1;
    }
    rule.unit = entry["unit"].text_or("");
    const auto is_set = [&entry](std::string_view key) {
        return entry[key].exists() && entry[key].boolean();
    };
    rule.required = is_set("required");
    for (const YamlValue& value : entry["values"].list())
        rule.values.push_back(value.text());
    rule.minimum = entry["min"].optional_real();
    rule.maximum = entry["max"].optional_real();
    rule.decimals = static_cast<int>(entry["decimals"].optional_integer().value_or(6));
    rule.description = entry["description"].text();
    rule.question = entry["question"].text_or("");
    rule.why = entry["why"].text_or("");
    rule.example = entry["example"].text_or("...");
    rule.origin = read_origin(entry);
    rule.before_rule = is_set("before_rule");
    rule.always_asked = is_set("always_asked");
    rule.names_file = is_set("names_file");
    rule.apart = is_set("apart");
    for (const YamlValue& quantity : entry["series"].list())
        rule.series.push_back(quantity.text());
    if (const YamlValue stages = entry["read_by"]; stages.is_list()) {
        rule.read_by.emplace();
        for (const YamlValue& stage : stages.list())
            rule.read_by->push_back(stage.text());
    }
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

/// Whether a scalar is as its rule wants it, without the words for what is wrong with it.
bool is_sound(const FieldRule& rule, const YamlNode& scalar) {
    if (has_type(rule, "text")) return rule.values.empty();
    if (scalar.is_quoted() || !has_type(rule, "real") || has_type(rule, "integer")) return false;
    const std::optional<double> number = parse_double(scalar.scalar());
    return number && !(rule.minimum && *number < *rule.minimum) &&
           !(rule.maximum && *number > *rule.maximum);
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

/// How a node was reached from the one above it, so that the path is put into words only where it
/// is needed.
struct DocumentSchema::Step {
    const Step* above = nullptr;
    std::string_view key;
    std::optional<std::size_t> index{};

    std::string path(const std::string& root) const {
        if (!above) return root;
        const std::string before = above->path(root);
        if (index) return fmt::format("{}[{}]", before, *index);
        return before.empty() ? std::string(key) : fmt::format("{}.{}", before, key);
    }
};

/// The check of one document.
class DocumentSchema::Validation {
  public:
    Validation(const DocumentSchema& schema, const YamlValue& document, Completeness completeness)
        : schema_(schema), document_(document), completeness_(completeness) {}

    void map(const YamlNode& node, const Step& step, const std::string& path) const {
        const std::vector<std::string_view> known = schema_.children(path);
        for (std::size_t i = 0; i < node.size(); ++i) {
            const std::string_view key = node.key(i).scalar();
            const Step below{.above = &step, .key = key};
            // Not by the whole path: a key may be written "craft.name", which is no field.
            if (std::find(known.begin(), known.end(), key) != known.end()) {
                value(node.value(i), below, field_path(path, key));
            } else if (const std::string any = field_path(path, "*"); schema_.find(any)) {
                value(node.value(i), below, any);
            } else {
                if (i > 0) refuse_decimal_comma(node, i, step);
                refuse_key(node.key(i), path, known);
            }
        }
        if (completeness_ == Completeness::begun) return;
        for (const std::string_view name : known) {
            const FieldRule& rule = *schema_.find(field_path(path, name));
            if (rule.required && node[name].is_null())
                at(node, step)
                    .fail(fmt::format("the key \"{}\" is missing ({})", name, rule.description),
                          "Add it");
        }
    }

  private:
    YamlValue at(const YamlNode& node, const Step& step) const {
        return {node, document_.where(), step.path(document_.path())};
    }

    /// Between braces a decimal comma parts a number: {speed: 440,5} has the key 5.
    void refuse_decimal_comma(const YamlNode& map, std::size_t unknown, const Step& step) const {
        const YamlNode number = map.value(unknown - 1);
        const std::string_view decimals = map.key(unknown).scalar();
        const std::string written = fmt::format("{},{}", number.scalar(), decimals);
        if (!map.value(unknown).is_null() || number.is_quoted() || !parse_integer(decimals) ||
            !is_digit(decimals.front()) || !parse_integer(number.scalar()))
            return;
        const Step below{.above = &step, .key = map.key(unknown - 1).scalar()};
        at(number, below)
            .fail(fmt::format("\"{}\" is not a number: it has a decimal comma",
                              escape_for_message(written)),
                  fmt::format("Write it with a decimal point: {}.{}", number.scalar(), decimals));
    }

    [[noreturn]] void refuse_key(const YamlNode& key, const std::string& path,
                                 const std::vector<std::string_view>& known) const {
        const std::string remedy =
            known.empty() ? "Remove it"
                          : fmt::format("Did you mean \"{}\"? Known keys here: {}",
                                        nearest(key.scalar(), known), fmt::join(known, ", "));
        throw Failure(yaml_place(document_.where(), key),
                      fmt::format("unknown key \"{}\"{}", escape_for_message(key.scalar()),
                                  path.empty() ? "" : " in " + path),
                      remedy);
    }

    void value(const YamlNode& node, const Step& step, const std::string& path) const {
        const FieldRule& rule = *schema_.find(path);
        if (node.is_null() || rule.apart || has_type(rule, "any")) return;
        if (node.is_map() && has_type(rule, "map")) return map(node, step, path);
        if (node.is_list() && has_type(rule, "list")) return list(node, step, path);
        if (node.is_map() || node.is_list())
            at(node, step)
                .fail(fmt::format("is a {}, not {}", node.is_map() ? "map" : "list",
                                  fmt::join(rule.types, " or ")),
                      "See the field table of the schema");
        if (!is_sound(rule, node)) check_scalar(rule, at(node, step));
    }

    void list(const YamlNode& node, const Step& step, const std::string& path) const {
        const std::string item_path = path + "[]";
        const FieldRule* rule = schema_.find(item_path);
        if (rule && rule->apart) return;
        for (std::size_t i = 0; i < node.size(); ++i) {
            const Step below{.above = &step, .key = {}, .index = i};
            if (node.item(i).is_null())
                at(node.item(i), below).fail("is empty", "Give it a value, or remove it");
            if (rule) value(node.item(i), below, item_path);
        }
    }

    const DocumentSchema& schema_;
    const YamlValue& document_;
    Completeness completeness_;
};

void DocumentSchema::validate(const YamlValue& document, Completeness completeness) const {
    if (!document.is_map())
        document.fail("the document is not a map of keys and values",
                      fmt::format("See the field table of {}/{}", name_, version_));
    Validation(*this, document, completeness).map(document.node(), Step{}, "");
    check_rules(document, completeness);
}

void DocumentSchema::validate_part(const YamlValue& map, const std::string& path) const {
    if (!map.exists()) map.fail("is empty", "Give it a value, or remove it");
    if (!map.is_map()) map.fail("is not a map", "Write {key: value}; see the field table");
    Validation(*this, map, Completeness::whole).map(map.node(), Step{}, path);
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
