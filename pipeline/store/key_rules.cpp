#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/failure.h"
#include "core/gps_time.h"
#include "core/prose.h"
#include "core/text.h"
#include "store/document_schema.h"

// The rules across keys of a field table (`rules`), as schemas/generator/declaration.h has them.

namespace runcert {
namespace {

bool is_of_document(std::string_view key) {
    return key.starts_with('/');
}

/// A key as people write it: "window.kind" of "/window.kind".
std::string named(std::string_view key) {
    return std::string(is_of_document(key) ? key.substr(1) : key);
}

std::vector<std::string> texts_of(const YamlValue& list) {
    if (!list.is_list())
        return list.exists() ? std::vector{list.text()} : std::vector<std::string>();
    std::vector<std::string> texts;
    for (const YamlValue& one : list.list())
        texts.push_back(named(one.text()));
    return texts;
}

/// A number, or a time in seconds; nothing where a text is neither.
std::optional<double> quantity(std::string text) {
    if (const auto number = parse_double(text)) return number;
    try {
        if (text.ends_with('Z')) text.pop_back();
        return parse_gps_iso(text).seconds_since(GpsTime());
    } catch (const Failure&) {
        return std::nullopt;
    }
}

/// One rule, of one map of a document.
class KeyRule {
  public:
    KeyRule(const DocumentSchema& schema, const YamlValue& document, const YamlValue& map,
            const YamlValue& rule, Completeness completeness)
        : schema_(schema),
          document_(document),
          map_(map),
          rule_(rule),
          begun_(completeness == Completeness::begun) {}

    void check() const {
        for (const std::string& key : rule_["when"].keys())
            if (!holds(key, texts_of(rule_["when"][key]))) return;
        for (const std::string& key : rule_["must"].keys())
            require(key, texts_of(rule_["must"][key]));
        require_number_of("together", "belong together", "Give all of them, or none",
                          [](auto given, auto all) { return given == 0 || given == all; });
        require_number_of("one_of", "are given: one of them is to be", "Give one of them",
                          [](auto given, auto) { return given == 1; });
        require_number_of("any_of", "are all missing", "Give one of them at least",
                          [](auto given, auto) { return given > 0; });
        if (rule_["ascending"].exists()) require_ascending(texts_of(rule_["ascending"]));
        if (rule_["list"].exists()) require_length(rule_["list"].text());
        if (rule_["unique"].exists()) require_unique(rule_["unique"].text());
    }

  private:
    YamlValue at(std::string_view key) const {
        const std::vector<YamlValue> found =
            values_at(is_of_document(key) ? document_ : map_, named(key));
        return found.empty() ? YamlValue(YamlNode(), document_.where()) : found.front();
    }

    const FieldRule* field(std::string_view key) const {
        const std::string of_map = rule_["at"].text();
        return schema_.find(is_of_document(key) || of_map.empty() ? named(key)
                                                                  : of_map + "." + named(key));
    }

    /// What is stated, or the default; of a map in the place of a word its key.
    std::string word(std::string_view key) const {
        YamlValue value = at(key);
        if (!value.exists() && field(key)) value = field(key)->default_value;
        if (value.is_map()) return value.keys().empty() ? "" : value.keys().front();
        return value.node().is_scalar() ? value.text() : "";
    }

    bool holds(std::string_view key, const std::vector<std::string>& wanted) const {
        return std::ranges::any_of(wanted, [&](const std::string& one) {
            return one == "given"    ? at(key).exists()
                   : one == "absent" ? !at(key).exists()
                                     : word(key) == one;
        });
    }

    /// What the rule is of: "kind: alpha", "lever_arm_m"; at the place of its one key, which the
    /// failure names, "alpha".
    std::string subject(bool placed) const {
        std::vector<std::string> words;
        const std::vector<std::string> keys = rule_["when"].keys();
        for (const std::string& key : keys) {
            const std::string wanted = texts_of(rule_["when"][key]).front();
            if (wanted == "given")
                words.push_back(named(key));
            else if (placed && keys.size() == 1 && !is_of_document(key) && at(key).exists())
                words.push_back(word(key));
            else if (wanted != "absent")
                words.push_back(fmt::format("{}: {}", named(key), word(key)));
        }
        return words.empty() ? "this" : listed(words);
    }

    /// A key that one may as well remove to keep the rule: ", or remove lever_arm_m".
    std::string or_remove(const char* before) const {
        for (const std::string& key : rule_["when"].keys())
            if (texts_of(rule_["when"][key]).front() == "given" && !is_of_document(key))
                return before + key;
        return {};
    }

