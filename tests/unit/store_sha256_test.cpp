#include <gtest/gtest.h>
#include <stdlib.h>

#include <array>
#include <cstdio>
#include <fstream>

#include "core/failure.h"
#include "store/sha256.h"

namespace runcert::RUNCERT_FILE {
namespace {

struct Vector {
    const char* source;
    std::string message;
    const char* sha256;
};

// FIPS 180-4's own examples, and NIST's for the empty message and a million letters.
const std::array<Vector, 5> published{{
    {"NIST CAVS, empty", "", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
    {"FIPS 180-4, one block", "abc",
     "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
    {"FIPS 180-4, two blocks", "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
     "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
    {"NIST, 896 bits",
     "abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqr"
     "lmnopqrsmnopqrstnopqrstu",
     "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1"},
    {"FIPS 180-4, long message", std::string(1'000'000, 'a'),
     "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0"},
}};

class Sha256Files : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "runcert-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path write(const std::string& bytes) {
        std::filesystem::path path = folder_ / "a file";
        std::ofstream(path, std::ios::binary) << bytes;
        return path;
    }

    std::filesystem::path folder_;
};

TEST(Sha256, PublishedVectors) {
    for (const Vector& vector : published) {
        EXPECT_EQ(sha256_hex(vector.message), vector.sha256) << vector.source;
        EXPECT_EQ(digest_of(vector.message), (FileDigest{vector.sha256, vector.message.size()}))
            << vector.source;
    }
}

TEST_F(Sha256Files, PublishedVectorsInFiles) {
    for (const Vector& vector : published)
        EXPECT_EQ(digest_file(write(vector.message)),
                  (FileDigest{vector.sha256, vector.message.size()}))
            << vector.source;
}

// 3 MiB and a little: more than one piece is read. Every byte value occurs.
TEST_F(Sha256Files, AgreesWithSha256sum) {
    std::string bytes;
    for (unsigned i = 0; i < 3U * 1024 * 1024 + 17; ++i)
        bytes += static_cast<char>((i * 2654435761U) >> 24U);
    const std::filesystem::path path = write(bytes);
    const std::string command = "sha256sum < '" + path.string() + "' 2>/dev/null";
    std::array<char, 65> printed{};
    FILE* output = popen(command.c_str(), "r");
    ASSERT_NE(output, nullptr);
    const std::size_t count = fread(printed.data(), 1, 64, output);
    pclose(output);
    if (count != 64) GTEST_SKIP() << "sha256sum is not installed";
    EXPECT_EQ(digest_file(path).sha256, printed.data());
    EXPECT_EQ(sha256_hex(bytes), printed.data());
    EXPECT_EQ(digest_file(path).bytes, bytes.size());
}

TEST_F(Sha256Files, MissingFileAndFolderAreFailures) {
    EXPECT_THROW(digest_file(folder_ / "nothing here"), Failure);
    EXPECT_THROW(digest_file(folder_), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
