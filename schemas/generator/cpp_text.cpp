#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "schemas/generator/declaration.h"

namespace runcert {
namespace {

std::string comment(const std::string& about, const char* indent = "") {
    return fmt::format("{}/// {}.\n", indent, about);
}

/// The C++ type of one value, without what makes it optional; empty for a type that is none.
std::string value_type(const Declaration& declaration, const std::string& type) {
    if (declaration.map(type) || declaration.words(type)) return type;
    for (const char* const text : {"text", "date", "id", "role", "file"})
        if (type == text) return "std::string";
    if (type == "integer") return "std::int64_t";
    if (type == "real" || type == "speed") return "double";
    if (type == "boolean") return "bool";
    if (type == "elapsed") return "ElapsedTime";
    if (type == "gps_time" || type == "utc_time") return "GpsTime";
    if (type == "files") return "std::vector<std::string>";
    if (type == "satellite") return "Satellite";
    if (type == "signal") return "SignalCode";
    return {};
}

std::string initial_value(const Declaration& declaration, const YamlValue& entry,
                          const std::string& type) {
    const YamlValue initially = entry["initially"].exists() ? entry["initially"] : entry["default"];
    const bool is_said = initially.node().is_scalar();
    const std::string said = is_said ? std::string(initially.node().scalar()) : "";
    if (const DeclaredWords* words = declaration.words(type)) {
        if (!is_said) return type + "::" + words->words.front().enumerator;
        for (const DeclaredWord& word : words->words)
            if (word.word == said) return type + "::" + word.enumerator;
        initially.fail("is no word of " + type, "Give one of its words");
    }
    if (type == "real" || type == "speed")
        return is_said ? said + (said.find_first_of(".e") == std::string::npos ? ".0" : "") : "0.0";
    if (type == "integer") return is_said ? said : "0";
    if (type == "boolean") return is_said ? said : "false";
    return is_said ? '"' + said + '"' : "{}";
}

std::string declared_member(const Declaration& declaration, const std::string& member,
                            const YamlValue& entry) {
    const std::string type = entry["type"].text();
    std::string cpp;
    std::string initial = "{}";
    if (type == "list") {
        cpp = "std::vector<" + value_type(declaration, entry["of"].text()) + ">";
    } else {
        cpp = value_type(declaration, type);
        if (cpp.empty()) entry["type"].fail("has no type in C++", "Use one of the known types");
        if ((is_set(entry, "required") && !is_set(entry, "optional")) || is_set(entry, "flat") ||
            entry["omit"].exists() || entry["default"].exists() ||
            (declaration.is_input() && entry["initially"].node().is_defined()) ||
            cpp == "std::string" || type == "files") {
            initial = initial_value(declaration, entry, type);
        } else {
            cpp = "std::optional<" + cpp + ">";
            initial = "std::nullopt";
        }
    }
    return comment(entry["description"].text(), "    ") +
           fmt::format("    {} {} = {};\n", cpp, member, initial);
}

/// What is computed for the readers of the file has none, nor what C++ code reads apart, nor a map
/// whose struct is a base.
bool has_member(const DeclaredStruct& made, std::size_t i) {
    return !made.fields[i]["computed"].exists() && !is_set(made.fields[i], "apart") &&
           !is_set(made.fields[i], "base");
}

/// " : A, B"
std::string bases_of(const DeclaredStruct& made) {
    std::string bases;
    for (const YamlValue& entry : made.fields)
        if (is_set(entry, "base")) bases += (bases.empty() ? " : " : ", ") + entry["type"].text();
    return bases;
}

std::string struct_of(const Declaration& declaration, const DeclaredStruct& made,
                      const std::string& before = {}, const std::string& after = {}) {
    std::string out =
        comment(made.about) + "struct " + made.name + bases_of(made) + " {\n" + before;
    for (std::size_t i = 0; i < made.fields.size(); ++i)
        if (has_member(made, i))
            out += declared_member(declaration, member_name(made.names[i], made.fields[i]),
                                   made.fields[i]);
    if (!made.placed.empty())
        out += "    std::string place = {};  ///< \"file:line:column\", for messages\n";
    out += after;
    for (const std::string& function : made.functions)
        out += "    " + function + ";\n";
    if (made.comparable)
        out += fmt::format("    bool operator==(const {}&) const = default;\n", made.name);
    return out + "};\n";
}

/// Where a member is left out of a file for its value, though it is no optional.
std::string condition_of(const YamlValue& entry, const std::string& member) {
    if (entry["omit"].exists())
        return fmt::format("if ({} != {}) ", member, entry["omit"].node().scalar());
    if (entry["type"].text() == "list" && !is_set(entry, "required"))
        return fmt::format("if (!{}.empty()) ", member);
    return {};
}

bool is_read_strictly(const std::string& type) {
    return type == "date" || type == "utc_time" || type == "id" || type == "role" ||
           type == "files";
}

/// Statements that put the members of `value` into `map`, or take them from it. A field outside
/// every map that is in another one has a name with a point: "summary.variance_factor".
std::string codec(const DeclaredStruct& made, bool writes) {
    std::string out;
    for (std::size_t i = 0; i < made.fields.size(); ++i) {
        const YamlValue& entry = made.fields[i];
        const std::size_t point = made.names[i].rfind('.');
        const std::string name = made.names[i].substr(point + 1);
        const std::string map = point == std::string::npos
                                    ? "map"
                                    : fmt::format("map[\"{}\"]", made.names[i].substr(0, point));
        const std::string computed = entry["computed"].text_or("");
        if (writes && !computed.empty())
            out += fmt::format(fmt::runtime(entry["type"].text() == "text"
                                                ? "    member::write(map, \"{}\", value.{});\n"
                                                : "    map[\"{}\"] = value.{};\n"),
                               name, computed);
        if (is_set(entry, "base"))
            out += fmt::format("    member::take(map, \"{}\", static_cast<{}&>(value));\n", name,
                               entry["type"].text());
        if (!has_member(made, i)) continue;
        const std::string member = "value." + member_name(name, entry);
        const std::string type = entry["type"].text();
        const std::string scale = entry["scale"].text_or("");
        const auto line = [&](std::string_view form) {
            return fmt::format(fmt::runtime(form), fmt::arg("map", map), fmt::arg("name", name),
                               fmt::arg("member", member), fmt::arg("type", type),
                               fmt::arg("scale", scale),
                               fmt::arg("if", condition_of(entry, member)));
        };
        out += "    ";
        if (is_set(entry, "flat"))
            out += line(writes ? "map.update(members_json({member}));"
                               : "member::take_all(map, {member});");
        else if (!writes && is_read_strictly(type))
            out += line(R"(if (map["{name}"].exists()) {member} = read_{type}(map["{name}"]);)");
        else if (type == "speed")
            out += line(writes ? R"(member::put_speed(map, "{name}", {member});)"
                               : R"(member::take_speed(map, "{name}", {member});)");
        else if (!scale.empty())
            out += line(writes ? R"(member::write(map, "{name}", {member} * {scale});)"
                               : R"(if (map["{name}"].exists()) )"
                                 R"({member} = map["{name}"].real() / {scale};)");
        else
            out += line(writes ? R"({if}member::write({map}, "{name}", {member});)"
                               : R"(member::take({map}, "{name}", {member});)");
        out += "\n";
    }
    return out;
}

bool has_phrases(const DeclaredWords& words) {
    return std::ranges::any_of(words.words,
                               [](const DeclaredWord& word) { return !word.phrase.empty(); });
}

/// The names of the lists that words have, in alphabetical order.
std::set<std::string> lists_of(const DeclaredWords& words) {
    std::set<std::string> names;
    for (const DeclaredWord& word : words.words)
        for (const auto& [name, items] : word.lists)
            names.insert(name);
    return names;
}

std::string enumeration(const DeclaredWords& words) {
    std::string out = comment(words.about) + "enum class " + words.name + " : std::uint8_t {\n";
    for (const DeclaredWord& word : words.words)
        out += fmt::format("    {},  ///< {}\n", word.enumerator, word.description);
    out += fmt::format(
        "}};\n"
        "std::string_view to_text({0} word);\n"
        "bool from_text(std::string_view text, {0}& word);\n"
        "/// What the word says, for people.\n"
        "std::string_view words_of({0} word);\n",
        words.name);
    if (has_phrases(words))
        out += fmt::format(
            "/// The same after what it is said of: \"3 epochs ...\".\n"
            "std::string_view phrase_of({0} word);\n",
            words.name);
    for (const std::string& list : lists_of(words))
        out += fmt::format("std::vector<std::string_view> {}_of({} word);\n", list, words.name);
    if (!words.each.empty()) {
        out += "#define " + words.each + "(x)";
        for (const DeclaredWord& word : words.words)
            out += " x(" + word.enumerator + ")";
        out += "\n";
    }
    return out + "\n";
}

/// A function that has a text for each word.
std::string text_function(const DeclaredWords& words, const char* name,
                          std::string DeclaredWord::*text) {
    std::string cases;
    for (const DeclaredWord& word : words.words)
        cases += fmt::format("        case {}::{}: return {};\n", words.name, word.enumerator,
                             in_quotes(word.*text));
    return fmt::format(
        "std::string_view {}({} word) {{\n    switch (word) {{\n{}    }}\n    return {{}};\n}}\n",
        name, words.name, cases);
}

std::string enumeration_source(const DeclaredWords& words) {
    std::string out = text_function(words, "to_text", &DeclaredWord::word) +
                      text_function(words, "words_of", &DeclaredWord::description);
    if (has_phrases(words)) out += text_function(words, "phrase_of", &DeclaredWord::phrase);
    for (const std::string& list : lists_of(words)) {
        std::string cases;
        for (const DeclaredWord& word : words.words) {
            std::string items;
            if (const auto found = word.lists.find(list); found != word.lists.end())
                for (const std::string& item : found->second)
                    items += (items.empty() ? "" : ", ") + in_quotes(item);
            cases += fmt::format("        case {}::{}: return {{{}}};\n", words.name,
                                 word.enumerator, items);
        }
        out += fmt::format(
            "std::vector<std::string_view> {}_of({} word) {{\n    switch (word) {{\n{}    }}\n"
            "    return {{}};\n}}\n",
            list, words.name, cases);
    }
    out += fmt::format("bool from_text(std::string_view text, {}& word) {{\n", words.name);
    for (const DeclaredWord& word : words.words)
        out += fmt::format("    if (text == {}) return word = {}::{}, true;\n",
                           in_quotes(word.word), words.name, word.enumerator);
    return out + "    return false;\n}\n\n";
}

// Columns.

std::string column_type(const Declaration& declaration, const YamlValue& column, bool compact) {
    const std::string type = column["type"].text();
    const std::string cpp = value_type(declaration, type);
    if (is_set(column, "always")) return cpp;
    if (!compact || declaration.words(type) || type == "boolean")
        return "std::optional<" + cpp + ">";
    if (type == "real") return "OptionalReal";
    return fmt::format("OptionalNumber<std::int{}_t>",
                       column["bits"].optional_integer().value_or(64));
}

std::string column_member(const Declaration& declaration, const YamlValue& column, bool compact) {
    const std::string type = column["type"].text();
    const std::string cpp = column_type(declaration, column, compact);
    std::string initial = "{}";
    if (is_set(column, "always")) initial = initial_value(declaration, column, type);
    return comment(column["description"].text(), "    ") +
           fmt::format("    {} {} = {};\n", cpp, column_member_name(column), initial);
}

/// Bytes of a compact member: those of a group stand by size, so that no room is lost between them.
std::int64_t size_of(const Declaration& declaration, const YamlValue& column) {
    if (declaration.words(column["type"].text())) return 1;
    return column["bits"].optional_integer().value_or(64) / 8;
}

std::string group_struct(const Declaration& declaration, const DeclaredStruct& group) {
    std::string out = comment(group.about) + "struct " + group.name + " {\n";
    std::vector<YamlValue> members = group.fields;
    if (group.compact)
        std::ranges::stable_sort(
            members, {}, [&](const YamlValue& column) { return size_of(declaration, column); });
    for (const YamlValue& column : members)
        out += column_member(declaration, column, group.compact);
    return out + "};\n\n";
}

std::string row_name(const Declaration& declaration) {
    return declaration.source()["row"]["name"].text();
}

std::string row_struct(const Declaration& declaration) {
    const YamlValue row = declaration.source()["row"];
    std::string bases, members;
    const auto add_base = [&](const std::string& base) {
        bases += (bases.empty() ? " : " : ", ") + base;
    };
    if (row["extends"].exists()) add_base(declaration.extended_row());
    for (const YamlValue& entry : declaration.source()["columns"].list())
        if (!entry["group"].exists())
            members += column_member(declaration, entry, is_set(row, "compact"));
        else if (entry["member"].exists())
            members += fmt::format("    {} {};\n", entry["group"].text(), entry["member"].text());
        else
            add_base(entry["group"].text());
    return comment(row["about"].text()) + "struct " + row_name(declaration) + bases + " {\n" +
           members + "};\n\n";
}

std::string bindings(const Declaration& declaration) {
    std::string out;
    for (const DeclaredColumn& column : declaration.columns()) {
        const std::string place =
            column.member.empty()
                ? std::string()
                : fmt::format("&Row::{}, &{}::", column.member, column.group->name);
        out += fmt::format("        column<Row, {}{}>(\"{}\"),\n", place.empty() ? "&Row::" : place,
                           column_member_name(column.entry), column.entry["name"].text());
    }
    return out;
}

bool is_table(const Declaration& declaration) {
    return !declaration.columns().empty();
}

std::string product_functions(const Declaration& declaration) {
    const std::string name = declaration.source()["schema"].text();
    const std::string& type = declaration.top().name;
    std::string out = fmt::format(
        "/// The file's text.\nstd::string write_{0}(const {1}& {0});\n"
        "/// `where` names the file in messages. Failure on any deviation "
        "from the field table.\n"
        "{1} read_{0}(std::string_view text, const std::string& where);\n",
        name, type);
    if (is_table(declaration))
        out += fmt::format(
            "/// The same row by row, in memory that does not grow with the table: the head holds "
            "all but the\n/// rows. `text` must outlive what is returned.\n"
            "OpenTable<{1}> open_{0}(std::string_view text, const std::string& where);\n"
            "TableWriter<{2}> begin_{0}(const {1}& head, EcsvWriter::Sink sink);\n",
            name, type, row_name(declaration));
    return out;
}

std::string document_source(const Declaration& declaration) {
    return fmt::format(
        R"(namespace {{
const DocumentSchema& product_schema() {{
    static const DocumentSchema schema =
        DocumentSchema::read({0}_field_table_node(), "schemas/{0}/v1.yaml", &header_schema());
    return schema;
}}
}}  // namespace

std::string write_{0}(const {1}& value) {{
    nlohmann::ordered_json map = header_json(value.header);
{2}    return write_document(std::move(map), product_schema());
}}

{1} read_{0}(std::string_view text, const std::string& where) {{
    const YamlValue map = read_document(text, where, product_schema());
    {1} value;
    value.header = read_header(map);
{3}    return value;
}}
)",
        declaration.source()["schema"].text(), declaration.top().name,
        codec(declaration.top(), true), codec(declaration.top(), false));
}

