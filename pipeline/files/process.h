#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace runcert {

struct ProcessResult {
    int exit_status = 0;  ///< of the program; 128 + signal where it was ended by one
    std::string output;   ///< what it wrote on standard output
    std::string errors;   ///< what it wrote on standard error
};

/// Runs a program (searched in PATH unless it holds a slash) to its end, with the contents of a
/// file as standard input (empty where none is named), and returns what it said. `environment` is
/// added to the caller's. The program is ended if its caller dies. A program that cannot be started
/// is a Failure that names it.
ProcessResult run_process(const std::vector<std::string>& arguments,
                          const std::vector<std::pair<std::string, std::string>>& environment = {},
                          const std::filesystem::path& standard_input = {});

/// The folder that holds the running program, where its companions are.
std::filesystem::path program_folder();

/// A new empty folder that only this user can read, removed with all it holds at the end of the
/// object's life.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

}  // namespace runcert
