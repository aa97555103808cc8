#include "run/ready_run.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "core/failure.h"
#include "run/run_lock.h"
#include "schemas/common/product_files.h"
#include "store/record_key.h"
#include "store/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* record_name = "record";
constexpr const char* report_name = "report.json";

/// Paths of files, with the SHA-256 of each.
using Hashes = std::map<std::string, std::string>;

/// The files of a folder and of those of a run in it, as paths. Others in it are the user's own.
std::vector<std::string> files_of(const Folder& folder, const std::string& path = {}) {
    std::vector<std::string> files;
    for (const std::string& name : folder.names()) {
        const EntryKind kind = folder.kind_of(name);
        if (kind == EntryKind::file) files.push_back(path + name);
        if (kind != EntryKind::folder || (path.empty() && !is_run_subfolder(name))) continue;
        const auto inside = files_of(folder.open(name), path + name + "/");
        files.insert(files.end(), inside.begin(), inside.end());
    }
    return files;
}

/// Whether both folders have one file, not two of the same bytes, by that path.
bool have_one_file(const Folder& one, const Folder& other, const std::string& path) {
    struct stat in_one {};
    struct stat in_other {};
    return fstatat(one.number(), path.c_str(), &in_one, AT_SYMLINK_NOFOLLOW) == 0 &&
           fstatat(other.number(), path.c_str(), &in_other, AT_SYMLINK_NOFOLLOW) == 0 &&
           in_one.st_dev == in_other.st_dev && in_one.st_ino == in_other.st_ino;
}

/// The files of a run folder that the run which is ready takes away or replaces. The user's own
/// stand in both.
Hashes replaced_files(const Folder& run, const Folder& made) {
    Hashes hashes;
    for (const std::string& path : files_of(run))
        if (!have_one_file(run, made, path)) hashes[path] = digest_file(run.path() / path).sha256;
    return hashes;
}

std::string record_text(const Folder& run, const Folder& ready) {
    return nlohmann::ordered_json{{"form", "runcert-ready/1"},
                                  {"run_folder", identity_of(run)},
                                  {"folder", identity_of(ready)},
                                  {"replaced", replaced_files(run, ready.open(staged_name))}}
        .dump(1);
}

/// The record's text, where this user's program sealed it; nothing of another one is read.
std::optional<std::string> sealed_text(const Folder& ready) {
    constexpr std::uintmax_t longest = std::uintmax_t{64} << 20;
    std::error_code error;
    if (ready.kind_of(record_name) != EntryKind::file ||
        fs::file_size(ready.path() / record_name, error) > longest)
        return std::nullopt;
    std::string text = ready.read(record_name);
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string seal = text.substr(0, end);
    text.erase(0, end + 1);
    return is_own_seal(text, seal) ? std::optional(std::move(text)) : std::nullopt;
}

/// The files that may go or be replaced, by the record of what is ready. Failure where this user's
/// program did not write it for these very folders.
Hashes replaced_by(const Folder& run) {
    if (run.kind_of(ready_name) == EntryKind::folder) {
        const Folder ready = run.open(ready_name);
        if (const auto text = sealed_text(ready)) {
            const auto json = nlohmann::json::parse(*text);
            if (json.at("form") == "runcert-ready/1" && json.at("run_folder") == identity_of(run) &&
                json.at("folder") == identity_of(ready))
                return json.at("replaced").get<Hashes>();
        }
    }
    throw Failure((run.path() / ready_name).string(),
                  "this is not what a program of yours left here when it was killed; nothing in it "
                  "was put in place, and nothing was removed",
                  "Move it out of the run folder, and run this again. Where it is of another user "
                  "or computer, a whole run may be in the folder \"run\" in it");
}

/// Failure where a file that is to be put in place would replace one that was put there since.
void require_free(const Folder& run, const Folder& made, const Hashes& replaced) {
    for (const std::string& path : files_of(made)) {
        const EntryKind kind = run.kind_of(path);
        if (kind == EntryKind::none || kind == EntryKind::link || have_one_file(run, made, path))
            continue;
        const auto known = replaced.find(path);
        const std::string sha256 =
            kind == EntryKind::file ? digest_file(run.path() / path).sha256 : "";
        if ((known == replaced.end() || known->second != sha256) &&
            digest_file(made.path() / path).sha256 != sha256)
            throw Failure((run.path() / path).string(),
                          "this was put here after a program was killed that had a new run ready; "
                          "it is not replaced",
                          "Move it away, and run this again");
    }
}

/// The names of a folder's entries in the order in which they are put in place.
std::vector<std::string> report_last(const Folder& folder) {
    std::vector<std::string> names = folder.names();
    std::ranges::stable_sort(names, {}, [](const std::string& name) {
        return name == report_name ? 2 : name.starts_with("report.") ? 1 : 0;
    });
    return names;
}

/// Has all that is in `from` in `to` too. The user's links are there already.
void place_all(const Folder& from, const Folder& to) {
    for (const std::string& name : report_last(from))
        if (from.kind_of(name) == EntryKind::folder)
            place_all(from.open(name), to.make(name));
        else if (from.kind_of(name) == EntryKind::file || to.kind_of(name) == EntryKind::none)
            from.place(name, to);
}

}  // namespace

void write_ready_record(const Folder& run, const Folder& own) {
    const std::string text = record_text(run, own);
    own.write(record_name, own_seal(text) + "\n" + text);
}

void finish_in_place(const Folder& run) {
    {
        const Hashes replaced = replaced_by(run);
        const Folder made = run.open(ready_name).open(staged_name);
        require_free(run, made, replaced);
        const auto may_go = [&](const std::string& name) {
            const auto known = replaced.find(name);
            return known != replaced.end() && run.kind_of(name) == EntryKind::file &&
                   digest_file(run.path() / name).sha256 == known->second;
        };
        for (const std::string& name : run.names())
            if ((name == report_name || is_page_name(name)) && may_go(name)) run.remove(name);
        for (const std::string& name : run.names())
            if (made.kind_of(name) == EntryKind::none && may_go(name)) run.remove(name);
        place_all(made, run);
    }
    run.sync();
    // What is half removed is not taken for ready.
    const std::string done = own_name(run, "done");
    run.rename(ready_name, run, done);
    run.remove_tree(done);
}

}  // namespace runcert
