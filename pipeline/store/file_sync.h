#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// When what is written reaches the disk. A sync takes about a millisecond, far longer than the
// write, and protects from a power cut alone: a program that is killed leaves whole files without.
// So where files are made in a folder first and published from there, as `certify` and `batch` do,
// they are synced once, when they are published: what a power cut leaves of them before that is
// never taken for a result, as a batch trusts a file by its hash alone.

namespace runcert {

/// What a program that is started gets in its environment by a caller that syncs what it writes:
/// its write_file_atomically then does not.
std::pair<std::string, std::string> synced_by_caller();

/// As write_file_atomically, for a file that something else tells from one that a power cut left.
void write_file_unsynced(const std::filesystem::path& path, std::string_view bytes);

/// Syncs files, each begun before any is waited for. Failure where one cannot be written.
void sync_files(const std::vector<std::filesystem::path>& files);

}  // namespace runcert
