#include "run/staging_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

#include "core/failure.h"
#include "run/ready_run.h"
#include "store/atomic_file.h"
#include "store/record_key.h"
#include "store/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// What its staging folders are named by, whatever a run is called.
std::string mark_of(const std::string& run) {
    constexpr std::size_t digits = 16;
    return sha256_hex(run).substr(0, digits);
}

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

void clear_inside(const Folder& run) {
    if (run.kind_of(ready_name) != EntryKind::none) finish_in_place(run);
    for (const std::string& name : run.names())
        if (is_own_name(run, name)) {
            if (run.kind_of(name) == EntryKind::folder)
                remove_unless_locked(run, name);
            else if (name.ends_with(".tmp"))
                run.remove(name);
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

void clear_abandoned(const Folder& parent, const std::string& name) {
    std::vector<std::string> beside;
    try {
        beside = parent.names();
    } catch (const Failure&) {
        // A folder that may not be listed: what was left there stays.
    }
    const std::string begin = ".runcert-" + mark_of(name) + "-";
    for (const std::string& each : beside)
        if (each.starts_with(begin) && is_own_name(parent, each))
            remove_unless_locked(parent, each);
    if (parent.kind_of(name) == EntryKind::folder) clear_inside(parent.open(name));
}

StagingFolder::StagingFolder(const fs::path& run_dir)
    : StagingFolder([&run_dir] {
          const bool created = !fs::exists(run_dir);
          NamedIn named = named_in(run_dir);
          return Place{std::move(named.parent), std::move(named.name), created};
      }()) {}

StagingFolder::StagingFolder(const Folder& parent, const std::string& name)
    : StagingFolder(Place{parent.again(), name, parent.kind_of(name) == EntryKind::none}) {}

StagingFolder::StagingFolder(Place place)
    : parent_(std::move(place.parent)), name_(std::move(place.name)), created_(place.created) {
    do {  // whoever had the lock may have removed the folder
        (void)parent_.make(name_);
        lock_.emplace(parent_, name_);
    } while (parent_.kind_of(name_) == EntryKind::none);
    run_ = parent_.open(name_);
    clear_abandoned(parent_, name_);
    open_beside_or_inside();
}

void StagingFolder::open_beside_or_inside() {
    own_name_ = own_name(parent_, mark_of(name_));
    inside_ = !may_be_exchanged(*run_, parent_) ||
              // Whoever may write in the run folder need not be let to write beside it.
              mkdirat(parent_.number(), own_name_.c_str(), 0700) != 0;
    if (inside_) own_name_ = own_name(*run_, mark_of(name_));
    own_ = inside_ ? run_->make(own_name_) : parent_.open(own_name_);
    own_lock_ = locked(*own_);
    staged_ = own_->make(staged_name);
}

StagingFolder::~StagingFolder() {
    try {
        place().remove_tree(own_name_);
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
    // A folder that the user made in it meanwhile has it replaced in place.
    if (!inside_ && may_be_exchanged(*run_, parent_)) {
        take_permissions(*run_, *staged_);
        if (own_->exchange(staged_name, parent_, name_)) return parent_.sync();
    }
    write_ready_record(*run_, *own_);
    place().rename(own_name_, *run_, ready_name);
    finish_in_place(*run_);
}

}  // namespace runcert
