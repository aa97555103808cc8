#include "batch/named_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/plain_text.h"
#include "core/text.h"
#include "schemas/attempt/attempt.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void add_files(const Json& keys, const char* key, const Json::json_pointer& at,
               std::vector<NamedFile>& files) {
    if (!keys.is_object() || !keys.contains(key)) return;
    const Json& value = keys[key];
    const auto add = [&](const Json& name, const Json::json_pointer& place) {
        if (name.is_string()) files.push_back({place.to_string(), key, name.get<std::string>()});
    };
    add(value, at / key);
    if (value.is_array())
        for (std::size_t i = 0; i < value.size(); ++i)
            add(value[i], at / key / i);
}

}  // namespace

std::vector<NamedFile> named_files(const Json& keys) {
    std::vector<NamedFile> files;
    if (keys.contains("receivers") && keys["receivers"].is_array())
        for (std::size_t i = 0; i < keys["receivers"].size(); ++i)
            for (const char* key : {"recording", "base", "navigation", "phase"})
                add_files(keys["receivers"][i], key, Json::json_pointer("/receivers") / i, files);
    for (const FieldRule& rule : attempt_schema().fields())
        if (!rule.series.empty() && keys.contains(rule.path))
            add_files(keys[rule.path], "file", Json::json_pointer() / rule.path, files);
    return files;
}

std::string fault_of_name(const std::string& name) {
    if (name.empty()) return "is empty";
    if (name.find('\0') != std::string::npos) return "is not a path: it holds a NUL";
    const fs::path path(name);
    const bool climbs = std::find(path.begin(), path.end(), "..") != path.end();
    if (path.is_absolute() || climbs) return "is outside of the day file's folder";
    if (name.find("**") != std::string::npos) return "has **, which is not read";
    return {};
}

std::string fault_of_file(const fs::path& folder, const std::string& name) {
    try {
        (void)Json(name).dump();  // as YAML it is written the same way
    } catch (const Json::exception&) {
        return "is not UTF-8, which is all that an attempt can name a file in";
    }
    if (const auto hidden = hidden_character(name))
        return fmt::format("holds {}, which cannot be shown as it stands: rename the file",
                           *hidden);
    std::error_code error;
    if (!fs::exists(folder / name, error)) return "does not exist";
    const fs::path root = fs::weakly_canonical(folder, error);
    const fs::path path = fs::weakly_canonical(folder / name, error);
    if (std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first != root.end())
        return "is outside of the day file's folder, by a symbolic link";
    return {};
}

}  // namespace runcert
