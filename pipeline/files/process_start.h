#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// How run_process starts a program; for files/process.cpp alone.

namespace runcert {

/// An open file of this process, closed at the end of the object's life and in programs that are
/// started.
class Descriptor {
  public:
    Descriptor() = default;
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor() { close(); }
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    int number() const { return number_; }
    void close();

  private:
    int number_ = -1;
};

struct Pipe {
    Descriptor read_end;
    Descriptor write_end;
};

/// A program to start.
struct ProgramStart {
    std::vector<std::string> arguments;
    std::vector<std::pair<std::string, std::string>> environment;
    bool closed_environment = false;
    std::string folder;
    std::string standard_input;
    bool own_group = false;
    bool guarded = false;
    std::optional<std::uint64_t> most_memory;
    std::optional<std::uint64_t> longest_file;
    bool no_network = false;
};

/// A program that was started, and the read ends of what it writes. `problem` brings the error
/// number, an int, where it could not be started after all, and nothing where it could.
struct StartedProgram {
    pid_t process = -1;
    Descriptor ended;  ///< a pidfd: readable when the program has ended
    Descriptor output;
    Descriptor errors;
    Descriptor problem;
};

/// Failure for want of processes, open files or memory, or where standard input cannot be read.
StartedProgram start_program(const ProgramStart& program);

/// Says that a program could not be started because the system refused, with an error number.
[[noreturn]] void fail_to_start(int error);

}  // namespace runcert
