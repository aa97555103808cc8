#include "reports/day/day_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "store/document_schema.h"
#include "store/yaml_output.h"

namespace runcert {

YamlNode day_list_field_table_node();

namespace {

constexpr const char* remedy =
    "The list is written by `runcert batch`: run it again rather than edit the list";

/// A file within the day's folder.
void require_inside(const YamlValue& value) {
    const std::string file = value.text();
    const std::filesystem::path path(file);
    if (!path.is_relative() || file.find('\0') != std::string::npos ||
        std::ranges::find(path, std::filesystem::path("..")) != path.end())
        value.fail(fmt::format("names \"{}\", which is not within the day's folder",
                               escape_for_message(file)),
                   remedy);
}

void check_listed(const YamlValue& listed) {
    require_inside(listed["file"]);
    const std::string sha256 = listed["sha256"].text();
    if (sha256.size() != 64 || sha256.find_first_not_of("0123456789abcdef") != std::string::npos)
        listed["sha256"].fail("is not a SHA-256 in hexadecimal", remedy);
}

void require(const YamlValue& attempt, std::initializer_list<const char*> members) {
    for (const char* member : members)
        if (!attempt[member].exists()) attempt.fail(fmt::format("has no \"{}\"", member), remedy);
}

bool is_safe_id(const std::string& id) {
    return std::ranges::all_of(id, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_';
    });
}

void check_done(const YamlValue& attempt) {
    if (!is_safe_id(attempt["id"].text()))
        attempt["id"].fail("has other characters than letters, digits, - and _", remedy);
    require(attempt, {"verdict", "report"});
    for (const char* file : {"verdict", "report"})
        check_listed(attempt[file]);
    for (const char* files : {"observations", "attestations"})
        if (attempt[files].exists())
            for (const YamlValue& file : attempt[files].list())
                check_listed(file);
    if (attempt["pages"].exists())
        for (const YamlValue& page : attempt["pages"].list())
            require_inside(page);
}

}  // namespace

DayList read_day_list(std::string_view text, const std::string& where) {
    static const DocumentSchema schema =
        DocumentSchema::read(day_list_field_table_node(), "schemas/day_list/v1.yaml");
    const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
    if (json.is_discarded()) throw Failure(where, "the list is not JSON", remedy);
    const YamlValue document(yaml_node_of(json), where);
    schema.validate(document);
    if (document["day"].text().empty()) document["day"].fail("is empty", remedy);
    std::set<std::string> done;
    for (const YamlValue& attempt : document["attempts"].list()) {
        const std::string state = attempt["state"].text();
        if (state == "done") check_done(attempt);
        if (state == "failed") require(attempt, {"step", "problem"});
        if (state == "done" && !done.insert(attempt["id"].text()).second)
            attempt["id"].fail("is that of another attempt that is done", remedy);
    }
    return read_members<DayList>(document);
}

}  // namespace runcert