    /// Failure at the first of these keys that the map has, else at the map.
    [[noreturn]] void fail(const std::vector<std::string>& keys, const std::string& problem,
                           const std::string& remedy) const {
        YamlValue place = map_;
        if (const auto stated = std::ranges::find_if(
                keys,
                [&](const std::string& key) { return !is_of_document(key) && at(key).exists(); });
            stated != keys.end())
            place = at(*stated);
        place.fail(rule_["because"].text_or(problem), rule_["remedy"].text_or(remedy));
    }

    void require(const std::string& key, const std::vector<std::string>& wanted) const {
        if (holds(key, wanted) || (begun_ && !at(key).exists())) return;
        const std::string name = named(key);
        std::vector<std::string> places = rule_["when"].keys();
        places.push_back(key);
        if (wanted.front() == "given")
            fail(places, fmt::format("{} needs {}", subject(true), name),
                 fmt::format("Add {}: {}{}", name, field(key)->description,
                             or_remove("; or remove ")));
        if (wanted.front() == "absent")
            fail({key}, fmt::format("{} goes without {}", subject(false), name),
                 fmt::format("Remove {}{}", name, or_remove(" or ")));
        fail(places, fmt::format("{} needs {}: {}", subject(true), name, fmt::join(wanted, " or ")),
             fmt::format("Write {}: {}{}", name, fmt::join(wanted, " or "),
                         or_remove(", or remove ")));
    }

    void require_number_of(const char* kind, const char* problem, const char* remedy,
                           const auto& is_sound) const {
        const std::vector<std::string> keys = texts_of(rule_[kind]);
        const auto given =
            std::ranges::count_if(keys, [&](const std::string& key) { return at(key).exists(); });
        if (keys.empty() || is_sound(given, std::ssize(keys)) ||
            (begun_ && given < std::ssize(keys)))
            return;
        fail({}, fmt::format("{} {}", listed(keys), problem), remedy);
    }

    void require_ascending(const std::vector<std::string>& keys) const {
        const auto low = quantity(word(keys[0])), high = quantity(word(keys[1]));
        if (!low || !high || *high > *low) return;
        const auto value = [&](const std::string& key) {
            const std::string unit = field(key)->unit;
            return word(key) + (unit.empty() ? "" : " " + unit);
        };
        fail({keys[1], keys[0]},
             fmt::format("{} is {}, which is not above {}, {}", keys[1], value(keys[1]), keys[0],
                         value(keys[0])),
             fmt::format("Give {} above {}", keys[1], keys[0]));
    }

    void require_length(const std::string& key) const {
        const auto size = std::ssize(at(key).list());
        if ((size >= rule_["least"].integer() || begun_) &&
            size <= rule_["most"].optional_integer().value_or(size))
            return;
        fail({key}, fmt::format("{} {} are listed", size, key), "");
    }

    void require_unique(const std::string& key) const {
        const std::vector<std::string> lists = texts_of(rule_["in"]);
        std::set<std::string> known;
        for (const std::string& list : lists)
            for (const YamlValue& item : at(list).list())
                if (const YamlValue value = item[key];
                    value.exists() && !known.insert(value.text()).second)
                    value.fail(
                        rule_["because"].text_or(fmt::format("two {} have the {} \"{}\"",
                                                             fmt::join(lists, " or "), key,
                                                             escape_for_message(value.text()))),
                        rule_["remedy"].text_or(fmt::format("Give each an {} of its own", key)));
    }

    const DocumentSchema& schema_;
    const YamlValue& document_;
    const YamlValue& map_;
    const YamlValue& rule_;
    bool begun_;
};

}  // namespace

std::vector<YamlValue> values_at(const YamlValue& document, std::string_view path) {
    if (!document.exists()) return {};
    if (path.empty()) return {document};
    if (path.starts_with("[]")) {
        std::vector<YamlValue> all;
        if (document.is_list())
            for (const YamlValue& item : document.list())
                std::ranges::move(values_at(item, path.substr(2)), std::back_inserter(all));
        return all;
    }
    if (path.starts_with('.')) path.remove_prefix(1);
    const std::size_t end = std::min({path.find('.'), path.find("[]"), path.size()});
    if (!document.is_map()) return {};
    return values_at(document[path.substr(0, end)], path.substr(end));
}

void DocumentSchema::check_rules(const YamlValue& document, Completeness completeness) const {
    for (const YamlValue& rule : source_["rules"].list())
        for (const YamlValue& map : values_at(document, rule["at"].text()))
            KeyRule(*this, document, map, rule, completeness).check();
}

}  // namespace runcert
