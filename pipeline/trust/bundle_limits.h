#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "files/archive.h"
#include "files/external_program.h"

/// How much a run may hold to be bundled and verified: far more than any that is certified, far
/// less than fills a disk.
namespace runcert {

inline constexpr std::uint64_t longest_pdf = std::uint64_t{32} << 20;  ///< bytes

/// The most that a program may take which reads a PDF: far more than any does for one of ours.
inline constexpr ExternalLimits reading_pdf{.time = std::chrono::seconds(60),
                                            .memory_bytes = std::uint64_t{512} << 20,
                                            .file_bytes = longest_pdf,
                                            .output_bytes = std::size_t{1} << 20};

/// Failure where a PDF is longer than `longest_pdf`: no program is given it to read.
void require_readable_pdf(const std::filesystem::path& pdf);

/// The most bytes that a file of a run folder or bundle may have, by its name there.
std::uint64_t most_bytes_of(std::string_view name);

/// What a bundle of so many bytes may unpack to, its one folder left out of the names.
UnpackLimits bundle_limits(std::uint64_t bundle_bytes);

/// Failure where a file of a run folder, or all of them together, are over the limits: by what the
/// file system says, before any is read. Links are not followed.
void require_within_limits(const std::filesystem::path& run_dir);

/// The limits in words, for the help of commands; lines of at most 100 characters.
std::string bundle_limits_words();

}  // namespace runcert