std::string format_source(const Declaration& declaration) {
    return fmt::format(
        R"(const TableFormat<{1}>& {0}_format() {{
    using Row = {1};
    static const TableFormat<Row> instance({0}_field_table_node(), "schemas/{0}/v1.yaml", {{
{2}    }});
    return instance;
}}

)",
        declaration.source()["schema"].text(), row_name(declaration), bindings(declaration));
}

std::string table_source(const Declaration& declaration) {
    return fmt::format(
        R"(namespace {{
nlohmann::ordered_json meta_of(const {1}& value) {{
    nlohmann::ordered_json map = header_json(value.header);
{2}    return map;
}}

{1} head_of(const YamlValue& map) {{
    {1} value;
    value.header = read_header(map);
{3}    return value;
}}
}}  // namespace

std::string write_{0}(const {1}& value) {{ return {0}_format().write(meta_of(value), value.rows); }}

{1} read_{0}(std::string_view text, const std::string& where) {{
    auto contents = {0}_format().read(text, where);
    {1} value = head_of(contents.meta);
    value.rows = std::move(contents.rows);
    return value;
}}

OpenTable<{1}> open_{0}(std::string_view text, const std::string& where) {{
    RowReader<{4}> rows({0}_format(), text, where);
    return {{head_of(rows.meta()), std::move(rows)}};
}}

