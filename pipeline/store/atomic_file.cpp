#include "store/atomic_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "core/failure.h"
#include "store/folder.h"
#include "store/user_state.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* sync_variable = "RUNCERT_SYNC";
constexpr const char* sync_of_caller = "caller";

/// Whether a file is synced as it is written.
enum class Sync { now, later };

/// What the program that started this one says.
Sync sync_of_environment() {
    const char* const said = std::getenv(sync_variable);
    return said && std::string_view(said) == sync_of_caller ? Sync::later : Sync::now;
}

}  // namespace

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// A new file of an unused name in a folder, removed again unless it is kept.
class TemporaryFile {
  public:
    TemporaryFile(Folder folder, std::string target, mode_t mode)
        : folder_(std::move(folder)),
          target_(std::move(target)),
          path_(folder_.path() / target_),
          file_(create(mode)) {}
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        if (!kept_) ::unlinkat(folder_.number(), name_.c_str(), 0);
    }

    void write(std::string_view bytes) {
        while (!bytes.empty()) {
            const ssize_t count = ::write(file_.number(), bytes.data(), bytes.size());
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) fail_of_system(path_, "cannot write this file", errno);
            bytes.remove_prefix(static_cast<std::size_t>(count));
        }
    }

    /// Gives it its name. Where one that is there already is to stay, that is a Failure.
    void commit(Sync sync, bool replace) {
        if (sync == Sync::now && ::fsync(file_.number()) != 0)
            fail_of_system(path_, "cannot write this file to the disk", errno);
        if (const int error = file_.close(); error != 0)
            fail_of_system(path_, "cannot write this file", error);
        rename_to_target(replace);
        if (sync == Sync::later) return;
        try {
            folder_.sync();
        } catch (const ComputerFailure& failure) {
            throw ComputerFailure(path_.string(),
                                  "the new file is in place, but " + failure.what_failed(),
                                  failure.remedy());
        } catch (const Failure& failure) {
            throw Failure(path_.string(), "the new file is in place, but " + failure.problem(),
                          failure.remedy());
        }
    }

  private:
    void rename_to_target(bool replace) {
        const int folder = folder_.number();
        const unsigned how = replace ? 0 : RENAME_NOREPLACE;
        kept_ = ::renameat2(folder, name_.c_str(), folder, target_.c_str(), how) == 0;
        if (kept_) return;
        int error = errno;
        // Network file systems know no such rename, but a link replaces nothing either.
        if (!replace && (error == EINVAL || error == ENOSYS)) {
            if (::linkat(folder, name_.c_str(), folder, target_.c_str(), 0) == 0) return;
            error = errno;
        }
        fail_of_system(path_, "cannot give the new file its name", error);
    }

    int create(mode_t mode) {
        // O_EXCL keeps machines that share the folder apart.
        for (;;) {
            name_ = own_name() + ".tmp";
            const int number = ::openat(folder_.number(), name_.c_str(),
                                        O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
            if (number >= 0) return number;
            if (errno != EEXIST && errno != EINTR)
                fail_of_system(path_, "cannot create a file in this folder", errno);
        }
    }

    Folder folder_;
    std::string target_;
    fs::path path_;
    std::string name_;
    FileDescriptor file_;
    bool kept_ = false;
};

namespace {

/// Opens a regular file to read. Without O_NONBLOCK, opening a pipe would wait for its writer.
int open_regular(const fs::path& path) {
    const int number = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (number < 0) fail_of_system(path, "cannot open this file", errno);
    struct stat status {};
    const int error = ::fstat(number, &status) == 0 ? 0 : errno;
    if (error == 0 && S_ISREG(status.st_mode)) return number;
    ::close(number);
    if (error != 0) fail_of_system(path, "cannot open this file", error);
    throw Failure(path.string(),
                  S_ISDIR(status.st_mode) ? "this is a folder, not a file"
                                          : "this is a pipe or a device, not a file",
                  S_ISDIR(status.st_mode) ? "Name a file in it"
                                          : "Save its contents to a file and name that");
}

/// Of an open file; 0 where the system does not say.
std::size_t size_of(int file) {
    struct stat status {};
    return ::fstat(file, &status) == 0 ? static_cast<std::size_t>(status.st_size) : 0;
}

}  // namespace

FileView::FileView(const fs::path& path) {
    const FileDescriptor file(open_regular(path));
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) fail_of_system(path, "cannot read this file", errno);
    size_ = static_cast<std::size_t>(status.st_size);
    void* mapped =
        size_ == 0 ? MAP_FAILED : ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.number(), 0);
    if (mapped == MAP_FAILED)
        text_ = read_file(path);
    else
        mapped_ = static_cast<const char*>(mapped);
}

void FileView::release(std::size_t bytes) const {
    static const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    const std::size_t whole = std::min(bytes, size_) / page * page;
    // The mapping is private and never written to: its pages hold nothing but the file's bytes.
    if (mapped_ && whole > 0) ::madvise(const_cast<char*>(mapped_), whole, MADV_DONTNEED);
}

void FileView::for_each_piece(const std::function<void(std::string_view)>& take) const {
    constexpr std::size_t piece_bytes = std::size_t{4} << 20;
    for (std::size_t at = 0; at < bytes().size(); at += piece_bytes) {
        take(bytes().substr(at, piece_bytes));
        release(at + piece_bytes);
    }
}

