#include "reports/run/run_view.h"

#include <algorithm>

namespace runcert {

const InputFile* file_in(const RunView& run, const std::string& name) {
    const auto found = std::ranges::find(run.files, name, &InputFile::file);
    return found == run.files.end() ? nullptr : &*found;
}

}  // namespace runcert
