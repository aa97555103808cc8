#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace runcert {

class FileView;

/// What identifies the contents of a file: its hash and its length.
struct FileDigest {
    std::string sha256;       ///< 64 lower-case hexadecimal digits, as `sha256sum` prints them
    std::uint64_t bytes = 0;  ///< length in bytes

    bool operator==(const FileDigest&) const = default;
};

/// SHA-256 (FIPS 180-4) of `bytes`: 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

/// Hash and length of `bytes`.
FileDigest digest_of(std::string_view bytes);

/// Hash and length of an open file, whose memory is released behind what is hashed.
FileDigest digest_of(const FileView& file);

/// Hash and length of bytes that come in pieces: `give` hands over one after the other.
FileDigest digest_of_pieces(
    const std::function<void(const std::function<void(std::string_view)>& add)>& give);

/// Hash and length of a file, read in pieces: any size in constant memory.
/// Failure where the file is missing, unreadable, or not a regular file.
FileDigest digest_file(const std::filesystem::path& path);

}  // namespace runcert
