#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/text.h"
#include "make/day_list.h"
#include "schemas/attempt/attempt.h"
#include "schemas/common/strict_texts.h"
#include "store/atomic_file.h"
#include "store/pattern.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
/// A file that an attempt's keys name.
struct NamedFile {
    std::string pointer;  ///< RFC 6901, in the keys
    std::string key;      ///< "recording"
    std::string name;
};
using Files = std::vector<NamedFile>;

void add_files(const Json& keys, const char* key, const Json::json_pointer& at, Files& files) {
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

/// The files that an attempt's keys name, the receivers' first, in their order; a name that is not
/// text is passed over.
Files named_files(const Json& keys) {
    Files files;
    if (keys.contains("receivers") && keys["receivers"].is_array())
        for (std::size_t i = 0; i < keys["receivers"].size(); ++i) {
            const Json& receiver = keys["receivers"][i];
            const Json::json_pointer at = Json::json_pointer("/receivers") / i;
            for (const char* key : {"recording", "base", "navigation", "phase"})
                add_files(receiver, key, at, files);
            for (const char* beside : {"imu", "surface"})
                if (receiver.is_object() && receiver.contains(beside))
                    for (const char* key : {"file", "triangles"})
                        add_files(receiver[beside], key, at / beside, files);
        }
    for (const FieldRule& rule : attempt_schema().fields())
        if (!rule.series.empty() && keys.contains(rule.path))
            add_files(keys[rule.path], "file", Json::json_pointer() / rule.path, files);
    return files;
}

/// Why a name, or pattern, cannot be that of a file in the day's folder, by its letters alone;
/// empty if it can.
std::string fault_of_name(const std::string& name) {
    if (name.empty()) return "is empty";
    if (name.find('\0') != std::string::npos) return "is not a path: it holds a NUL";
    const fs::path path(name);
    const bool climbs = std::find(path.begin(), path.end(), "..") != path.end();
    if (path.is_absolute() || climbs) return "is outside of the day file's folder";
    if (name.find("**") != std::string::npos) return "has **, which is not read";
    return {};
}

/// Why a name is not that of a file in the folder, or is that of one outside of it by a symbolic
/// link; empty if all is well.
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

std::string quoted(const std::string& text) {
    return fmt::format("\"{}\"", plain_text(text));
}

std::string stem_of(const std::string& name) {
    return fs::path(name).stem().string();
}

/// One entry of a day file, which is one attempt or stands for several.
class EntryReader {
  public:
    EntryReader(const DayEntry& entry, const fs::path& file)
        : entry_(entry), folder_(folder_of(file)), file_name_(file.filename().string()) {}

    ListedAttempts attempts() {
        try {
            if (entry_.refused) throw Failure(*entry_.refused);
            return {entry_.attempt.empty() ? written_here() : from_files(), notes_};
        } catch (const Failure& failure) {
            return {{{.attempt = refused(id_from_name(label()), "", failure), .has_id = false}},
                    {}};
        }
    }

  private:
    [[noreturn]] void fail(const std::string& what, const std::string& remedy) const {
        throw Failure(entry_.place, what, remedy);
    }

    /// "day.yaml:14", and the file that a pattern led to.
    std::string source(const std::string& file) const {
        return fmt::format("{}:{}{}", plain_text(file_name_), entry_.line,
                           file.empty() ? "" : " (" + plain_text(file) + ")");
    }

    /// A name for an entry that is refused as a whole.
    std::string label() const {
        if (!entry_.attempt.empty()) return stem_of(entry_.attempt);
        if (entry_.keys->contains("id")) return entry_.keys.at("id").get<std::string>();
        const Files files = named_files(entry_.keys);
        return files.empty() ? fmt::format("line-{}", entry_.line) : stem_of(files[0].name);
    }

    DayAttempt refused(std::string id, const std::string& file, const Failure& failure) const {
        return {.id = std::move(id), .source = source(file), .folder = folder_, .refused = failure};
    }

    std::vector<PatternMatch> matches_of(const std::string& pattern) const {
        std::vector<PatternMatch> matches;
        try {
            matches = matching_files(folder_, pattern);
        } catch (const Failure& failure) {
            fail(fmt::format("the files of {} cannot be listed: {}: {}", quoted(pattern),
                             plain_text(failure.where()), failure.problem()),
                 failure.remedy());
        }
        if (matches.empty())
            fail("no file matches the pattern " + quoted(pattern),
                 "Correct it; it is relative to the day file's folder");
        return matches;
    }

    std::vector<ListedAttempt> from_files() const {
        if (!is_pattern(entry_.attempt))
            return {attempt_of_file(folder_ / entry_.attempt, plain_text(entry_.attempt))};
        std::vector<ListedAttempt> attempts;
        for (const PatternMatch& match : matches_of(entry_.attempt))
            attempts.push_back(attempt_of_file(folder_ / match.file, plain_text(match.file)));
        return attempts;
    }

    std::vector<ListedAttempt> written_here() {
        const Files files = named_files(entry_.keys);
        for (const NamedFile& file : files)
            if (const std::string fault = fault_of_name(file.name); !fault.empty())
                fail(fmt::format("{}: {} {}", file.key, quoted(file.name), fault),
                     "Name a file inside of the day file's folder, relative to it");
        const auto leading = std::find_if(files.begin(), files.end(),
                                          [](const NamedFile& f) { return is_pattern(f.name); });
        // Without a pattern the id can be made of the recording's name.
        std::vector<PatternMatch> matches;
        if (leading == files.end())
            matches.push_back(
                {.file = "", .stood_for = {files.empty() ? "" : stem_of(files[0].name)}});
        else
            matches = matches_of(leading->name);
        check_id(matches.size());
        if (leading != files.end()) require_fitting(files, *leading);
        // A file whose name no attempt can hold is refused by itself.
        const auto nameable = std::ranges::find_if(
            matches, [&](const PatternMatch& match) { return !hidden_character(match.file); });
        check_keys(filled(files, nameable == matches.end() ? matches[0] : *nameable));
        std::vector<ListedAttempt> attempts;
        for (const PatternMatch& match : matches)
            attempts.push_back({.attempt = made(files, match)});
        return attempts;
    }

    /// The entry's id, which may be a pattern; * for the text that the recording's pattern stands
    /// for where it has none.
    std::string id_pattern() const {
        return entry_.keys->contains("id") ? entry_.keys.at("id").get<std::string>() : "*";
    }

    void check_id(std::size_t matches) const {
        const std::string pattern = id_pattern();
        if (!is_id(filled_in(pattern, std::vector<std::string>(wildcard_count(pattern), "x"))))
            fail(fmt::format("\"{}\" cannot be an id", escape_for_message(pattern)),
                 "Use 1 to 64 letters, digits, - and _, not beginning with -");
        if (matches > 1 && !is_pattern(pattern))
            fail(fmt::format("the id \"{}\" would name the attempts of {} files", pattern, matches),
                 "Write * in it, for the text that the recording's * stands for, or leave it out");
    }

    /// Failure if a pattern of the entry cannot be filled in with what the leading one stands
    /// for.
    void require_fitting(const Files& files, const NamedFile& leading) const {
        const std::size_t wanted = wildcard_count(leading.name);
        const auto require = [&](const std::string& key, const std::string& pattern, bool fits) {
            if (!fits)
                fail(fmt::format("the patterns {} of the {} and {} of the {} differ in how many "
                                 "parts they leave open",
                                 quoted(pattern), key, quoted(leading.name), leading.key),
                     "Write as many * in the one as in the other, each for the same text");
        };
        for (const NamedFile& file : files)
            require(file.key, file.name,
                    !is_pattern(file.name) || wildcard_count(file.name) == wanted);
        const std::size_t in_id = wildcard_count(id_pattern());
        require("id", id_pattern(), in_id <= 1 || in_id == wanted);
    }

    Json filled(const Files& files, const PatternMatch& match) const {
        Json keys = entry_.keys;
        for (const NamedFile& file : files)
            if (is_pattern(file.name))
                keys[Json::json_pointer(file.pointer)] = filled_in(file.name, match.stood_for);
        return keys;
    }

    /// The id of one attempt, with a note where a name had to be changed for it.
    std::string id_of(const PatternMatch& match) {
        const std::string pattern = id_pattern();
        std::vector<std::string> stood_for = match.stood_for;
        if (wildcard_count(pattern) == 1)
            stood_for = {fmt::format("{}", fmt::join(stood_for, "-"))};
        const std::string name = is_pattern(pattern) ? filled_in(pattern, stood_for) : pattern;
        std::string id = id_from_name(name);
        if (id != name)
            notes_.push_back(
                fmt::format("{}: {} as an id is {}", source(match.file), quoted(name), id));
        return id;
    }

    /// Failure in the words of the entry where its keys do not make an attempt.
    void check_keys(Json keys) const {
        keys["id"] = "x";
        try {
            (void)read_attempt(attempt_text(keys, ""), file_name_);
        } catch (const Failure& failure) {
            std::string problem = failure.problem();
            if (entry_.short_form)
                for (const std::string_view part : {"receivers[0].", "receivers[]."})
                    if (const std::size_t at = problem.find(part); at != std::string::npos)
                        problem.erase(at, part.size());
            fail(problem, failure.remedy());
        }
    }

    DayAttempt made(const Files& files, const PatternMatch& match) {
        Json keys = filled(files, match);
        const std::string id = id_of(match);
        keys["id"] = id;
        for (const NamedFile& file : named_files(keys))
            if (const std::string fault = fault_of_file(folder_, file.name); !fault.empty())
                return refused(id, match.file,
                               Failure(entry_.place,
                                       fmt::format("{}: {} {}", file.key, quoted(file.name), fault),
                                       "Correct its name, which is relative to the day file's "
                                       "folder, or put the file there"));
        // No line number, which moves with everything above it: a run is made again where the text
        // of its attempt has changed.
        const std::string comment = fmt::format("Made by runcert batch from {}, the attempt {}.",
                                                escape_for_message(file_name_, 255), id);
        return {.id = id,
                .source = source(match.file),
                .text = attempt_text(keys, comment),
                .folder = folder_};
    }

    const DayEntry& entry_;
    fs::path folder_;
    std::string file_name_;
    std::vector<std::string> notes_;
};

}  // namespace

ListedAttempts attempts_of_day(const DayFile& day, const fs::path& file) {
    ListedAttempts all;
    for (const DayEntry& entry : day.entries) {
        ListedAttempts some = EntryReader(entry, file).attempts();
        std::move(some.attempts.begin(), some.attempts.end(), std::back_inserter(all.attempts));
        std::move(some.notes.begin(), some.notes.end(), std::back_inserter(all.notes));
    }
    return all;
}

}  // namespace runcert
