// The reader of bundles, on the bytes as they are and on what they are as a tar that zstd packed: a
// changed byte of what is packed seldom reaches the reader of tar.

#include <archive.h>
#include <archive_entry.h>

#include "core/failure.h"
#include "fuzz_target.h"
#include "store/archive.h"
#include "store/process.h"
#include "trust/bundle.h"

namespace runcert::fuzz {
namespace {

namespace fs = std::filesystem;

const UnpackLimits little{.bytes = 1 << 20, .files = 100, .bytes_of = {}};

la_ssize_t append(archive*, void* out, const void* bytes, std::size_t count) {
    static_cast<std::string*>(out)->append(static_cast<const char*>(bytes), count);
    return static_cast<la_ssize_t>(count);
}

std::string packed(std::string_view tar) {
    std::string bytes;
    archive* a = archive_write_new();
    archive_write_set_format_raw(a);
    archive_write_add_filter_zstd(a);
    archive_write_set_filter_option(a, "zstd", "compression-level", "1");
    archive_write_set_bytes_in_last_block(a, 1);
    archive_write_open(a, &bytes, nullptr, append, nullptr);
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, "tar");
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_write_header(a, entry);
    archive_write_data(a, tar.data(), tar.size());
    archive_entry_free(entry);
    archive_write_free(a);
    return bytes;
}

void unpack(std::string_view bytes) {
    const TemporaryFolder folder;
    const fs::path inside = folder.path() / "inside";
    fs::create_directory(inside);
    std::vector<std::string> names;
    bool whole = true;
    try {
        names = unpack_archive(bytes, "bundle", inside, little);
        (void)check_sums(inside);
    } catch (const Failure&) {
        whole = false;
    }
    std::uint64_t files = 0, size = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
        require(!entry.is_symlink(), "no link is unpacked");
        if (!entry.is_regular_file()) continue;
        require(entry.path().string().starts_with(inside.string() + "/"),
                "nothing is unpacked beside the folder");
        require(is_plain_name(entry.path().lexically_relative(inside).generic_string()),
                "every name is plain");
        ++files;
        size += entry.file_size();
    }
    require(files <= little.files && size <= little.bytes, "no more than the limits is unpacked");
    require(!whole || files == names.size(), "every file that was unpacked is named");
}

}  // namespace

void read_input(std::string_view bytes) {
    unpack(bytes);
    unpack(packed(bytes));
}

}  // namespace runcert::fuzz
