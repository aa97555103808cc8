#include <archive.h>
#include <archive_entry.h>

#include "core/failure.h"
#include "handover_support.h"
#include "store/archive.h"
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

/// The forms that a bundle may have.
constexpr ArchiveForm forms[] = {ArchiveForm::tar_zst, ArchiveForm::zip};

std::string archive_of(const std::vector<Entry>& entries, ArchiveForm form = ArchiveForm::tar_zst) {
    std::string bytes;
    archive* a = archive_write_new();
    if (form == ArchiveForm::zip) {
        archive_write_set_format_zip(a);  // deflated
    } else {
        archive_write_set_format_pax_restricted(a);
        archive_write_add_filter_zstd(a);
    }
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
        unpack_archive(bytes, "x.tar.zst", there.path() / "in", limits);
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
    for (const ArchiveForm form : forms) {
        EXPECT_EQ(refusal(archive_of({{"run/report.json"}, {"run/keys/a.pub"}}, form)), "");
        for (const char* name : {"/etc/runcert", "../x", "run/../../x", "run/..", "./x", "run//x",
                                 "run/.ssh", "-rf", "run/a b", "run/a\\b", "run/a\nb",
                                 "run/\x1b[31m", "run/$(x)", "run/caf\xc3\xa9", "C:x"})
            EXPECT_TRUE(
                holds(refusal(archive_of({{"run/report.json"}, {name}}, form)), "holds the name"))
                << name << ending_of(form);
    }
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
    // Of these a ZIP knows links alone.
    EXPECT_TRUE(
        holds(refusal(archive_of({{"run/report.json"}, cases.front()}, ArchiveForm::zip)), "link"));
    for (const ArchiveForm form : forms) {
        EXPECT_TRUE(holds(refusal(archive_of({{"run/a", "1"}, {"run/b"}, {"run/a", "2"}}, form)),
                          "\"run/a\" twice"));
        EXPECT_TRUE(
            holds(refusal(archive_of({{"run/a/b"}, {"run/a"}}, form)), "a file and a folder"));
    }
}

