#include "store/folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <system_error>

#include "core/failure.h"
#include "store/atomic_file.h"
#include "store/user_state.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

// Needs no permission to list the folder.
constexpr int open_folder = O_PATH | O_DIRECTORY | O_CLOEXEC;

/// What a user can do about a system error.
std::string remedy_for(int error) {
    switch (error) {
        case ENOENT:
        case ENOTDIR:
            return "Check the spelling of the path and that each folder in it exists";
        case EACCES:
        case EPERM:
            return "Change the permissions of the file or its folder, or choose another place";
        case EROFS:
            return "The file system is read-only: choose another place";
        case ENOSPC:
        case EDQUOT:
            return "Free some space there, or choose another place";
        case EFBIG:
            return "Raise the limit on file sizes (ulimit -f), or choose another place";
        case EISDIR:
            return "A folder has that name: name a file";
        case EEXIST:
            return "A file has that name: move it, or choose another name";
        case ENAMETOOLONG:
            return "Choose a shorter name";
        case EMFILE:
        case ENFILE:
            return "Raise the limit on open files (ulimit -n)";
        default:
            return "Check the disk it is on";
    }
}

[[noreturn]] void refuse_entry(const fs::path& path, EntryKind kind, int error) {
    if (kind == EntryKind::link)
        throw Failure(path.string(),
                      "this is a symbolic link, and nothing is written or removed through one",
                      "Remove the link, or name the folder that it leads to");
    fail_of_system(path, "cannot open this folder", error);
}

}  // namespace

void fail_of_system(const fs::path& path, const std::string& attempted, int error) {
    const std::string problem = attempted + ": " + std::generic_category().message(error);
    for (const int own : {ENOSPC, EDQUOT, EIO, ENOMEM, EMFILE, ENFILE})
        if (error == own) throw ComputerFailure(path.string(), problem, remedy_for(error));
    throw Failure(path.string(), problem, remedy_for(error));
}

Folder::Folder(const fs::path& named) : path_(named), folder_(::open(named.c_str(), open_folder)) {
    if (!folder_.is_open()) fail_of_system(named, "cannot open this folder", errno);
}

EntryKind Folder::kind_of(const std::string& name) const {
    struct stat facts {};
    if (fstatat(number(), name.c_str(), &facts, AT_SYMLINK_NOFOLLOW) != 0) return EntryKind::none;
    if (S_ISREG(facts.st_mode)) return EntryKind::file;
    if (S_ISDIR(facts.st_mode)) return EntryKind::folder;
    return S_ISLNK(facts.st_mode) ? EntryKind::link : EntryKind::other;
}

std::vector<std::string> Folder::names() const {
    const int listed = openat(number(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const std::unique_ptr<DIR, int (*)(DIR*)> entries(listed < 0 ? nullptr : fdopendir(listed),
                                                      closedir);
    if (!entries) fail_of_system(path_, "cannot list this folder", errno);
    std::vector<std::string> names;
    while (const dirent* entry = readdir(entries.get()))
        if (const std::string name = entry->d_name; name != "." && name != "..")
            names.push_back(name);
    std::ranges::sort(names);
    return names;
}

Folder Folder::open(const std::string& name) const {
    FileDescriptor opened(openat(number(), name.c_str(), open_folder | O_NOFOLLOW));
    if (!opened.is_open()) {
        const int error = errno;
        refuse_entry(path_ / name, kind_of(name), error);
    }
    return {path_ / name, std::move(opened)};
}

Folder Folder::make(const std::string& name) const {
    if (mkdirat(number(), name.c_str(), 0777) != 0 && errno != EEXIST)
        fail_of_system(path_ / name, "cannot make this folder", errno);
    return open(name);
}

std::string Folder::read(const std::string& name) const {
    const FileDescriptor file(
        openat(number(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (!file.is_open()) fail_of_system(path_ / name, "cannot open this file", errno);
    std::string bytes;
    read_pieces(file, path_ / name, [&](std::string_view piece) { bytes.append(piece); });
    return bytes;
}

void Folder::write(const std::string& name, std::string_view bytes) const {
    AtomicFile file(*this, name);
    file.write(bytes);
    file.commit();
}

void Folder::remove(const std::string& name) const {
    if (unlinkat(number(), name.c_str(), 0) != 0 && errno != ENOENT)
        fail_of_system(path_ / name, "cannot remove this file", errno);
}

void Folder::remove_tree(const std::string& name) const {
    if (kind_of(name) != EntryKind::folder) return remove(name);
    {
        const Folder inner = open(name);
        for (const std::string& each : inner.names())
            inner.remove_tree(each);
    }
    if (unlinkat(number(), name.c_str(), AT_REMOVEDIR) != 0 && errno != ENOENT)
        fail_of_system(path_ / name, "cannot remove this folder", errno);
}

void Folder::rename(const std::string& name, const Folder& to, const std::string& new_name) const {
    if (renameat(number(), name.c_str(), to.number(), new_name.c_str()) != 0)
        fail_of_system(to.path() / new_name, "the file could not be put in place", errno);
}

bool Folder::exchange(const std::string& name, const Folder& other,
                      const std::string& other_name) const {
    return renameat2(number(), name.c_str(), other.number(), other_name.c_str(), RENAME_EXCHANGE) ==
           0;
}

void Folder::place(const std::string& name, const Folder& to) const {
    const std::string temporary = own_name() + ".tmp";
    if (linkat(number(), name.c_str(), to.number(), temporary.c_str(), 0) != 0) {
        if (kind_of(name) != EntryKind::file)
            fail_of_system(to.path() / name, "the file could not be put in place", errno);
        to.write(name, read(name));
        return;
    }
    try {
        to.rename(temporary, to, name);
    } catch (const Failure&) {
        unlinkat(to.number(), temporary.c_str(), 0);
        throw;
    }
    to.remove(temporary);  // a rename does nothing where both are the same file already
}

void Folder::sync() const {
    // Some network file systems cannot sync a folder: there it is as safe as that place allows.
    const FileDescriptor opened(openat(number(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (opened.is_open() && fsync(opened.number()) != 0 && errno != EINVAL && errno != ENOTSUP)
        fail_of_system(path_, "this folder cannot be written to the disk", errno);
}

Folder Folder::again() const {
    return {path_, FileDescriptor(fcntl(number(), F_DUPFD_CLOEXEC, 0))};
}

bool Folder::has(int open_entry, const std::string& name) const {
    struct stat open_one {};
    struct stat named {};
    return fstat(open_entry, &open_one) == 0 &&
           fstatat(number(), name.c_str(), &named, AT_SYMLINK_NOFOLLOW) == 0 &&
           open_one.st_dev == named.st_dev && open_one.st_ino == named.st_ino;
}

Folder make_below(const fs::path& named, const fs::path& relative) {
    make_directory(named);
    Folder folder(named);
    for (const fs::path& each : relative)
        folder = folder.make(each.string());
    return folder;
}

}  // namespace runcert
