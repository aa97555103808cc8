#include "reports/day/day_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* remedy =
    "The list is written by `runcert batch`: run it again rather than edit the list";

/// One value of the list that knows where it stands.
class Value {
  public:
    Value(const Json& json, std::string path, const std::string& where)
        : json_(&json), path_(std::move(path)), where_(&where) {}

    [[noreturn]] void fail(const std::string& what) const {
        throw Failure(*where_, fmt::format("{} {}", path_.empty() ? "the list" : path_, what),
                      remedy);
    }
    bool has(const std::string& key) const { return json_->contains(key); }
    Value operator[](const std::string& key) const {
        if (!has(key)) fail(fmt::format("has no \"{}\"", key));
        return {json_->at(key), path_.empty() ? key : path_ + "." + key, *where_};
    }
    std::string text() const {
        if (!json_->is_string() || json_->get_ref<const std::string&>().empty())
            fail("is not a text, or empty");
        return json_->get<std::string>();
    }
    std::string text_or_empty(const std::string& key) const {
        if (!has(key) || (*json_)[key] == "") return {};
        return (*this)[key].text();
    }
    std::uint64_t size() const {
        if (!json_->is_number_unsigned()) fail("is not a whole number of bytes");
        return json_->get<std::uint64_t>();
    }
    std::vector<Value> list() const {
        if (!json_->is_array()) fail("is not a list");
        std::vector<Value> items;
        for (std::size_t i = 0; i < json_->size(); ++i)
            items.emplace_back((*json_)[i], fmt::format("{}[{}]", path_, i), *where_);
        return items;
    }
    std::vector<std::string> texts(const std::string& key) const {
        std::vector<std::string> texts;
        if (has(key))
            for (const Value& item : (*this)[key].list())
                texts.push_back(item.text());
        return texts;
    }
    /// It is a map of no other keys than these.
    void holds_only(const std::set<std::string>& known) const {
        if (!json_->is_object()) fail("is not a map of keys and values");
        for (const auto& [key, unused] : json_->items())
            if (!known.contains(key))
                fail(fmt::format("has the unknown key \"{}\"", escape_for_message(key)));
    }

  private:
    const Json* json_;
    std::string path_;
    const std::string* where_;
};

/// A file within the day's folder.
std::string file_inside(const Value& value) {
    const std::string file = value.text();
    const std::filesystem::path path(file);
    const bool inside = path.is_relative() && file.find('\0') == std::string::npos &&
                        std::ranges::find(path, std::filesystem::path("..")) == path.end();
    if (!inside)
        value.fail(fmt::format("names \"{}\", which is not within the day's folder",
                               escape_for_message(file)));
    return file;
}

ListedFile listed_file(const Value& value) {
    value.holds_only({"file", "sha256", "bytes"});
    const std::string sha256 = value["sha256"].text();
    if (sha256.size() != 64 || sha256.find_first_not_of("0123456789abcdef") != std::string::npos)
        value["sha256"].fail("is not a SHA-256 in hexadecimal");
    return {.file = file_inside(value["file"]), .sha256 = sha256, .bytes = value["bytes"].size()};
}

bool is_safe_id(const std::string& id) {
    return std::ranges::all_of(id, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_';
    });
}

ListedAttempt listed_attempt(const Value& value) {
    value.holds_only({"id", "source", "state", "verdict", "report", "observations", "attestations",
                      "pages", "notes", "step", "problem", "where", "remedy", "reason"});
    ListedAttempt attempt{.id = value["id"].text(),
                          .source = value["source"].text(),
                          .state = value["state"].text(),
                          .notes = value.texts("notes")};
    if (attempt.state == "done") {
        if (!is_safe_id(attempt.id))
            value["id"].fail("has other characters than letters, digits, - and _");
        attempt.verdict = listed_file(value["verdict"]);
        attempt.report = listed_file(value["report"]);
        if (value.has("observations"))
            for (const Value& file : value["observations"].list())
                attempt.observations.push_back(listed_file(file));
        if (value.has("attestations"))
            for (const Value& file : value["attestations"].list())
                attempt.attestations.push_back(listed_file(file));
        if (value.has("pages"))
            for (const Value& page : value["pages"].list())
                attempt.pages.push_back(file_inside(page));
    } else if (attempt.state == "failed") {
        attempt.step = value["step"].text();
        attempt.problem = value["problem"].text();
        attempt.where = value.text_or_empty("where");
        attempt.remedy = value.text_or_empty("remedy");
    } else if (attempt.state == "not_processed") {
        attempt.reason = value.text_or_empty("reason");
    } else {
        value["state"].fail("is none of done, failed, not_processed");
    }
    return attempt;
}

}  // namespace

DayList read_day_list(std::string_view text, const std::string& where) {
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) throw Failure(where, "the list is not JSON", remedy);
    const Value document(json, "", where);
    document.holds_only({"day", "attempts", "notes"});
    DayList list{.day = document["day"].text(), .notes = document.texts("notes")};
    std::set<std::string> done;
    for (const Value& value : document["attempts"].list()) {
        list.attempts.push_back(listed_attempt(value));
        const ListedAttempt& attempt = list.attempts.back();
        if (attempt.state == "done" && !done.insert(attempt.id).second)
            value["id"].fail("is that of another attempt that is done");
    }
    return list;
}

}  // namespace runcert
