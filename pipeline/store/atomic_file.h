#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace runcert {

/// The folder that a file is in: "." where its path names none.
std::filesystem::path folder_of(const std::filesystem::path& file);

/// Who may read a file that is written: everyone the user's umask allows, or the owner alone
/// (mode 0600, for secret keys).
enum class FileAccess { by_umask, owner_only };

/// The whole contents of a file, byte for byte.
/// Failure where it is missing, unreadable, or not a regular file: a folder, a pipe or a device
/// is refused at once, never waited for.
std::string read_file(const std::filesystem::path& path);

/// The longest text that people write by hand: attempts, profiles, keys. 1 MiB, in bytes.
inline constexpr std::size_t longest_handwritten = std::size_t{1} << 20;

/// As read_file, for a text written by hand. Failure also where it is longer than that: it is then
/// some other file, and is not read into memory.
std::string read_handwritten(const std::filesystem::path& path);

/// The contents of a file, for reading large ones without holding them in memory: mapped, or read
/// where its file system cannot map. A file must not be shortened while it is read.
class FileView {
  public:
    /// Failures as for read_file.
    explicit FileView(const std::filesystem::path& path);
    ~FileView();
    FileView(FileView&& other) noexcept;
    FileView& operator=(FileView&&) = delete;
    FileView(const FileView&) = delete;
    FileView& operator=(const FileView&) = delete;

    std::string_view bytes() const { return mapped_ ? std::string_view(mapped_, size_) : text_; }

    /// Lets go of the memory behind the first so many bytes, which are read from the file again if
    /// anyone looks: who goes through a file once keeps no more of it in memory than is needed.
    void release(std::size_t bytes) const;

    /// Gives the contents to `take`, in order, in pieces of at most 4 MiB, and releases each.
    void for_each_piece(const std::function<void(std::string_view piece)>& take) const;

  private:
    const char* mapped_ = nullptr;
    std::size_t size_ = 0;
    std::string text_;
};

class FileDescriptor;
class Folder;
class TemporaryFile;

/// A file that is written piece by piece, and has its name only when it is whole: as
/// write_file_atomically, whose Failures it has. Without commit() it leaves nothing behind.
class AtomicFile {
  public:
    explicit AtomicFile(const std::filesystem::path& path,
                        FileAccess access = FileAccess::by_umask);
    /// In an open folder (store/folder.h): no link is followed.
    AtomicFile(const Folder& folder, const std::string& name);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(std::string_view piece);
    /// Syncs the file and gives it its name. Nothing can be written after that.
    void commit();
    /// The same where there is no file of that name yet; Failure, and what is there stays, where
    /// there is one.
    void commit_as_new();

  private:
    std::unique_ptr<TemporaryFile> file_;
};

/// Gives the contents of a file to `take`, in order, in pieces of at most 1 MiB.
/// Failures as for read_file; what `take` throws passes through.
void read_pieces(const std::filesystem::path& path,
                 const std::function<void(std::string_view piece)>& take);
/// The same of an open file; `path` names it in messages.
void read_pieces(const FileDescriptor& file, const std::filesystem::path& path,
                 const std::function<void(std::string_view piece)>& take);

/// Replaces or creates a file so that, whatever happens, its name holds the whole old contents
/// or the whole new ones: written under a temporary name (user_state.h, `.tmp`) in the same folder,
/// synced (see below), renamed, the folder synced. A symbolic link there is replaced.
/// Safe with several processes and threads at once; the last to rename wins.
/// Failure where the name is that of a folder, a pipe or a device, and where any step fails
/// (read-only folder, full disk, quota, ...): the temporary is removed and the old file untouched.
/// Only the final sync of the folder can fail after the new contents are in place, and its message
/// says so.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes,
                           FileAccess access = FileAccess::by_umask);

/// Makes a folder and those above it; nothing happens where it exists already.
/// Failure where it cannot be made, e.g. where a file has that name.
void make_directory(const std::filesystem::path& path);

// When what is written reaches the disk. A sync takes about a millisecond, far longer than the
// write, and protects from a power cut alone: a program that is killed leaves whole files without.
// So where files are made in a folder first and published from there, as `certify` and `batch` do,
// they are synced once, when they are published: what a power cut leaves of them before that is
// never taken for a result, as a batch trusts a file by its hash alone.

/// What a program that is started gets in its environment by a caller that syncs what it writes:
/// its write_file_atomically then does not.
std::pair<std::string, std::string> synced_by_caller();

/// As write_file_atomically, for a file that something else tells from one that a power cut left.
void write_file_unsynced(const std::filesystem::path& path, std::string_view bytes);

/// Syncs files, each begun before any is waited for. Failure where one cannot be written.
void sync_files(const std::vector<std::filesystem::path>& files);

/// Writes a file of the build. What did not change keeps its time, so that nothing that depends on
/// it is built again.
inline void write_if_changed(const std::filesystem::path& path, std::string_view text) {
    if (!std::filesystem::exists(path) || read_file(path) != text)
        write_file_atomically(path, text);
}

}  // namespace runcert
