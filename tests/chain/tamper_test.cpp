#include <fmt/format.h>

#include "core/failure.h"
#include "core/random.h"
#include "draws.h"
#include "handover_support.h"
#include "trust/bundle.h"

// Every byte of a bundle is vouched for: a signed bundle is unpacked, one byte of it changed at a
// time, and `runcert verify` must not accept it and must name the file.

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr std::uint64_t seed = 20260314;
/// How many bytes are changed. The first change of each file is certain to be made; those beyond
/// look for a place in a file that nothing vouches for: of one that is a tenth of a file 24 find it
/// with probability 0.9, 300 one of a hundredth with 0.95.
int changes_wanted(std::size_t files) {
    return static_cast<int>(files) + draws({.daily = 24, .study = 300});
}

class Tamper : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        signed_ = new SignedRun("salt_lake", has_program("weasyprint") ? "--brief" : "--no-render");
        const fs::path file = signed_->path() / "salt-lake.tar.zst";
        const ProcessResult made = runcert({"bundle", signed_->run().string(), "--out",
                                            file.string(), "--pubkey", signed_->public_key()});
        ASSERT_EQ(made.exit_status, 0) << made.errors;
        bundle_ = new UnpackedBundle(unpack_bundle(file));
    }
    static void TearDownTestSuite() {
        delete bundle_;
        delete signed_;
    }
    static ProcessResult verify() {
        return runcert({"verify", bundle_->run_dir.string(), "--pubkey", signed_->public_key()});
    }

    static SignedRun* signed_;
    static UnpackedBundle* bundle_;
};
SignedRun* Tamper::signed_ = nullptr;
UnpackedBundle* Tamper::bundle_ = nullptr;

std::size_t below(RandomGenerator& random, std::size_t count) {
    return static_cast<std::size_t>(random.uniform() * static_cast<double>(count));
}

TEST_F(Tamper, TheBundleIsAcceptedAsItIs) {
    const ProcessResult result = verify();
    EXPECT_EQ(result.exit_status, 0) << result.output << result.errors;
    EXPECT_TRUE(check_sums(bundle_->run_dir).empty());
}

TEST_F(Tamper, EveryChangeOfOneByteIsFoundAndItsFileNamed) {
    const auto files = contents_of(bundle_->run_dir);
    std::vector<std::string> names;
    for (const auto& [name, bytes] : files)
        if (!bytes.empty()) names.push_back(name);
    ASSERT_GE(names.size(), 14u);
    RandomGenerator random(seed);
    const int changes = changes_wanted(names.size());
    int found = 0;
    for (int i = 0; i < changes; ++i) {
        const auto next = static_cast<std::size_t>(i);
        const std::string& name =
            next < names.size() ? names[next] : names[below(random, names.size())];
        const std::string& bytes = files.at(name);
        const std::size_t at = below(random, bytes.size());
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ static_cast<char>(1 + below(random, 255)));
        ASSERT_NE(changed, bytes);
        write_quickly(bundle_->run_dir / name, changed);
        const ProcessResult result = verify();
        const bool accepted = result.exit_status != 1 && result.exit_status != 2;
        const bool named = holds(result.output + result.errors, name);
        EXPECT_FALSE(accepted) << name << " byte " << at << result.output;
        EXPECT_TRUE(named) << name << " byte " << at << "\n" << result.output << result.errors;
        EXPECT_FALSE(check_sums(bundle_->run_dir).empty()) << name << " byte " << at;
        found += accepted || !named ? 0 : 1;
        write_quickly(bundle_->run_dir / name, bytes);
    }
    EXPECT_EQ(found, changes);
    EXPECT_EQ(verify().exit_status, 0);
}

TEST_F(Tamper, AChangeOfTheBundleItselfIsRefusedOrFound) {
    const int changes = changes_wanted(0);
    const fs::path file = signed_->path() / "salt-lake.tar.zst";
    const fs::path other = signed_->path() / "changed.tar.zst";
    const std::string bytes = read_file(file);
    const auto original = contents_of(bundle_->run_dir);
    RandomGenerator random(seed + 1);
    int refused = 0;
    for (int i = 0; i < changes; ++i) {
        std::string changed = bytes;
        const std::size_t at = below(random, bytes.size());
        changed[at] = static_cast<char>(changed[at] ^ static_cast<char>(1 + below(random, 255)));
        write_quickly(other, changed);
        try {
            const UnpackedBundle bundle = unpack_bundle(other);
            // Some bits of zstd's own fields say nothing of the contents.
            const bool found = !check_sums(bundle.run_dir).empty();
            EXPECT_TRUE(found || contents_of(bundle.run_dir) == original) << at;
            refused += found ? 1 : 0;
        } catch (const Failure& failure) {
            EXPECT_TRUE(holds(failure.where(), "changed.tar.zst")) << failure.where();
            ++refused;
        }
    }
    EXPECT_GT(refused, changes * 9 / 10);
}

TEST_F(Tamper, WhoMendsSha256SumsTooIsFoundByTheReport) {
    const fs::path file = bundle_->run_dir / "4-trajectory.ecsv";
    const std::string before = read_file(file);
    const std::string sums = read_file(bundle_->run_dir / "SHA256SUMS");
    const std::size_t last_row = before.rfind('\n', before.size() - 2);
    write_quickly(file, before.substr(0, last_row + 1));  // a row removed
    const ProcessResult mended = shell(
        bundle_->run_dir,
        "LC_ALL=C find * -type f ! -name SHA256SUMS | LC_ALL=C sort | xargs sha256sum > ../mended; "
        "mv ../mended SHA256SUMS");
    ASSERT_EQ(mended.exit_status, 0) << mended.errors;
    EXPECT_TRUE(check_sums(bundle_->run_dir).empty());
    const ProcessResult result = verify();
    EXPECT_NE(result.exit_status, 0);
    EXPECT_TRUE(holds(result.output + result.errors, "4-trajectory.ecsv")) << result.output;
    write_quickly(file, before);
    write_quickly(bundle_->run_dir / "SHA256SUMS", sums);
    EXPECT_EQ(verify().exit_status, 0);
}

TEST_F(Tamper, AFileMoreOrLessIsFound) {
    write_quickly(bundle_->run_dir / "keys" / "more.pub", "x");
    EXPECT_EQ(check_sums(bundle_->run_dir).size(), 1u);
    ProcessResult result = verify();
    EXPECT_NE(result.exit_status, 0);
    EXPECT_TRUE(holds(result.output + result.errors, "keys/more.pub")) << result.output;
    fs::remove(bundle_->run_dir / "keys" / "more.pub");
    const std::string text = read_file(bundle_->run_dir / "VERIFY.txt");
    fs::remove(bundle_->run_dir / "VERIFY.txt");
    result = verify();
    EXPECT_NE(result.exit_status, 0);
    EXPECT_TRUE(holds(result.output + result.errors, "VERIFY.txt is missing")) << result.output;
    write_quickly(bundle_->run_dir / "VERIFY.txt", text);
    EXPECT_EQ(verify().exit_status, 0);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
