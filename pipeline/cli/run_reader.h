#pragma once

#include <string>
#include <vector>

namespace runcert {

/// Runs the companion program `runcert-NAME`, which looks at what the stages wrote, prints what it
/// says on standard output and standard error, and gives its exit status. Failure where the program
/// is not there.
int run_reader(const std::string& name, const std::vector<std::string>& arguments);

}  // namespace runcert
