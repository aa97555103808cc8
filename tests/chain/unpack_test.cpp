#include <archive.h>
#include <archive_entry.h>

#include "core/failure.h"
#include "files/archive.h"
#include "handover_support.h"
#include "trust/bundle.h"

// Bundles that strangers may send.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// An entry of an archive made to harm.
struct Entry {
    std::string name;
    std::string text = "x";
    mode_t type = AE_IFREG;
    std::string link = {};
    bool hard = false;
};

la_ssize_t append(archive*, void* out, const void* bytes, std::size_t count) {
    static_cast<std::string*>(out)->append(static_cast<const char*>(bytes), count);
    return static_cast<la_ssize_t>(count);
}

std::string archive_of(const std::vector<Entry>& entries) {
    std::string bytes;
    archive* a = archive_write_new();
    archive_write_set_format_pax_restricted(a);
    archive_write_add_filter_zstd(a);
    archive_write_set_bytes_in_last_block(a, 1);
    archive_write_open(a, &bytes, nullptr, append, nullptr);
    for (const Entry& one : entries) {
        archive_entry* entry = archive_entry_new();
        archive_entry_set_pathname(entry, one.name.c_str());
        archive_entry_set_filetype(entry, one.type);
        archive_entry_set_perm(entry, 0644);
        if (one.hard)
            archive_entry_set_hardlink(entry, one.link.c_str());
        else if (!one.link.empty())
            archive_entry_set_symlink(entry, one.link.c_str());
        const bool file = one.type == AE_IFREG && one.link.empty();
        archive_entry_set_size(entry, file ? static_cast<la_int64_t>(one.text.size()) : 0);
        EXPECT_GE(archive_write_header(a, entry), ARCHIVE_WARN) << one.name;
        if (file) archive_write_data(a, one.text.data(), one.text.size());
        archive_entry_free(entry);
    }
    archive_write_close(a);
    archive_write_free(a);
    return bytes;
}

/// What unpacking says; empty where it does it.
std::string refusal(const std::string& bytes, const UnpackLimits& limits = {}) {
    const TemporaryFolder there;
    fs::create_directory(there.path() / "in");
    std::string said;
    try {
        unpack_tar_zst(bytes, "x.tar.zst", there.path() / "in", limits);
    } catch (const Failure& failure) {
        said = failure.problem();
        EXPECT_EQ(failure.where(), "x.tar.zst");
        EXPECT_FALSE(failure.remedy().empty());
    }
    for (const auto& entry : fs::recursive_directory_iterator(there.path()))
        EXPECT_TRUE(entry.symlink_status().type() == fs::file_type::regular ||
                    entry.symlink_status().type() == fs::file_type::directory)
            << entry.path();
    std::size_t beside = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(there.path()))
        ++beside;
    EXPECT_EQ(beside, 1u) << "something was written outside of the folder";
    return said;
}

TEST(Unpack, RefusesEveryNameThatCouldHarm) {
    EXPECT_EQ(refusal(archive_of({{"run/report.json"}, {"run/keys/a.pub"}})), "");
    for (const char* name :
         {"/etc/runcert", "../x", "run/../../x", "run/..", "./x", "run//x", "run/.ssh", "-rf",
          "run/a b", "run/a\\b", "run/a\nb", "run/\x1b[31m", "run/$(x)", "run/caf\xc3\xa9", "C:x"})
        EXPECT_TRUE(holds(refusal(archive_of({{"run/report.json"}, {name}})), "holds the name"))
            << name;
}

TEST(Unpack, RefusesWhatIsNoPlainFile) {
    const std::vector<Entry> cases{{.name = "run/l", .type = AE_IFLNK, .link = "/etc/passwd"},
                                   {.name = "run/l", .type = AE_IFLNK, .link = "report.json"},
                                   {.name = "run/h", .link = "run/report.json", .hard = true},
                                   {.name = "run/c", .type = AE_IFCHR},
                                   {.name = "run/b", .type = AE_IFBLK},
                                   {.name = "run/p", .type = AE_IFIFO}};
    for (const Entry& one : cases) {
        const std::string said = refusal(archive_of({{"run/report.json"}, one}));
        EXPECT_TRUE(holds(said, "link") || holds(said, "no plain file")) << one.name << said;
        EXPECT_TRUE(holds(said, one.name)) << said;
    }
    EXPECT_TRUE(
        holds(refusal(archive_of({{"run/a", "1"}, {"run/b"}, {"run/a", "2"}})), "\"run/a\" twice"));
    EXPECT_TRUE(holds(refusal(archive_of({{"run/a/b"}, {"run/a"}})), "a file and a folder"));
}

