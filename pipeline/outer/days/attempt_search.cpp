#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "days/day_list.h"
#include "run/attempt_files.h"
#include "schemas/attempt/attempt.h"
#include "schemas/common/product_files.h"
#include "schemas/common/strict_texts.h"
#include "store/atomic_file.h"
#include "store/yaml_input.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using FolderIdentity = std::pair<dev_t, ino_t>;

std::optional<FolderIdentity> identity_of(const fs::path& folder) {
    struct stat status {};
    if (::stat(folder.c_str(), &status) != 0) return std::nullopt;
    return FolderIdentity{status.st_dev, status.st_ino};
}

bool is_yaml_name(const std::string& file_name) {
    const std::string name = lower_case(file_name);
    return name.ends_with(".yaml") || name.ends_with(".yml");
}

std::string quoted_name(const std::string& name) {
    return fmt::format("\"{}\"", plain_text(name.empty() ? "." : name));
}

class Search {
  public:
    Search(fs::path root, const fs::path& out) : root_(std::move(root)), out_(identity_of(out)) {}

    AttemptSearch run() {
        enter("");
        // Folders before links to folders, so that one reached both ways is known by its own name.
        while (!folders_.empty() || !links_.empty()) {
            std::set<std::string>& next = folders_.empty() ? links_ : folders_;
            enter(next.extract(next.begin()).value());
        }
        std::sort(found_.files.begin(), found_.files.end());
        if (run_folders_ > 0)
            note(fmt::format("passed over {} of earlier results",
                             counted(run_folders_, "run folder")));
        return std::move(found_);
    }

  private:
    void note(std::string text) { found_.notes.push_back(std::move(text)); }

    /// Whether a folder is to be searched; what is passed over is noted.
    bool is_new(const std::string& folder) {
        const auto identity = identity_of(root_ / folder);
        if (identity && identity == out_) {
            note("the folder " + quoted_name(folder) + " of the results was not searched");
            return false;
        }
        if (!identity) return true;  // reading it says why
        const auto [known, added] = searched_.emplace(*identity, folder);
        if (!added)
            note("the folder " + quoted_name(folder) + " leads to " + quoted_name(known->second) +
                 ", which is searched already: not searched twice");
        return added;
    }

    void enter(const std::string& folder) {
        if (!is_new(folder)) return;
        std::error_code error;
        std::vector<fs::directory_entry> entries;
        for (fs::directory_iterator entry(root_ / folder, error);
             !error && entry != fs::directory_iterator(); entry.increment(error))
            entries.push_back(*entry);
        if (error)
            note("the folder " + quoted_name(folder) + " cannot be read (" + error.message() +
                 "): attempts in it are not in the day");
        const auto holds = [&](std::string_view name) {
            return std::any_of(entries.begin(), entries.end(),
                               [&](const auto& entry) { return entry.path().filename() == name; });
        };
        if (holds(attempt_copy_name) && holds(products::observations_file)) {
            ++run_folders_;
            return;
        }
        std::sort(entries.begin(), entries.end());
        for (const fs::directory_entry& entry : entries)
            look_at(folder, entry);
    }

    void look_at(const std::string& folder, const fs::directory_entry& entry) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with('.')) return;
        const std::string path = folder.empty() ? name : folder + "/" + name;
        std::error_code error;
        if (entry.is_directory(error))
            (entry.is_symlink(error) ? links_ : folders_).insert(path);
        else if (is_yaml_name(name))
            look_at_file(path, name == attempt_copy_name);
    }

    void look_at_file(const std::string& path, bool named_attempt) {
        if (named_attempt) {
            found_.files.push_back(path);
            return;
        }
        std::error_code error;
        const std::uintmax_t size = fs::file_size(root_ / path, error);
        if (!error && size > longest_handwritten) return;  // what a program wrote
        try {
            const std::string schema = written_schema(read_handwritten(root_ / path));
            if (schema.starts_with("attempt/")) found_.files.push_back(path);
            if (schema.starts_with("day/"))
                note("the file " + quoted_name(path) +
                     " is a day of its own: its attempts are not in this one");
        } catch (const Failure& failure) {
            note("the file " + quoted_name(path) +
                 " may be an attempt and cannot be read: " + plain_text(failure.problem()));
        }
    }

    fs::path root_;
    std::optional<FolderIdentity> out_;
    std::map<FolderIdentity, std::string> searched_;
    std::set<std::string> folders_, links_;
    std::int64_t run_folders_ = 0;
    AttemptSearch found_;
};

bool is_plain(std::string_view value) {
    return !value.empty() && std::all_of(value.begin(), value.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view("_-./").find(c) != std::string_view::npos;
    });
}

/// The value on a line after its key, without quotes and comment.
std::string_view value_on_line(std::string_view rest) {
    if (const std::size_t comment = rest.find(" #"); comment != std::string_view::npos)
        rest = rest.substr(0, comment);
    rest = trim(rest);
    const bool quoted = rest.size() >= 2 && (rest.front() == '"' || rest.front() == '\'') &&
                        rest.back() == rest.front();
    return quoted ? rest.substr(1, rest.size() - 2) : rest;
}

/// The value of a key that begins a line, if it is of letters, digits and _ - . / alone and only
/// one line begins with the key.
std::optional<std::string> top_value(std::string_view text, std::string_view key) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    std::optional<std::string> found;
    for (bool more = !text.empty(); more;) {
        const std::size_t end = text.find('\n');
        const std::string_view line = text.substr(0, end);
        more = end != std::string_view::npos;
        if (more) text.remove_prefix(end + 1);
        if (!line.starts_with(key) || !line.substr(key.size()).starts_with(": ")) continue;
        const std::string_view value = value_on_line(line.substr(key.size() + 1));
        if (found || !is_plain(value)) return std::nullopt;
        found = std::string(value);
    }
    return found;
}

/// The id of an attempt where it stands on a line of its own, once. Quick: parsing the file takes a
/// millisecond. Nothing in case of doubt.
std::optional<std::string> quick_id(std::string_view text) {
    auto id = top_value(text, "id");
    return id && is_id(*id) ? id : std::nullopt;
}

}  // namespace

AttemptSearch find_attempts(const fs::path& folder, const fs::path& out) {
    return Search(folder, out).run();
}

std::string written_schema(std::string_view text) {
    if (auto schema = top_value(text, "schema")) return *schema;
    // Parsing is slow, and a folder may hold any number of YAML files of other programs.
    if (text.find("attempt/") == std::string_view::npos &&
        text.find("day/") == std::string_view::npos)
        return {};
    try {
        const YamlValue document(parse_yaml(text, "file"), "file");
        return document.is_map() ? document["schema"].text_or("") : "";
    } catch (const Failure&) {
        return {};
    }
}

ListedAttempt attempt_of_file(const fs::path& file, const std::string& source) {
    ListedAttempt listed{
        .attempt = {.id = id_from_name(fs::path(source).replace_extension().string()),
                    .source = source,
                    .file = file,
                    .folder = folder_of(file)}};
    GivenAttempt& attempt = listed.attempt;
    try {
        attempt.text = read_handwritten(file);
        const auto id = quick_id(attempt.text);
        attempt.id = id && written_schema(attempt.text).starts_with("attempt/")
                         ? *id
                         : read_attempt(attempt.text, file.string()).id;
    } catch (const Failure& failure) {
        attempt.refused = failure;
        listed.has_id = false;
    }
    return listed;
}

}  // namespace runcert
