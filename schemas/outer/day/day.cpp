#include "schemas/day/day.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "schemas/attempt/attempt.h"
#include "schemas/common/document.h"
#include "schemas/common/strict_texts.h"
#include "store/yaml_output.h"

namespace runcert {

YamlNode day_field_table_node();

namespace {

/// Whether an attempt has this key, or (of "receivers[].") a receiver, that a day may give them.
bool has_key(std::string_view of, std::string_view key) {
    const FieldRule* rule = attempt_schema().find(std::string(of).append(key));
    return rule && key.find_first_of(".[") == std::string_view::npos &&
           key != (of.empty() ? "schema" : "id");
}

bool is_of_attempt(std::string_view key) {
    return has_key("", key);
}

bool is_known(std::string_view key) {
    return is_of_attempt(key) || has_key("receivers[].", key);
}

/// "file:line:column" of a key itself: its value may be on another line, or missing.
std::string place_of_key(const YamlValue& map, const std::string& key) {
    for (std::size_t i = 0; map.is_map() && i < map.node().size(); ++i)
        if (map.node().key(i).scalar() == key) return yaml_place(map.where(), map.node().key(i));
    return map.place();
}

void require_known(const YamlValue& map, const std::string& key) {
    if (is_known(key)) return;
    std::vector<std::string_view> known;
    for (const std::string_view of : {"", "receivers[]."})
        for (const FieldRule& rule : attempt_schema().fields())
            if (rule.path.starts_with(of) && has_key(of, rule.path.substr(of.size())))
                known.push_back(std::string_view(rule.path).substr(of.size()));
    throw Failure(place_of_key(map, key),
                  fmt::format("unknown key \"{}\"", escape_for_message(key)),
                  fmt::format("Did you mean \"{}\"? Known keys here: {}", nearest(key, known),
                              fmt::join(known, ", ")));
}

void require_known_defaults(const YamlValue& defaults) {
    for (const std::string& key : defaults.keys()) {
        if (key == "receivers" || key == "recording")
            throw Failure(place_of_key(defaults, key),
                          fmt::format("\"{}\" cannot be the same for all attempts", key),
                          "List the attempts with their recordings (`runcert new --day` writes "
                          "them out); what all receivers have may stand in the defaults by itself");
        if (key == "id" || key == "schema")
            throw Failure(place_of_key(defaults, key),
                          fmt::format("\"{}\" cannot be the same for all attempts", key),
                          "Remove it from the defaults");
        require_known(defaults, key);
    }
}

/// Copies what the entry says and, of what it is silent of, the defaults say: the keys of an
/// attempt, or those of a receiver.
void copy_keys(const YamlNode& entry, const YamlNode& defaults, bool of_attempt,
               YamlBuilder& builder) {
    const auto copy_from = [&](const YamlNode& from, const auto& is_replaced) {
        for (std::size_t i = 0; i < from.size(); ++i) {
            const std::string_view key = from.key(i).scalar();
            if (key == "id" || is_replaced(key) || from.value(i).is_null() ||
                is_of_attempt(key) != of_attempt)
                continue;
            builder.copy(from.key(i));
            builder.copy(from.value(i));
        }
    };
    copy_from(defaults, [&](std::string_view key) { return entry[key].is_defined(); });
    copy_from(entry, [](std::string_view) { return false; });
}

/// The keys of an attempt that is written in the day file, but its id.
YamlNode written_keys(const YamlValue& entry, const YamlValue& defaults) {
    const bool short_form = entry["recording"].exists();
    for (const std::string& key : entry.keys()) {
        if (is_of_attempt(key)) continue;
        require_known(entry, key);
        if (!short_form)
            throw Failure(place_of_key(entry, key),
                          fmt::format("\"{}\" belongs to a receiver, and no recording is named "
                                      "beside it",
                                      key),
                          "Add recording:, or write it in one of the receivers");
    }
    if (short_form && entry["receivers"].exists())
        entry.fail("the entry has a recording and receivers",
                   "Write the recording in one of the receivers");
    for (const std::string& key : defaults.keys())
        if (!short_form && !is_of_attempt(key))
            entry.fail(fmt::format("the defaults have \"{}\" of a receiver, and the entry lists "
                                   "its receivers",
                                   key),
                       "Write it in each receiver, and remove it from the defaults");
    YamlBuilder builder;
    builder.begin(YamlKind::map, entry.node().mark());
    copy_keys(entry.node(), defaults.node(), true, builder);
    if (short_form) {
        builder.scalar("receivers", false, {});
        builder.begin(YamlKind::list, {});
        builder.begin(YamlKind::map, {});
        builder.scalar("id", false, {});
        builder.scalar("primary", false, {});
        copy_keys(entry.node(), defaults.node(), false, builder);
        (void)builder.end();
        (void)builder.end();
    }
    (void)builder.end();
    return std::move(builder).take();
}

void read_entry(const YamlValue& value, const YamlValue& defaults, DayEntry& entry) {
    day_schema().validate_part(value, "attempts[]");
    if (!value["attempt"].exists()) {
        entry.id = value["id"].text_or("");
        entry.short_form = value["recording"].exists();
        entry.keys = written_keys(value, defaults);
        return;
    }
    for (const std::string& key : value.keys())
        if (key != "attempt")
            throw Failure(place_of_key(value, key),
                          fmt::format("\"{}\" stands beside the file of an attempt, which is taken "
                                      "as it is",
                                      escape_for_message(key)),
                          "Remove it, or write the attempt here in place of its file");
    entry.attempt = value["attempt"].text();
    if (entry.attempt.empty() || entry.attempt.find('\0') != std::string::npos)
        value["attempt"].fail("is not the name of a file", "Name the attempt's file");
}

}  // namespace

const DocumentSchema& day_schema() {
    static const DocumentSchema schema =
        DocumentSchema::read(day_field_table_node(), "schemas/outer/day/v1.yaml");
    return schema;
}

DayFile read_day_file(std::string_view text, const std::string& where) {
    const YamlValue document = read_input(text, where, day_schema());
    DayFile day;
    if (document["id"].exists()) day.id = read_id(document["id"]);
    require_known_defaults(document["defaults"]);
    for (const YamlValue& value : document["attempts"].list()) {
        DayEntry entry{.line = value.node().mark().line + 1, .place = value.place()};
        try {
            read_entry(value, document["defaults"], entry);
        } catch (const Failure& failure) {
            entry.refused = failure;
        }
        day.entries.push_back(std::move(entry));
    }
    if (day.entries.empty())
        document["attempts"].fail("no attempt is listed",
                                  "List at least one, e.g. - {recording: run.pos}");
    return day;
}

std::string attempt_text(const std::string& id, const YamlNode& keys, const std::string& comment) {
    return fmt::format("# {}\nschema: {}/{}\nid: {}", comment, attempt_schema().name(),
                       attempt_schema().version(), to_yaml_text(id)) +
           plain_yaml_text(keys);
}

}  // namespace runcert
