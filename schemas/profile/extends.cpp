#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/document.h"
#include "schemas/profile/profile.h"

namespace runcert {

std::string_view builtin_profile_text(std::string_view name);

namespace {

/// What a rule says for itself alone: the rule that extends it has its own, or the default.
bool is_inherited(std::string_view key) {
    return key != "id" && key != "revision";
}

/// One rule over the one that it extends.
class Extension {
  public:
    Extension(const YamlValue& base, const YamlValue& own) : base_(base), own_(own) {
        for (const YamlValue& id : own["leaves_out"].list()) {
            if (!has_entry("clauses", id.text()) && !has_entry("questions", id.text()))
                id.fail(fmt::format("{} has no clause or question \"{}\"", own["extends"].text(),
                                    escape_for_message(id.text())),
                        "Remove it, or correct the id");
            left_out_.insert(id.text());
        }
    }

    YamlNode joined() {
        join_maps(base_.node(), own_.node(), true);
        return std::move(builder_).take();
    }

  private:
    bool has_entry(const char* list, const std::string& id) const {
        return std::ranges::any_of(
            base_[list].list(), [&](const YamlValue& entry) { return entry["id"].text() == id; });
    }

    /// A node of the base, at the place where the rule says that it extends it.
    void copy_of_base(const YamlNode& node) { builder_.copy(node, own_["extends"].node().mark()); }

    void join(std::string_view key, const YamlNode& base, const YamlNode& own, bool is_rule) {
        if (base.is_map() && own.is_map())
            join_maps(base, own, false);
        else if (is_rule && own.is_list() && (key == "clauses" || key == "questions"))
            join_entries(base, own);
        else
            builder_.copy(own);
    }

    void join_maps(const YamlNode& base, const YamlNode& own, bool is_rule) {
        builder_.begin(YamlKind::map, own.mark());
        for (std::size_t i = 0; i < base.size(); ++i) {
            const YamlNode key = base.key(i), replaced = own[key.scalar()];
            if (replaced.is_defined() ? replaced.is_null() : is_rule && !is_inherited(key.scalar()))
                continue;
            copy_of_base(key);
            // Entries that are left out go from a list that the rule says nothing of, too.
            if (is_rule && !replaced.is_defined() && base.value(i).is_list())
                join_entries(base.value(i), YamlNode());
            else if (replaced.is_defined())
                join(key.scalar(), base.value(i), replaced, is_rule);
            else
                copy_of_base(base.value(i));
        }
        for (std::size_t i = 0; i < own.size(); ++i) {
            const std::string_view key = own.key(i).scalar();
            if (base[key].is_defined() || own.value(i).is_null()) continue;
            if (is_rule && (key == "extends" || key == "leaves_out")) continue;
            builder_.copy(own.key(i));
            builder_.copy(own.value(i));
        }
        (void)builder_.end();
    }

    /// An entry with an id of the base's goes over that; any other stands before the one of these
    /// that the list names next, or at the end.
    void join_entries(const YamlNode& base, const YamlNode& own) {
        struct Entry {
            YamlNode base, own;
        };
        std::vector<Entry> entries;
        for (std::size_t i = 0; i < base.size(); ++i)
            if (!left_out_.contains(std::string(base.item(i)["id"].scalar())))
                entries.push_back({.base = base.item(i), .own = {}});
        auto next = entries.size();
        for (std::size_t i = own.size(); i-- > 0;) {
            const YamlNode entry = own.item(i);
            const auto same = std::ranges::find_if(entries, [&](const Entry& known) {
                return known.base.is_map() && entry.is_map() &&
                       known.base["id"].scalar() == entry["id"].scalar();
            });
            if (same != entries.end() && same->own.is_defined())
                throw Failure(yaml_place(own_.where(), entry["id"]),
                              fmt::format("two entries have the id \"{}\"",
                                          escape_for_message(entry["id"].scalar())),
                              "Give each an id of its own");
            next = same == entries.end() ? next : static_cast<std::size_t>(same - entries.begin());
            if (same == entries.end())
                entries.insert(entries.begin() + static_cast<std::ptrdiff_t>(next),
                               {.base = {}, .own = entry});
            else
                same->own = entry;
        }
        builder_.begin(YamlKind::list,
                       own.is_defined() ? own.mark() : own_["extends"].node().mark());
        for (const Entry& entry : entries) {
            if (!entry.own.is_defined())
                copy_of_base(entry.base);
            else if (entry.base.is_defined())
                join_maps(entry.base, entry.own, false);
            else
                builder_.copy(entry.own);
        }
        (void)builder_.end();
    }

    YamlValue base_, own_;
    std::set<std::string> left_out_;
    YamlBuilder builder_;
};

/// `ids` are those of the rules that extend this one; `place` is where the first of them says so.
YamlValue extended(const YamlValue& document, const YamlValue& place,
                   std::vector<std::string> ids) {
    const YamlValue extends = document["extends"];
    if (!extends.exists()) {
        if (document["leaves_out"].exists())
            document["leaves_out"].fail(
                "the rule extends none that it could leave something out of",
                "Add extends: with the rule's id, or remove it");
        return document;
    }
    const std::string name = extends.text();
    ids.push_back(document["id"].text_or(""));
    if (std::ranges::count(ids, name) > 0)
        place.fail(fmt::format("the rule \"{}\" would extend itself", escape_for_message(name)),
                   "Name another rule, or remove extends");
    const std::string file = name + ".yaml";
    const std::string_view text = builtin_profile_text(file);
    if (text.empty())
        extends.fail(fmt::format("no rule \"{}\" comes with the program", escape_for_message(name)),
                     fmt::format("Use one of: {}", fmt::join(builtin_profiles(), ", ")));
    const YamlValue base =
        extended(parse_input(text, file, profile_schema()), place, std::move(ids));
    return {Extension(base, document).joined(), document.where()};
}

}  // namespace

YamlValue extended(const YamlValue& document);

/// A rule's document without `extends` and `leaves_out`, with what it has from the rules that it
/// extends. `document` was parsed of a file; what comes from another rule has the place of its
/// `extends`. Failure, with that place, for an unknown rule, one that extends itself, or an id of
/// `leaves_out` that the other rule does not have.
YamlValue extended(const YamlValue& document) {
    return extended(document, document["extends"], {});
}

}  // namespace runcert
