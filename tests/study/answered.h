#pragma once

#include <utility>

#include "schemas/windows/windows.h"

namespace runcert::test {

/// The windows once officials have answered for every second file.
inline Windows answered(Windows windows) {
    if (!windows.with_files.empty()) windows.profiles = std::exchange(windows.with_files, {});
    return windows;
}

}  // namespace runcert::test