TableWriter<{4}> begin_{0}(const {1}& head, EcsvWriter::Sink sink) {{
    return {{{0}_format(), {0}_format().begin(meta_of(head), std::move(sink))}};
}}
)",
        declaration.source()["schema"].text(), declaration.top().name,
        codec(declaration.top(), true), codec(declaration.top(), false), row_name(declaration));
}

std::string writer_source(const DeclaredStruct& map) {
    return fmt::format(
        "template <>\nnlohmann::ordered_json members_json(const {}& value) {{\n"
        "    auto map = nlohmann::ordered_json::object();\n{}    return map;\n}}\n",
        map.name, codec(map, true));
}

std::string reader_source(const DeclaredStruct& map) {
    std::string place;
    if (!map.placed.empty())
        place = fmt::format("    value.place = map{}.place();\n",
                            map.placed == "true" ? "" : "[\"" + map.placed + "\"]");
    return fmt::format(
        "template <>\n{0} read_members(const YamlValue& map) {{\n"
        "    {0} value;\n{1}{2}    return value;\n}}\n\n",
        map.name, codec(map, false), place);
}

}  // namespace

std::string header_text(const Declaration& declaration) {
    std::string out = "#pragma once\n\n// Written by the build from schemas/" +
                      declaration.folder() +
                      "/v1.yaml.\n\n#include <cstdint>\n#include <optional>\n"
                      "#include <string>\n#include <string_view>\n#include <vector>\n\n"
                      "#include \"core/optional_number.h\"\n";
    for (const YamlValue& header : declaration.source()["includes"].list())
        out += "#include \"" + header.text() + "\"\n";
    out += "\nnamespace runcert {\n\n";
    for (const DeclaredWords& words : declaration.own_words())
        out += enumeration(words);
    for (const DeclaredStruct& group : declaration.own_groups())
        out += group_struct(declaration, group);
    for (const DeclaredStruct& map : declaration.own_maps())
        if (!map.by_hand)
            out +=
                struct_of(declaration, map) +
                (declaration.is_input()
                     ? ""
                     : fmt::format("template <>\nnlohmann::ordered_json members_json(const {}& "
                                   "value);\n",
                                   map.name)) +
                fmt::format("template <>\n{0} read_members(const YamlValue& map);\n\n", map.name);
    if (is_table(declaration))
        out += row_struct(declaration) +
               fmt::format(
                   "/// The table: its columns, bound to the members of a row.\n"
                   "const TableFormat<{}>& {}_format();\n\n",
                   row_name(declaration), declaration.source()["schema"].text());
    if (declaration.is_input())
        out += struct_of(declaration, declaration.top()) +
               fmt::format("template <>\n{} read_members(const YamlValue& map);\n",
                           declaration.top().name);
    else if (!declaration.top().name.empty())
        out += struct_of(declaration, declaration.top(), "    Header header;\n",
                         is_table(declaration)
                             ? "    std::vector<" + row_name(declaration) + "> rows;\n"
                             : "") +
               "\n" + product_functions(declaration);
    return out + "\n}  // namespace runcert\n";
}

std::string source_text(const Declaration& declaration) {
    const std::string name = declaration.source()["schema"].text();
    std::string out = fmt::format(
        "// Written by the build from schemas/{1}/v1.yaml.\n\n"
        "#if __has_include(\"schemas/{1}/{1}.h\")\n#include \"schemas/{1}/{1}.h\"\n#else\n"
        "#include \"schemas/{1}/declared.h\"\n#endif\n\n"
        "#include \"schemas/common/document.h\"\n#include \"schemas/common/members.h\"\n\n"
        "namespace runcert {{\n\n"
        "YamlNode {0}_field_table_node();\n\n",
        name, declaration.folder());
    for (const DeclaredWords& words : declaration.own_words())
        out += enumeration_source(words);
    for (const DeclaredStruct& map : declaration.own_maps())
        if (!map.by_hand)
            out += (declaration.is_input() ? "" : writer_source(map)) + reader_source(map);
    if (is_table(declaration)) out += format_source(declaration);
    if (declaration.is_input())
        out += reader_source(declaration.top());
    else if (!declaration.top().name.empty())
        out += is_table(declaration) ? table_source(declaration) : document_source(declaration);
    return out + "\n}  // namespace runcert\n";
}

}  // namespace runcert