FileView::FileView(FileView&& other) noexcept
    : mapped_(std::exchange(other.mapped_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      text_(std::move(other.text_)) {}

FileView::~FileView() {
    if (mapped_) ::munmap(const_cast<char*>(mapped_), size_);
}

void read_pieces(const fs::path& path, const std::function<void(std::string_view)>& take) {
    read_pieces(FileDescriptor(open_regular(path)), path, take);
}

void read_pieces(const FileDescriptor& file, const fs::path& path,
                 const std::function<void(std::string_view)>& take) {
    // Most files are small, and a page of memory that is touched costs as much as to read one.
    const std::size_t size =
        std::clamp(size_of(file.number()) + 1, std::size_t{1} << 12, std::size_t{1} << 20);
    const auto buffer = std::make_unique_for_overwrite<char[]>(size);
    for (;;) {
        const ssize_t count = ::read(file.number(), buffer.get(), size);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail_of_system(path, "cannot read this file", errno);
        if (count == 0) return;
        take({buffer.get(), static_cast<std::size_t>(count)});
    }
}

std::string read_file(const fs::path& path) {
    std::string bytes;
    read_pieces(path, [&bytes](std::string_view piece) { bytes.append(piece); });
    return bytes;
}

std::string read_handwritten(const fs::path& path) {
    std::string bytes;
    read_pieces(path, [&](std::string_view piece) {
        bytes.append(piece);
        if (bytes.size() > longest_handwritten)
            throw Failure(path.string(),
                          "the file is longer than " + std::to_string(longest_handwritten) +
                              " bytes, and so no text that was written by hand",
                          "Check that it is the file you mean");
    });
    return bytes;
}

namespace {

/// Failure where a file of this name cannot be put in place.
void require_file_name(const fs::path& path) {
    if (!path.has_filename()) throw Failure(path.string(), "this names no file", "Name a file");
    // Renaming would replace a device like /dev/stdout by a file, where the user may do that.
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
        throw Failure(path.string(),
                      S_ISDIR(status.st_mode) ? "a folder has that name"
                                              : "this is a pipe or a device, not a file",
                      "Name a file");
}

mode_t mode_of(FileAccess access) {
    return access == FileAccess::owner_only ? 0600 : 0666;
}

Folder folder_for(const fs::path& path) {
    require_file_name(path);
    try {
        return Folder(folder_of(path));
    } catch (const Failure& failure) {
        throw Failure(path.string(), "cannot create a file in this folder: " + failure.problem(),
                      failure.remedy());
    }
}

std::unique_ptr<TemporaryFile> temporary_for(const fs::path& path, FileAccess access) {
    return std::make_unique<TemporaryFile>(folder_for(path), path.filename().string(),
                                           mode_of(access));
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& path, FileAccess access)
    : file_(temporary_for(path, access)) {}

AtomicFile::AtomicFile(const Folder& folder, const std::string& name)
    : file_(std::make_unique<TemporaryFile>(folder.again(), name, mode_of(FileAccess::by_umask))) {
    const EntryKind kind = folder.kind_of(name);
    if (kind == EntryKind::folder || kind == EntryKind::other)
        throw Failure((folder.path() / name).string(),
                      kind == EntryKind::folder ? "a folder has that name"
                                                : "this is a pipe or a device, not a file",
                      "Name a file");
}

AtomicFile::~AtomicFile() = default;

void AtomicFile::write(std::string_view piece) {
    file_->write(piece);
}

void AtomicFile::commit() {
    file_->commit(sync_of_environment(), true);
}

void AtomicFile::commit_as_new() {
    file_->commit(sync_of_environment(), false);
}

void write_file_atomically(const fs::path& path, std::string_view bytes, FileAccess access) {
    AtomicFile file(path, access);
    file.write(bytes);
    file.commit();
}

void write_file_unsynced(const fs::path& path, std::string_view bytes) {
    const auto file = temporary_for(path, FileAccess::by_umask);
    file->write(bytes);
    file->commit(Sync::later, true);
}

std::pair<std::string, std::string> synced_by_caller() {
    return {sync_variable, sync_of_caller};
}

void sync_files(const std::vector<fs::path>& files) {
    // Few enough for any limit on open files.
    constexpr std::size_t at_once = 16;
    for (std::size_t first = 0; first < files.size(); first += at_once) {
        const std::size_t end = std::min(first + at_once, files.size());
        std::vector<FileDescriptor> opened;
        for (std::size_t i = first; i < end; ++i) {
            const int number = opened.emplace_back(open_regular(files[i])).number();
            // Only begins the writing; whether it succeeds, fsync says.
            (void)::sync_file_range(number, 0, 0, SYNC_FILE_RANGE_WRITE);
        }
        for (std::size_t i = first; i < end; ++i)
            if (::fsync(opened[i - first].number()) != 0)
                fail_of_system(files[i], "cannot write this file to the disk", errno);
    }
}

void make_directory(const fs::path& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error) fail_of_system(path, "cannot make this folder", error.value());
    if (!fs::is_directory(path, error)) fail_of_system(path, "cannot make this folder", EEXIST);
}

}  // namespace runcert
