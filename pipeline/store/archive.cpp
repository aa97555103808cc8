#include "store/archive.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"
#include "store/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_name = 100;  // ustar without its prefix field
constexpr const char* send_it_again =
    "Have it sent again by whoever made it; unpack nothing of it by hand";

template <auto free>
struct Freed {
    void operator()(auto* one) const { free(one); }
};
using Writer = std::unique_ptr<archive, Freed<archive_write_free>>;
using Reader = std::unique_ptr<archive, Freed<archive_read_free>>;
using Entry = std::unique_ptr<archive_entry, Freed<archive_entry_free>>;

std::string said_by(archive* a) {
    const char* text = archive_error_string(a);
    return text == nullptr ? "no reason given" : escape_for_message(text, 200);
}

void require_packed(archive* a, la_ssize_t status) {
    if (status < 0)
        throw Failure("packing", said_by(a), "Check memory; if it goes on, please report it");
}

la_ssize_t append(archive*, void* out, const void* bytes, std::size_t count) {
    static_cast<std::string*>(out)->append(static_cast<const char*>(bytes), count);
    return static_cast<la_ssize_t>(count);
}

/// A skippable frame of zstd with the hash of some bytes in hexadecimal: magic number, length, both
/// little-endian.
std::string hash_frame(std::string_view bytes) {
    constexpr std::string_view magic_and_length("\x50\x2a\x4d\x18\x40\0\0\0", 8);
    return std::string(magic_and_length) + sha256_hex(bytes);
}

void pack_one(archive* a, const PackedFile& file) {
    const bool from_disk = !file.source.empty();
    const std::uint64_t size = from_disk ? fs::file_size(file.source) : file.text.size();
    const Entry entry(archive_entry_new());
    archive_entry_set_pathname(entry.get(), file.name.c_str());
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_mtime(entry.get(), 0, 0);
    archive_entry_set_uid(entry.get(), 0);
    archive_entry_set_gid(entry.get(), 0);
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(size));
    require_packed(a, archive_write_header(a, entry.get()));
    std::uint64_t packed = 0;
    const auto write = [&](std::string_view piece) {
        packed += piece.size();
        require_packed(a, archive_write_data(a, piece.data(), piece.size()));
    };
    if (from_disk)
        read_pieces(file.source, write);
    else
        write(file.text);
    if (packed != size)
        throw Failure(file.source.string(), "the file changed while it was read",
                      "Try again when nothing writes to it");
}

bool is_plain_part(std::string_view part) {
    if (part.empty() || part.front() == '.' || part.front() == '-') return false;
    return has_only(part, "._-+@,=");
}

/// One archive being unpacked.
class Unpacking {
  public:
    Unpacking(std::string_view bytes, std::string where, const fs::path& folder,
              const UnpackLimits& limits)
        : where_(std::move(where)), folder_(folder), limits_(limits), a_(archive_read_new()) {
        const bool zip = form_of(bytes) == ArchiveForm::zip;
        if (zip) {
            archive_read_support_format_zip_seekable(a_.get());
        } else {
            archive_read_support_filter_zstd(a_.get());
            archive_read_support_format_tar(a_.get());
        }
        if (archive_read_open_memory(a_.get(), bytes.data(), bytes.size()) != ARCHIVE_OK)
            throw Failure(where_,
                          fmt::format("this is not a {} archive: {}", zip ? ".zip" : ".tar.zst",
                                      said_by(a_.get())),
                          "Give the file that `runcert bundle` wrote");
        if (!zip && archive_filter_code(a_.get(), 0) != ARCHIVE_FILTER_ZSTD)
            throw Failure(where_, "this is not compressed by zstd, as a .tar.zst is",
                          "Give the file that `runcert bundle` wrote");
    }

    std::vector<std::string> run() {
        archive_entry* entry = nullptr;
        for (;;) {
            const int status = archive_read_next_header(a_.get(), &entry);
            if (status == ARCHIVE_EOF) return names_;
            if (status != ARCHIVE_OK) refuse("it is damaged or no archive: " + said_by(a_.get()));
            take(entry);
        }
    }

  private:
    [[noreturn]] void refuse(const std::string& what) const {
        throw Failure(where_, what, send_it_again);
    }

    void take(archive_entry* entry) {
        const char* path = archive_entry_pathname(entry);
        std::string name = path == nullptr ? "" : path;
        const bool folder = archive_entry_filetype(entry) == AE_IFDIR;
        if (folder && name.ends_with('/')) name.pop_back();
        const std::string shown = escape_for_message(name, 100);
        if (!is_plain_name(name))
            refuse(
                fmt::format("it holds the name \"{}\", which could be put outside of the folder "
                            "or hide what it is",
                            shown));
        if (archive_entry_hardlink(entry) != nullptr || archive_entry_symlink(entry) != nullptr)
            refuse(fmt::format("\"{}\" is a link; only plain files belong in it", shown));
        if (!folder && archive_entry_filetype(entry) != AE_IFREG)
            refuse(fmt::format("\"{}\" is no plain file; devices and pipes do not belong in it",
                               shown));
        if (archive_entry_sparse_count(entry) > 0)
            refuse(fmt::format("\"{}\" is a sparse file, which hides its size", shown));
        if (archive_entry_is_encrypted(entry) != 0)
            refuse(fmt::format("\"{}\" is encrypted", shown));
        if (!folder && archive_entry_size_is_set(entry) == 0)
            refuse(fmt::format("\"{}\" does not say how long it is", shown));
        // Folders too: they compress to nothing, and reading them takes time.
        if (++entries_ > limits_.files)
            refuse(fmt::format("it holds more than {} files", limits_.files));
        if (folder) return;
        if (!seen_.insert(name).second)
            refuse(fmt::format("it holds \"{}\" twice: which one counts?", shown));
        const la_int64_t size = archive_entry_size(entry);
        if (limits_.bytes_of && size > 0 &&
            static_cast<std::uint64_t>(size) > limits_.bytes_of(name))
            refuse(fmt::format("\"{}\" in it is longer than {} bytes, the most for one of its kind",
                               shown, limits_.bytes_of(name)));
        if (size < 0 || static_cast<std::uint64_t>(size) > limits_.bytes - unpacked_)
            refuse(
                fmt::format("with \"{}\" it would unpack to more than {} bytes, the most that "
                            "is unpacked",
                            shown, limits_.bytes));
        unpacked_ += static_cast<std::uint64_t>(size);
        write(name, static_cast<std::uint64_t>(size));
        names_.push_back(std::move(name));
    }

