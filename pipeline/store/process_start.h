#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "store/folder.h"
#include "store/process.h"

// How run_process starts a program; for store/process.cpp alone.

namespace runcert {

/// A program that was started, and the read ends of what it writes. `problem` brings the error
/// number, an int, where it could not be started after all, and nothing where it could.
struct StartedProgram {
    pid_t process = -1;
    FileDescriptor ended;  ///< a pidfd: readable when the program has ended
    FileDescriptor output;
    FileDescriptor errors;
    FileDescriptor problem;
};

/// Starts a program in its own process group where `own_group` says so; what limits and stops it is
/// the caller's. Failure for want of processes, open files or memory, or where standard input
/// cannot be read.
StartedProgram start_program(const std::vector<std::string>& arguments,
                             const ProcessOptions& options, bool own_group);

/// Says that a program could not be started because the system refused, with an error number.
[[noreturn]] void fail_to_start(int error);

}  // namespace runcert
