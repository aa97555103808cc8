#include <fmt/format.h>

#include "core/random.h"
#include "draws.h"
#include "handover_support.h"

// A signed run and a bundle of it are changed again and again, each time in one place: no change is
// accepted. run.yaml is not among them: it tells when and how long the stages ran, and nothing
// depends on it.

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr std::uint64_t seed = 20260723;
// Each file is changed, removed and renamed for certain; what is beyond is random, and finds a
// place that nothing vouches for with the probability 1 - (1 - its share of the bytes)^n.
constexpr Draws changes_of_folder{.daily = 20, .study = 570};
constexpr Draws changes_of_bundle{.daily = 24, .study = 350};
constexpr Draws changes_of_pages{.daily = 4, .study = 40};

class ChangedBytes : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        signed_ = new SignedRun("land_yacht", has_pages() ? "--brief" : "--no-render");
    }
    static void TearDownTestSuite() { delete signed_; }
    static bool has_pages() { return has_program("weasyprint"); }

    void SetUp() override {
        fs::copy(signed_->run(), run(), fs::copy_options::recursive);
        fs::remove(run() / "run.yaml");
    }
    fs::path path(const std::string& name) const { return folder_.path() / name; }
    fs::path run() const { return path("run"); }

    /// Whether a folder or a bundle is not accepted, as a board would ask.
    static bool is_seen(const fs::path& given) {
        for (const std::vector<std::string>& more :
             {std::vector<std::string>{}, std::vector<std::string>{"--recompute"}}) {
            std::vector<std::string> arguments{"verify", given.string(), "--pubkey",
                                               signed_->public_key()};
            arguments.insert(arguments.end(), more.begin(), more.end());
            const int status = runcert(arguments).exit_status;
            if (status == 1 || status == 2) return true;
            EXPECT_EQ(status, 0) << "of verify " << given;
        }
        return false;
    }
    fs::path bundle_without_pages() const {
        fs::path bundle = path("run.tar.zst");
        for (const char* page : {"report.html", "certificate.pdf", "report.pdf"})
            fs::remove(run() / page);
        EXPECT_EQ(runcert({"bundle", run().string(), "--out", bundle.string(), "--pubkey",
                           signed_->public_key()})
                      .exit_status,
                  0);
        EXPECT_FALSE(is_seen(bundle));
        return bundle;
    }
    std::size_t below(std::size_t count) {
        return static_cast<std::size_t>(random_.uniform() * static_cast<double>(count));
    }
    /// Changes bytes in one place, and says where.
    std::string change(std::string& bytes) {
        const std::size_t at = below(bytes.size());
        switch (below(8)) {
            case 0:
                bytes.resize(at);
                return fmt::format("cut at {}", at);
            case 1:
                bytes += static_cast<char>(below(256));
                return "a byte appended";
            default:
                bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1 + below(255)));
                return fmt::format("byte {}", at);
        }
    }
    std::string some_name(const std::vector<std::string>& names) {
        return names[below(names.size())];
    }

    static SignedRun* signed_;
    RandomGenerator random_{seed};
    TemporaryFolder folder_;
};
SignedRun* ChangedBytes::signed_ = nullptr;

std::vector<std::string> names_in(const std::map<std::string, std::string>& files) {
    std::vector<std::string> names;
    for (const auto& [name, bytes] : files)
        names.push_back(name);
    return names;
}

TEST_F(ChangedBytes, OfTheRunFolderAreAllSeen) {
    for (const char* page : {"report.html", "certificate.pdf", "report.pdf"})
        fs::remove(run() / page);
    ASSERT_FALSE(is_seen(run()));
    const auto files = contents_of(run());
    const std::vector<std::string> names = names_in(files);
    const auto certain = static_cast<int>(names.size());
    for (int i = 0; i < 3 * certain + draws(changes_of_folder); ++i) {
        const bool random = i >= 3 * certain;
        const std::string name =
            random ? some_name(names) : names[static_cast<std::size_t>(i % certain)];
        const int kind = random ? i % 20 : i / certain;
        std::string what = fmt::format("{}: ", name);
        const fs::path other = run() / some_name({"more.ecsv", "7-more.yaml", "report.json.sig",
                                                  "keys/more.pub", "profile.more.yaml"});
        switch (kind) {
            case 0:
                what += "removed";
                fs::remove(run() / name);
                break;
            case 1:
                what += "renamed to " + other.filename().string();
                fs::create_directories(other.parent_path());
                fs::rename(run() / name, other);
                break;
            case 3:
                what = "added: " + other.filename().string();
                fs::create_directories(other.parent_path());
                write_quickly(other, files.at(name));
                break;
            default: {
                std::string bytes = files.at(name);
                what += change(bytes);
                write_quickly(run() / name, bytes);
            }
        }
        EXPECT_TRUE(is_seen(run())) << what;
        fs::remove_all(other);
        fs::remove(run() / "keys");
        write_quickly(run() / name, files.at(name));
    }
    EXPECT_FALSE(is_seen(run()));
}

TEST_F(ChangedBytes, OfABundleAreAllSeen) {
    const fs::path bundle = bundle_without_pages();
    const std::string whole = read_file(bundle);
    for (int i = 0; i < draws(changes_of_bundle); ++i) {
        std::string bytes = whole;
        const std::string what = change(bytes);
        write_quickly(bundle, bytes);
        EXPECT_TRUE(is_seen(bundle)) << what;
    }
}

// Bits and frames of Zstandard (RFC 8878) that leave what is unpacked as it was.
TEST_F(ChangedBytes, OfABundlesCompressionAreAllSeen) {
    const fs::path bundle = bundle_without_pages();
    const std::string whole = read_file(bundle);
    const std::string skippable("\x50\x2a\x4d\x18\x04\0\0\0text", 12);
    std::map<std::string, std::string> changed{{"a skippable frame before it", skippable + whole},
                                               {"a skippable frame after it", whole + skippable},
                                               {"a bit of the header without a meaning", whole},
                                               {"a larger window", whole}};
    changed["a bit of the header without a meaning"][4] ^= 0x10;
    changed["a larger window"][5] = static_cast<char>(whole[5] + 8);
    for (const auto& [what, bytes] : changed) {
        write_quickly(bundle, bytes);
        EXPECT_TRUE(is_seen(bundle)) << what;
    }
}

TEST_F(ChangedBytes, OfThePagesAreAllSeen) {
    if (!has_pages()) GTEST_SKIP() << "weasyprint is not installed";
    const std::vector<std::string> pages{"report.html", "certificate.pdf"};
    std::map<std::string, std::string> whole;
    for (const std::string& name : pages)
        whole[name] = read_file(run() / name);
    for (int i = 0; i < draws(changes_of_pages); ++i) {
        // Each alone: the other would be rendered for nothing.
        for (const std::string& name : pages)
            fs::remove(run() / name);
        const std::string& name = pages[static_cast<std::size_t>(i % 2)];
        std::string bytes = whole[name];
        const std::string what = change(bytes);
        write_quickly(run() / name, bytes);
        EXPECT_TRUE(is_seen(run())) << name << ": " << what;
    }
    for (const auto& [name, bytes] : whole)
        write_quickly(run() / name, bytes);
    EXPECT_FALSE(is_seen(run()));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
