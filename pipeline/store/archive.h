#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace runcert {

/// A file to be packed. Its bytes are `text`, or those of `source` where one is named.
struct PackedFile {
    std::string name;  ///< in the archive, with '/' between folders
    std::filesystem::path source = {};
    std::string text = {};
};

enum class ArchiveForm {
    tar_zst,
    zip,  ///< its files are stored as they are, so that its bytes depend on no compressor
};

/// What a file of that form is called behind its name: ".tar.zst".
std::string_view ending_of(ArchiveForm form);

/// The form that an archive begins as; anything but a ZIP is taken for a .tar.zst.
ArchiveForm form_of(std::string_view bytes);

/// The bytes of an archive of these files in this order. A .tar.zst is ustar compressed by zstd,
/// every file with mode 0644, owner 0 and time 0; behind it a frame that readers skip (RFC 8878,
/// 3.1.2), which holds the SHA-256 of all before it, so that no byte can be changed unnoticed. A
/// ZIP has the same modes and owners. The bytes depend only on names, contents and, of a .tar.zst,
/// the version of libzstd. Failure where a name is not plain (`is_plain_name`) or longer than ustar
/// holds (100 bytes), or a file cannot be read or changes while it is read.
std::string pack_archive(const std::vector<PackedFile>& files, ArchiveForm form);

/// Whether a .tar.zst ends with the frame that `pack_archive` writes last, which holds the hash of
/// what is before it.
bool ends_with_its_hash(std::string_view bytes);

/// The SHA-256 of the tar inside a .tar.zst, which is the same with other versions of libzstd.
/// Failure where it is damaged, or longer than `most` bytes.
std::string unpacked_sha256(std::string_view bytes, const std::string& where, std::uint64_t most);

/// Whether a name in an archive can do no harm: folders and a file of printable ASCII without
/// blanks, quotes, backslashes or what a shell reads otherwise, none of them empty, "." or "..",
/// none beginning with a point or a minus.
bool is_plain_name(std::string_view name);

/// How much an archive may unpack to.
struct UnpackLimits {
    std::uint64_t bytes = std::uint64_t{4} << 30;  ///< of all files together: 4 GiB
    std::uint64_t files = 10'000;                  ///< folders among them
    /// The most bytes of one file by its name; no limit of its own where there is none.
    std::function<std::uint64_t(std::string_view name)> bytes_of = {};
};

/// Unpacks an archive of either form into an empty folder, and returns the names of its files in
/// their order.
///
/// Made for archives from strangers. Failure, with the entry's name, where it is damaged or another
/// kind of file; where an entry is anything but a plain file or a folder (links, devices, sparse
/// files), is encrypted, states no size, has a name that is not plain or that was there before, or
/// more than `limits` would be unpacked: by the sizes that it states before a file is written, by
/// its bytes while it is. Modes, owners and times in it are not taken over. What a ZIP's central
/// directory lists counts. `where` names it in messages.
std::vector<std::string> unpack_archive(std::string_view bytes, const std::string& where,
                                        const std::filesystem::path& folder,
                                        const UnpackLimits& limits = {});

}  // namespace runcert