    void write(const std::string& name, std::uint64_t size) {
        const fs::path target = folder_ / name;
        make_directory(target.parent_path());
        if (fs::is_directory(target))
            refuse(fmt::format("\"{}\" is a file and a folder in it", name));
        std::ofstream out(target, std::ios::binary);
        std::array<char, 65536> buffer{};
        for (;;) {
            const la_ssize_t count = archive_read_data(a_.get(), buffer.data(), buffer.size());
            if (count < 0)
                refuse(fmt::format("\"{}\" in it is damaged: {}", name, said_by(a_.get())));
            if (count == 0) break;
            if (static_cast<std::uint64_t>(count) > size)
                refuse(fmt::format("\"{}\" in it is longer than it says", name));
            size -= static_cast<std::uint64_t>(count);
            out.write(buffer.data(), count);
        }
        out.close();
        if (!out)
            throw Failure(target.string(), "cannot write this file while unpacking",
                          "Free some space there, or set TMPDIR to a folder with more");
        if (size != 0) refuse(fmt::format("\"{}\" in it is cut off", name));
    }

    std::string where_;
    fs::path folder_;
    UnpackLimits limits_;
    Reader a_;
    std::set<std::string> seen_;
    std::vector<std::string> names_;
    std::uint64_t unpacked_ = 0;
    std::uint64_t entries_ = 0;
};

}  // namespace

bool is_plain_name(std::string_view name) {
    for (;;) {
        const std::size_t end = name.find('/');
        if (!is_plain_part(name.substr(0, end))) return false;
        if (end == std::string_view::npos) return true;
        name.remove_prefix(end + 1);
    }
}

std::string_view ending_of(ArchiveForm form) {
    return form == ArchiveForm::zip ? ".zip" : ".tar.zst";
}

ArchiveForm form_of(std::string_view bytes) {
    return bytes.starts_with("PK") ? ArchiveForm::zip : ArchiveForm::tar_zst;
}

std::string pack_archive(const std::vector<PackedFile>& files, ArchiveForm form) {
    std::string bytes;
    const Writer writer(archive_write_new());
    archive* a = writer.get();
    if (form == ArchiveForm::zip) {
        require_packed(a, archive_write_set_format_zip(a));
        require_packed(a, archive_write_set_format_option(a, "zip", "compression", "store"));
    } else {
        require_packed(a, archive_write_set_format_ustar(a));
        require_packed(a, archive_write_add_filter_zstd(a));
        require_packed(a, archive_write_set_filter_option(a, "zstd", "compression-level", "10"));
    }
    require_packed(a, archive_write_set_bytes_in_last_block(a, 1));  // nothing after the zstd frame
    require_packed(a, archive_write_open(a, &bytes, nullptr, append, nullptr));
    for (const PackedFile& file : files) {
        if (!is_plain_name(file.name) || file.name.size() > longest_name)
            throw Failure(escape_for_message(file.name, 200),
                          "a file of this name cannot be packed so that every system unpacks it",
                          "Give it a name of at most 100 letters, digits and . _ - + @ , = that "
                          "begins with a letter or digit");
        pack_one(a, file);
    }
    require_packed(a, archive_write_close(a));
    return form == ArchiveForm::zip ? bytes : bytes + hash_frame(bytes);
}

bool ends_with_its_hash(std::string_view bytes) {
    const std::size_t length = hash_frame({}).size();
    return bytes.size() > length && bytes.substr(bytes.size() - length) ==
                                        hash_frame(bytes.substr(0, bytes.size() - length));
}

std::string unpacked_sha256(std::string_view bytes, const std::string& where, std::uint64_t most) {
    const Reader reader(archive_read_new());
    archive_read_support_filter_zstd(reader.get());
    archive_read_support_format_raw(reader.get());
    const auto require = [&](la_ssize_t status) {
        if (status < 0)
            throw Failure(where, "it is damaged: " + said_by(reader.get()), send_it_again);
    };
    require(archive_read_open_memory(reader.get(), bytes.data(), bytes.size()));
    archive_entry* entry = nullptr;
    require(archive_read_next_header(reader.get(), &entry));
    const FileDigest digest = digest_of_pieces([&](const auto& add) {
        std::uint64_t unpacked = 0;
        std::array<char, 65536> buffer{};
        for (;;) {
            const la_ssize_t count = archive_read_data(reader.get(), buffer.data(), buffer.size());
            require(count);
            if (count == 0) return;
            unpacked += static_cast<std::uint64_t>(count);
            if (unpacked > most)
                throw Failure(where, fmt::format("it unpacks to more than {} bytes", most),
                              send_it_again);
            add({buffer.data(), static_cast<std::size_t>(count)});
        }
    });
    return digest.sha256;
}

std::vector<std::string> unpack_archive(std::string_view bytes, const std::string& where,
                                        const std::filesystem::path& folder,
                                        const UnpackLimits& limits) {
    return Unpacking(bytes, where, folder, limits).run();
}

}  // namespace runcert