TEST(Unpack, RefusesWhatWouldFillTheDisk) {
    for (const ArchiveForm form : forms) {
        const std::string big =
            archive_of({{"run/a", std::string(600, 'a')}, {"run/b", std::string(600, 'b')}}, form);
        EXPECT_EQ(refusal(big, {.bytes = 1200}), "");
        EXPECT_TRUE(holds(refusal(big, {.bytes = 1199}), "more than 1199 bytes"));
        EXPECT_TRUE(holds(refusal(big, {.files = 1}), "more than 1 files"));
        const std::string folders = archive_of(
            {{"a", "", AE_IFDIR}, {"b", "", AE_IFDIR}, {"c", "", AE_IFDIR}, {"d/report.json"}},
            form);
        EXPECT_EQ(refusal(folders, {.files = 4}), "");
        EXPECT_TRUE(holds(refusal(folders, {.files = 3}), "more than 3 files"));
    }
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

TEST(Unpack, RefusesAFileLongerThanOneOfItsKind) {
    const auto most = [](std::uint64_t report) {
        return UnpackLimits{.bytes_of = [report](std::string_view name) {
            return name == "run/report.json" ? report : std::uint64_t{900};
        }};
    };
    for (const ArchiveForm form : forms) {
        const std::string bytes = archive_of(
            {{"run/report.json", std::string(700, 'a')}, {"run/b", std::string(900, 'b')}}, form);
        EXPECT_EQ(refusal(bytes, most(700)), "");
        EXPECT_TRUE(
            holds(refusal(bytes, most(699)), "\"run/report.json\" in it is longer than 699"));
    }
}

/// Bytes replaced from a place on.
std::string with_bytes(std::string text, std::size_t at, std::string_view bytes) {
    return text.replace(at, bytes.size(), bytes);
}

// What a ZIP says twice, in front of a file and in its central directory, may be two things.
TEST(Unpack, RefusesAZipThatSaysOtherThanItHolds) {
    const std::string whole =
        archive_of({{"run/report.json", std::string(700, 'a')}}, ArchiveForm::zip);
    const std::size_t listed = whole.find("PK\x01\x02");
    ASSERT_NE(listed, std::string::npos);
    constexpr std::size_t flags = 8, flags_in_front = 6, unpacked_size = 24, place = 42;
    EXPECT_EQ(refusal(whole), "");
    // Shorter, longer, and without end; another place; encrypted.
    for (const std::string_view size :
         {std::string_view("\xbb\x02", 2), {"\xbd\x02", 2}, {"\xff\xff\xff\xff", 4}})
        EXPECT_NE(refusal(with_bytes(whole, listed + unpacked_size, size)), "");
    EXPECT_NE(refusal(with_bytes(whole, listed + place, "\x40")), "");
    EXPECT_TRUE(holds(
        refusal(with_bytes(with_bytes(whole, listed + flags, "\x09"), flags_in_front, "\x09")),
        "encrypted"));
    EXPECT_NE(refusal("PK\x03\x04"), "");
    EXPECT_NE(refusal("PK" + archive_of({{"run/report.json"}})), "");
}

// 395 kB took 1.8 GB of disk and 2.1 GB of memory.
TEST(BundleLimits, ABundleMadeToFillTheDiskIsRefusedBeforeItDoes) {
    const TemporaryFolder there;
    ASSERT_EQ(shell(there.path(),
                    "mkdir -p a/run b/run t; echo {} > a/run/report.json; head -c 400000000 "
                    "/dev/zero > a/run/recording.primary.csv; head -c 17000000 /dev/zero > "
                    "b/run/report.json; for x in a b; do tar --zstd -C $x -cf $x.tar.zst run; (cd "
                    "$x; zip -q -r ../$x.zip run); done")
                  .exit_status,
              0);
    const Environment own{{"TMPDIR", (there.path() / "t").string()}};
    const auto verified = [&](const std::string& name) {
        const ProcessResult result = runcert({"verify", (there.path() / name).string()}, own);
        EXPECT_LT(result.peak_memory_bytes, std::uint64_t{200} << 20);
        EXPECT_TRUE(fs::is_empty(there.path() / "t"));
        return result;
    };
    ASSERT_LT(fs::file_size(there.path() / "a.tar.zst"), 100'000U);
    for (const std::string form : {".tar.zst", ".zip"}) {
        expect_refused(verified("a" + form),
                       {"recording.primary.csv", "more than 268435456 bytes"});
        expect_refused(verified("b" + form), {"report.json", "the most for one of its kind"});
    }
}

TEST(BundleLimits, AreInTheHelpOfWhoeverUsesThem) {
    for (const char* command : {"bundle", "verify"})
        EXPECT_TRUE(holds(runcert({command, "--help"}).output, bundle_limits_words())) << command;
    EXPECT_EQ(most_bytes_of("keys/roster"), std::uint64_t{1} << 20);
    EXPECT_EQ(most_bytes_of("report.json.minisig"), std::uint64_t{1} << 20);
    EXPECT_EQ(most_bytes_of("certificate.pdf"), longest_pdf);
    EXPECT_EQ(most_bytes_of("6-verdict.yaml"), std::uint64_t{16} << 20);
    EXPECT_EQ(most_bytes_of("4-trajectory.ecsv"), std::uint64_t{2} << 30);
}

TEST(BundleLimits, WhatVerifyWouldRefuseIsNotBundled) {
    const SignedRun made("salt_lake", "--brief");
    fs::resize_file(made.run() / "certificate.pdf", longest_pdf + 1);
    for (const char* command : {"bundle", "verify"}) {
        const ProcessResult result = runcert({command, made.run().string()});
        expect_refused(result, {"certificate.pdf", "longer than 33554432 bytes"});
    }
    fs::resize_file(made.run() / "certificate.pdf", longest_pdf);
    // All zeros but its beginning: more than 200 times as long as it packs to, and under 256 MiB.
    EXPECT_EQ(
        runcert({"bundle", made.run().string(), "--out", (made.path() / "b").string()}).exit_status,
        0);
    EXPECT_EQ(runcert({"verify", (made.path() / "b").string()}).exit_status, 1);
}

TEST(BundleLimits, APdfMadeToFillMemoryAndDiskDoesNot) {
    if (!has_program("qpdf")) GTEST_SKIP() << "qpdf is not installed";
    const SignedRun made("salt_lake");
    ASSERT_EQ(shell(made.path(),
                    "head -c 700000000 /dev/zero > report.json; qpdf --empty --add-attachment "
                    "report.json -- run/certificate.pdf; rm report.json; mkdir t")
                  .exit_status,
              0);
    ASSERT_LT(fs::file_size(made.run() / "certificate.pdf"), 4'000'000U);
    const ProcessResult result =
        runcert({"verify", made.run().string()}, {{"TMPDIR", (made.path() / "t").string()}});
    EXPECT_EQ(result.exit_status, 1) << result.errors;
    EXPECT_TRUE(holds(result.output, "NO   pages")) << result.output;
    EXPECT_LT(result.peak_memory_bytes, static_cast<std::uint64_t>(slower * 600e6));
    EXPECT_TRUE(fs::is_empty(made.path() / "t"));
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
    for (const ArchiveForm form : forms) {
        const std::string whole =
            archive_of({{"run/a", std::string(5000, 'q')}, {"run/report.json"}}, form);
        for (const double part : {0.1, 0.5, 0.9, 0.99})
            EXPECT_NE(refusal(whole.substr(
                          0, static_cast<std::size_t>(static_cast<double>(whole.size()) * part))),
                      "")
                << part << ending_of(form);
    }
}

TEST(Unpack, ABundleIsOneFolderWithAReport) {
    const TemporaryFolder there;
    const fs::path file = there.path() / "x.tar.zst";
    ArchiveForm form{};
    const auto said = [&](const std::vector<Entry>& entries) -> std::string {
        write_quickly(file, archive_of(entries, form));
        try {
            const UnpackedBundle bundle = unpack_bundle(file);
            return fs::exists(bundle.run_dir / "report.json") ? "" : "nothing there";
        } catch (const Failure& failure) {
            return failure.problem();
        }
    };
    for (const ArchiveForm one : forms) {
        form = one;
        EXPECT_EQ(said({{"run/report.json"}}), "");
        EXPECT_TRUE(holds(said({{"run/report.json"}, {"other/x"}}), "one folder"));
        EXPECT_TRUE(holds(said({{"report.json"}}), "one folder"));
        EXPECT_TRUE(holds(said({{"run/a"}}), "one folder"));
    }
    form = ArchiveForm::tar_zst;
    EXPECT_TRUE(holds(said({}), "one folder"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
