#pragma once

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <utility>

namespace runcert {

/// A file descriptor that is closed when it goes out of scope.
class FileDescriptor {
  public:
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
    int number_;
};

/// Throws the Failure of a system call: what was attempted on which file, the error (errno), and
/// what a user can do about it.
[[noreturn]] void fail_of_system(const std::filesystem::path& path, const std::string& attempted,
                                 int error);

}  // namespace runcert
