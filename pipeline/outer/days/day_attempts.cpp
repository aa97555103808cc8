#include "days/day_attempts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>

#include "core/prose.h"
#include "core/text.h"
#include "days/day_list.h"
#include "schemas/day/day.h"
#include "store/atomic_file.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Paths = std::vector<fs::path>;

constexpr const char* day_file_name = "day.yaml";

/// The id of a day that no day file names: made from its folder's name.
std::string name_of_folder(const fs::path& folder) {
    std::error_code error;
    const fs::path path = fs::weakly_canonical(fs::absolute(folder, error), error);
    return id_from_name((path.has_filename() ? path : path.parent_path()).filename().string());
}

void require_other_folder(const fs::path& folder, const fs::path& out) {
    std::error_code error;
    if (fs::equivalent(folder, out, error))
        throw Failure(out.string(),
                      "the results' folder is the day's own: results and attempts would stand "
                      "among each other, and day.yaml over day.yaml",
                      "Name another folder with --out");
}

constexpr std::size_t longest_id = 64;

/// Where the others of one id stand, "heats/b.yaml and day.yaml:14"; at most three are named.
std::string others(const std::vector<GivenAttempt*>& alike, const GivenAttempt* one) {
    constexpr std::size_t most = 3;
    std::vector<std::string> sources;
    for (const GivenAttempt* other : alike)
        if (other != one && sources.size() < most)
            sources.push_back(other->source +
                              (other->id == one->id ? "" : " (as \"" + other->id + "\")"));
    if (alike.size() - 1 > most) sources.push_back(fmt::format("{} more", alike.size() - 1 - most));
    return listed(sources);
}

void refuse_same_ids(const std::vector<GivenAttempt*>& alike) {
    for (GivenAttempt* attempt : alike) {
        const bool same = std::all_of(alike.begin(), alike.end(), [&](const GivenAttempt* other) {
            return other->id == attempt->id;
        });
        attempt->refused.emplace(
            attempt->source,
            fmt::format("the id \"{}\" is that of {} too{}", attempt->id, others(alike, attempt),
                        same ? "" : ", but for the case of letters, which not every disk knows"),
            "Give each attempt an id of its own: it names the run folder");
    }
}

/// Refuses attempts that share an id, or whose ids differ in the case of letters alone, each naming
/// the others: which of them is meant nobody can know. Changes labels that are already taken.
std::vector<GivenAttempt> with_own_ids(std::vector<ListedAttempt> listed_attempts) {
    std::map<std::string, std::vector<GivenAttempt*>> by_id;
    for (ListedAttempt& each : listed_attempts)
        if (each.has_id) by_id[lower_case(each.attempt.id)].push_back(&each.attempt);
    for (const auto& [id, alike] : by_id)
        if (alike.size() > 1) refuse_same_ids(alike);

    std::set<std::string> taken;
    for (const auto& [id, alike] : by_id)
        taken.insert(id);
    std::vector<GivenAttempt> attempts;
    for (ListedAttempt& each : listed_attempts) {
        GivenAttempt& attempt = each.attempt;
        const std::string label = attempt.id;
        for (int n = 2; !each.has_id && !taken.insert(lower_case(attempt.id)).second; ++n) {
            const std::string number = fmt::format("-{}", n);
            attempt.id = label.substr(0, longest_id - number.size()) + number;
        }
        attempts.push_back(std::move(attempt));
    }
    return attempts;
}

Day listed_day(std::string name, ListedAttempts listed) {
    return {.name = std::move(name),
            .attempts = with_own_ids(std::move(listed.attempts)),
            .notes = std::move(listed.notes)};
}

Day day_of_file(const fs::path& file, const std::string& text, const fs::path& out) {
    require_other_folder(folder_of(file), out);
    const DayFile day = read_day_file(text, file.string());
    return listed_day(day.id.empty() ? name_of_folder(folder_of(file)) : day.id,
                      attempts_of_day(day, file));
}

/// The text of a folder's day file; nothing if there is none, or one of another schema. Failure
/// if it cannot be parsed: the folder is not searched instead, which would give another day.
std::optional<std::string> day_text_in(const fs::path& folder) {
    std::error_code error;
    const fs::path file = folder / day_file_name;
    if (!fs::exists(fs::symlink_status(file, error))) return std::nullopt;
    std::string text = read_handwritten(file);
    if (!written_schema(text).starts_with("day/")) {
        (void)parse_yaml(text, file.string());
        return std::nullopt;
    }
    return text;
}

Day day_of_folder(const fs::path& folder, const fs::path& out) {
    require_other_folder(folder, out);
    if (const auto text = day_text_in(folder)) {
        Day day = day_of_file(folder / day_file_name, *text, out);
        day.notes.insert(day.notes.begin(),
                         "the day is what its day.yaml says; the folder was not "
                         "searched for other attempts");
        return day;
    }
    AttemptSearch search = find_attempts(folder, out);
    if (search.files.empty()) {
        std::string notes;
        for (const std::string& note : search.notes)
            notes += "; " + note;
        throw Failure(
            folder.string(),
            "no attempt was found: neither a day.yaml of the schema day, nor at any depth "
            "a file *.yaml or *.yml that says \"schema: attempt/...\"" +
                notes,
            "Name a folder with attempts, a day file, or attempt files");
    }
    ListedAttempts listed{.notes = std::move(search.notes)};
    for (const std::string& file : search.files)
        listed.attempts.push_back(attempt_of_file(folder / file, plain_text(file)));
    return listed_day(name_of_folder(folder), std::move(listed));
}

/// Attempt files given by name; one given twice is taken once.
Day day_of_files(const Paths& given) {
    std::map<std::string, fs::path> files;  // in the order of their bytes
    ListedAttempts listed;
    for (const fs::path& file : given) {
        if (fs::is_directory(file))
            throw Failure(file.string(), "a folder is named beside other folders or files",
                          "Name one folder, one day file, or attempt files alone");
        if (!files.emplace(file.lexically_normal().string(), file).second)
            listed.notes.push_back(fmt::format("\"{}\" is named twice, and taken once",
                                               plain_text(file.lexically_normal().string())));
    }
    for (const auto& [path, file] : files)
        listed.attempts.push_back(attempt_of_file(file, plain_text(path)));
    const fs::path folder = folder_of(given[0]);
    const bool one_folder = std::all_of(given.begin(), given.end(), [&](const fs::path& file) {
        return folder_of(file) == folder;
    });
    return listed_day(one_folder ? name_of_folder(folder) : "day", std::move(listed));
}

}  // namespace

Day read_day(const std::vector<fs::path>& given, const fs::path& out) {
    if (given.empty())
        throw Failure("batch", "no day is named",
                      "Name a folder of attempts, a day file, or attempt files");
    if (given.size() > 1) return day_of_files(given);
    const fs::path& day = given[0];
    std::error_code error;
    if (fs::is_directory(day, error)) return day_of_folder(day, out);
    const std::string text = read_handwritten(day);
    if (written_schema(text).starts_with("attempt/")) return day_of_files({day});
    return day_of_file(day, text, out);
}

std::string id_from_name(std::string_view name) {
    std::string id;
    for (const char c : name) {
        const bool inside_character = (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
        if (inside_character) continue;
        const bool kept = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '-' || c == '_';
        if (id.size() < longest_id && !(id.empty() && (!kept || c == '-'))) id += kept ? c : '-';
    }
    return id.empty() ? "run" : id;
}

}  // namespace runcert
