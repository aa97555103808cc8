#pragma once

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace runcert {

/// A file descriptor that is closed when it goes out of scope.
class FileDescriptor {
  public:
    FileDescriptor() = default;
    explicit FileDescriptor(int number) : number_(number) {}
    FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    FileDescriptor& operator=(FileDescriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~FileDescriptor() {
        if (number_ >= 0) ::close(number_);
    }

    int number() const { return number_; }
    bool is_open() const { return number_ >= 0; }

    /// Closes it and gives the error, 0 where there is none: some file systems report a full
    /// disk only here.
    int close() { return ::close(std::exchange(number_, -1)) == 0 ? 0 : errno; }

  private:
    int number_ = -1;
};

/// Throws the Failure of a system call: what was attempted on which file, the error (errno), and
/// what a user can do about it. A ComputerFailure where no file is at fault.
[[noreturn]] void fail_of_system(const std::filesystem::path& path, const std::string& attempted,
                                 int error);

/// What a name in a folder stands for; a symbolic link is one, wherever it leads.
enum class EntryKind { none, file, folder, link, other };

/// An open folder, and what is done in it. A folder of results may come from elsewhere, or be
/// written to by others meanwhile; so every name is that of an entry right in the folder, and no
/// symbolic link is followed at the moment of use: what is opened, written, renamed or removed is
/// in this folder, or it is a Failure. Only the path that the user named may lead through links.
class Folder {
  public:
    /// The folder that the user named. Failure where there is none.
    explicit Folder(const std::filesystem::path& named);

    /// For messages, and for programs that are started.
    const std::filesystem::path& path() const { return path_; }
    int number() const { return folder_.number(); }

    EntryKind kind_of(const std::string& name) const;
    /// The names of all entries, sorted. Failure where the folder may not be listed.
    std::vector<std::string> names() const;

    /// A folder in this one. Failure where it is missing, a link or no folder.
    Folder open(const std::string& name) const;
    /// The same, made where it is missing.
    Folder make(const std::string& name) const;

    /// The whole contents of a file. Failures as for read_file, and where it is a link.
    std::string read(const std::string& name) const;
    /// Writes a file as write_file_atomically does; a link of that name is replaced.
    void write(const std::string& name, std::string_view bytes) const;

    /// Removes a file or a link; nothing happens where there is none.
    void remove(const std::string& name) const;
    /// Removes a file, or a folder with all that is in it.
    void remove_tree(const std::string& name) const;

    /// Moves an entry within its file system; a file of the new name is replaced.
    void rename(const std::string& name, const Folder& to, const std::string& new_name) const;
    /// Exchanges an entry for another in one step. False, and nothing is changed, where the system
    /// cannot: its file system does not know how, or one of the two is where a disk is mounted.
    bool exchange(const std::string& name, const Folder& other,
                  const std::string& other_name) const;
    /// Puts a file, or a link as a link, into another folder too, whole or not at all: as a hard
    /// link or, where the file system has none, as a copy.
    void place(const std::string& name, const Folder& to) const;

    /// Makes renames in it outlive a power cut.
    void sync() const;

    /// The same folder, opened once more.
    Folder again() const;

    /// Whether that name is still that of an open file or folder, and not of one that replaced it.
    bool has(int open_entry, const std::string& name) const;

  private:
    Folder(std::filesystem::path path, FileDescriptor folder)
        : path_(std::move(path)), folder_(std::move(folder)) {}

    std::filesystem::path path_;
    FileDescriptor folder_;
};

/// A folder below one that the user named: `relative` names the folders on the way, each of which
/// is made where it is missing. Failures as for Folder::make.
Folder make_below(const std::filesystem::path& named, const std::filesystem::path& relative);

}  // namespace runcert
