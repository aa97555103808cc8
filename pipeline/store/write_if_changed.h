#pragma once

#include <filesystem>
#include <string_view>

#include "store/atomic_file.h"

namespace runcert {

/// Writes a file of the build. What did not change keeps its time, so that nothing that depends on
/// it is built again.
inline void write_if_changed(const std::filesystem::path& path, std::string_view text) {
    if (!std::filesystem::exists(path) || read_file(path) != text)
        write_file_atomically(path, text);
}

}  // namespace runcert
