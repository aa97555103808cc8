#include "run/staging_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "store/user_state.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* report_name = "report.json";

/// The lock of a folder, where nobody has it.
std::optional<FileDescriptor> locked(const Folder& folder) {
    FileDescriptor file(openat(folder.number(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!file.is_open() || flock(file.number(), LOCK_EX | LOCK_NB) != 0) return std::nullopt;
    return file;
}

/// Removes a folder, unless a program is at work in it. What cannot be removed stays: it harms
/// nobody.
void remove_unless_locked(const Folder& parent, const std::string& name) {
    try {
        const Folder folder = parent.open(name);
        if (const auto lock = locked(folder)) parent.remove_tree(name);
    } catch (const Failure&) {
    }
}

bool is_mount_point(const Folder& folder, const Folder& parent) {
    struct statx facts {};
    if (statx(folder.number(), "", AT_EMPTY_PATH, 0, &facts) != 0) return false;
    if (facts.stx_attributes & facts.stx_attributes_mask & STATX_ATTR_MOUNT_ROOT) return true;
    struct stat inner {};
    struct stat outer {};
    return fstat(folder.number(), &inner) == 0 && fstat(parent.number(), &outer) == 0 &&
           inner.st_dev != outer.st_dev;
}

/// Whether this program, and so perhaps the shell that started it, is in the folder.
bool is_working_folder(const Folder& folder) {
    std::error_code error;
    const fs::path here = fs::current_path(error);
    if (error) return false;
    const fs::path way = here.lexically_relative(fs::canonical(folder.path(), error));
    return !error && !way.empty() && *way.begin() != "..";
}

bool may_be_exchanged(const Folder& run, const Folder& parent) {
    if (is_mount_point(run, parent) || is_working_folder(run)) return false;
    return std::ranges::none_of(run.names(), [&run](const std::string& name) {
        return run.kind_of(name) == EntryKind::folder && !is_run_subfolder(name);
    });
}

void sync_all(const Folder& folder) {
    std::vector<fs::path> files;
    for (const std::string& name : folder.names()) {
        if (folder.kind_of(name) == EntryKind::folder)
            sync_all(folder.open(name));
        else if (folder.kind_of(name) == EntryKind::file)
            files.push_back(folder.path() / name);
    }
    sync_files(files);
    folder.sync();
}

/// The folder that takes another's place has its permissions, and its owner where that can be.
void take_permissions(const Folder& from, const Folder& to) {
    struct stat facts {};
    const FileDescriptor opened(openat(to.number(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!opened.is_open() || fstat(from.number(), &facts) != 0) return;
    [[maybe_unused]] const int owner = fchown(opened.number(), facts.st_uid, facts.st_gid);
    [[maybe_unused]] const int mode = fchmod(opened.number(), facts.st_mode & 07777U);
}

/// The names of a run's entries in the order in which they are put in place: what was superseded
/// first, since nothing of it may be lost, and the report last.
std::vector<std::string> report_last(const Folder& folder) {
    std::vector<std::string> names = folder.names();
    std::ranges::stable_sort(names, {}, [&folder](const std::string& name) {
        return name == report_name                         ? 3
               : name.starts_with("report.")               ? 2
               : folder.kind_of(name) == EntryKind::folder ? 0
                                                           : 1;
    });
    return names;
}

/// Has all that is in `from` in `to` too.
void place_all(const Folder& from, const Folder& to) {
    for (const std::string& name : report_last(from))
        if (from.kind_of(name) == EntryKind::folder)
            place_all(from.open(name), to.make(name));
        else if (from.kind_of(name) == EntryKind::file || to.kind_of(name) == EntryKind::none)
            from.place(name, to);
}

/// What a run folder holds of a run, also where its report is gone.
std::string published_in(const fs::path& run_dir) {
    return about_folder("published in", run_dir);
}

/// Gives a run folder the contents of another one, file by file. Whatever of the user's is to stay
/// is in that one.
void put_in_place(const Folder& made, const Folder& run) {
    if (made.kind_of("superseded") == EntryKind::folder)
        place_all(made.open("superseded"), run.make("superseded"));
    run.remove(report_name);
    for (const std::string& name : run.names())
        if (made.kind_of(name) == EntryKind::none && run.kind_of(name) != EntryKind::folder)
            run.remove(name);
    place_all(made, run);
    run.sync();
}

struct NamedIn {
    Folder parent;
    std::string name;
};

/// A run folder's name in the folder that it lies in, whatever the path to it looks like.
NamedIn named_in(const fs::path& run_dir) {
    make_directory(run_dir);
    const fs::path name = run_dir.filename();
    const bool plain = !name.empty() && name != "." && name != ".." && !fs::is_symlink(run_dir);
    const fs::path real = plain ? run_dir : fs::canonical(run_dir);
    if (!real.has_filename())
        throw Failure(run_dir.string(), "this is no folder for a run", "Name a folder in it");
    return {.parent = Folder(folder_of(real)), .name = real.filename().string()};
}

}  // namespace

Published last_published(const fs::path& run_dir) {
    std::vector<std::string> lines = lines_of(recalled(published_in(run_dir)));
    if (lines.empty()) return {};
    return {.report_sha256 = lines.front(), .names = {lines.begin() + 1, lines.end()}};
}

void clear_abandoned(const Folder& folder) {
    try {
        for (const std::string& name : folder.names())
            if (is_own_name(name) && folder.kind_of(name) == EntryKind::folder)
                remove_unless_locked(folder, name);
    } catch (const Failure&) {
        // A folder that may not be listed: what was left there stays.
    }
}

StagingFolder::StagingFolder(const fs::path& run_dir)
    : StagingFolder([&run_dir] {
          const bool created = !fs::exists(run_dir);
          NamedIn named = named_in(run_dir);
          return Place{std::move(named.parent), std::move(named.name), created};
      }()) {
    clear_abandoned(parent_);
}

StagingFolder::StagingFolder(const Folder& parent, const std::string& name)
    : StagingFolder(Place{parent.again(), name, parent.kind_of(name) == EntryKind::none}) {}

StagingFolder::StagingFolder(Place place)
    : parent_(std::move(place.parent)), name_(std::move(place.name)), created_(place.created) {
    do {  // whoever had the lock may have removed the folder
        (void)parent_.make(name_);
        lock_.emplace(parent_, name_);
    } while (parent_.kind_of(name_) == EntryKind::none);
    run_ = parent_.open(name_);
    clear_abandoned(*run_);
    bool beside = may_be_exchanged(*run_, parent_);
    do {  // another program may take one that is not locked yet for a killed program's
        own_name_ = own_name();
        // Whoever may write in the run folder need not be let to write beside it.
        beside = beside && mkdirat(parent_.number(), own_name_.c_str(), 0700) == 0;
        inside_ = !beside;
        own_ = around().make(own_name_);
        if (auto lock = locked(*own_)) own_lock_ = std::move(*lock);
    } while (!around().has(own_->number(), own_name_));
    staged_ = own_->make(name_);  // by which a program of a stage is told from others
}

StagingFolder::~StagingFolder() {
    // Closing alone would wait for a program that another thread is just starting.
    if (own_lock_.is_open()) flock(own_lock_.number(), LOCK_UN);
    try {
        around().remove_tree(own_name_);
    } catch (const Failure&) {
        // The next call removes it.
    }
    if (created_) unlinkat(parent_.number(), name_.c_str(), AT_REMOVEDIR);
}

void StagingFolder::publish() {
    sync_all(*staged_);
    if (!parent_.has(run_->number(), name_))
        throw Failure((parent_.path() / name_).string(),
                      "the run folder was replaced while this run was made",
                      "Find out what else writes there, and run this again");
    std::string published = staged_->kind_of(report_name) == EntryKind::file
                                ? sha256_hex(staged_->read(report_name))
                                : "";
    for (const Folder* folder : {&*run_, &*staged_})
        for (const std::string& name : folder->names())
            published += "\n" + name;
    remember(published_in(parent_.path() / name_), published);
    // A folder that the user made in it meanwhile has it replaced in place.
    if (!inside_ && may_be_exchanged(*run_, parent_)) {
        take_permissions(*run_, *staged_);
        if (own_->exchange(name_, parent_, name_)) return parent_.sync();
    }
    put_in_place(*staged_, *run_);
}

}  // namespace runcert
