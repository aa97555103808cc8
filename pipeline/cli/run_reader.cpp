#include "run_reader.h"

#include <fmt/format.h>

#include "files/process.h"

namespace runcert {

int run_reader(const std::string& name, const std::vector<std::string>& arguments) {
    std::vector<std::string> command{(program_folder() / ("runcert-" + name)).string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const ProcessResult result = run_process(command);
    fmt::print("{}", result.output);
    fmt::print(stderr, "{}", result.errors);
    return result.exit_status;
}

}  // namespace runcert