TEST(Unpack, RefusesWhatWouldFillTheDisk) {
    const std::string big =
        archive_of({{"run/a", std::string(600, 'a')}, {"run/b", std::string(600, 'b')}});
    EXPECT_EQ(refusal(big, {.bytes = 1200}), "");
    EXPECT_TRUE(holds(refusal(big, {.bytes = 1199}), "more than 1199 bytes"));
    EXPECT_TRUE(holds(refusal(big, {.files = 1}), "more than 1 files"));
    const std::string folders = archive_of(
        {{"a", "", AE_IFDIR}, {"b", "", AE_IFDIR}, {"c", "", AE_IFDIR}, {"d/report.json"}});
    EXPECT_EQ(refusal(folders, {.files = 4}), "");
    EXPECT_TRUE(holds(refusal(folders, {.files = 3}), "more than 3 files"));
    EXPECT_EQ(UnpackLimits{}.bytes, std::uint64_t{4} << 30);
    // A hole of 5 GiB takes a few hundred bytes, in each way that tar writes it.
    const TemporaryFolder there;
    ASSERT_EQ(shell(there.path(),
                    "mkdir run; truncate -s 5G run/hole; for f in gnu posix; do "
                    "tar -S --format=$f --zstd -cf $f.tar.zst run; done")
                  .exit_status,
              0);
    for (const char* name : {"gnu.tar.zst", "posix.tar.zst"}) {
        const std::string said = refusal(read_file(there.path() / name));
        EXPECT_TRUE(holds(said, "sparse") || holds(said, "more than")) << said;
    }
}

TEST(Unpack, RefusesOtherFilesAndDamage) {
    const TemporaryFolder there;
    ASSERT_EQ(shell(there.path(),
                    "mkdir run; echo x > run/report.json; tar -cf a.tar run; gzip -k "
                    "a.tar; echo text | zstd -q > b.zst")
                  .exit_status,
              0);
    EXPECT_TRUE(holds(refusal(read_file(there.path() / "a.tar")), "zst"));
    EXPECT_TRUE(holds(refusal(read_file(there.path() / "a.tar.gz")), "zst"));
    EXPECT_NE(refusal(read_file(there.path() / "b.zst")), "");
    EXPECT_NE(refusal("not an archive"), "");
    EXPECT_NE(refusal(""), "");
    const std::string whole = archive_of({{"run/a", std::string(5000, 'q')}, {"run/report.json"}});
    for (const double part : {0.1, 0.5, 0.9, 0.99})
        EXPECT_NE(refusal(whole.substr(
                      0, static_cast<std::size_t>(static_cast<double>(whole.size()) * part))),
                  "")
            << part;
}

TEST(Unpack, ABundleIsOneFolderWithAReport) {
    const TemporaryFolder there;
    const fs::path file = there.path() / "x.tar.zst";
    const auto said = [&](const std::vector<Entry>& entries) -> std::string {
        write_quickly(file, archive_of(entries));
        try {
            const UnpackedBundle bundle = unpack_bundle(file);
            return fs::exists(bundle.run_dir / "report.json") ? "" : "nothing there";
        } catch (const Failure& failure) {
            return failure.problem();
        }
    };
    EXPECT_EQ(said({{"run/report.json"}}), "");
    EXPECT_TRUE(holds(said({{"run/report.json"}, {"other/x"}}), "one folder"));
    EXPECT_TRUE(holds(said({{"report.json"}}), "one folder"));
    EXPECT_TRUE(holds(said({{"run/a"}}), "one folder"));
    EXPECT_TRUE(holds(said({}), "one folder"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
