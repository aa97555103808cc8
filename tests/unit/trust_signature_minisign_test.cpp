#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "store/atomic_file.h"
#include "trust/signature.h"

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

const std::string message("{\"speed_m_s\": 56.36}\n\0\xFF", 23);

/// What the program minisign makes of our files, and we of its.
class WithMinisign : public testing::Test {
  protected:
    void SetUp() override {
        if (run("minisign -v") != 0) GTEST_SKIP() << "minisign is not installed";
        std::string name = (fs::temp_directory_path() / "runcert-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
        write_file_atomically(folder_ / "f", message);
    }
    void TearDown() override {
        if (!folder_.empty()) fs::remove_all(folder_);
    }

    /// The exit status of a shell command in the test's folder.
    int run(const std::string& command) const {
        const std::string in_folder = (folder_.empty() ? "" : "cd '" + folder_.string() + "' && ") +
                                      "{ " + command + "; } >/dev/null 2>&1";
        const int status = std::system(in_folder.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    void write(const std::string& name, const std::string& text) const {
        write_file_atomically(folder_ / name, text);
    }
    std::string read(const std::string& name) const { return read_file(folder_ / name); }

    fs::path folder_;
};

TEST_F(WithMinisign, AcceptsOurSignatureAndRefusesChanges) {
    const KeyPair pair = generate_key_pair();
    const std::string text = sign(message, pair.secret_key, "Müller, Nagoya");
    write("k.pub", public_key_file(pair.public_key));
    write("f.minisig", text);
    EXPECT_EQ(run("minisign -Vm f -p k.pub"), 0);
    EXPECT_EQ(run("test \"$(minisign -QVm f -p k.pub)\" = 'Müller, Nagoya'"), 0);
    std::string changed = text;
    changed.replace(changed.find("ü"), 2, "ue");
    write("f.minisig", changed);
    EXPECT_NE(run("minisign -Vm f -p k.pub"), 0);
    write("f.minisig", text);
    write("f", message + "x");
    EXPECT_NE(run("minisign -Vm f -p k.pub"), 0);
}

TEST_F(WithMinisign, ReadsTheLongestCommentsWeWrite) {
    const KeyPair pair = generate_key_pair();
    write("k.pub", public_key_file(pair.public_key));
    for (const std::size_t length : {std::size_t{0}, std::size_t{8000}}) {
        write("f.minisig", sign(message, pair.secret_key, std::string(length, 't')));
        EXPECT_EQ(run("minisign -Vm f -p k.pub"), 0) << length;
    }
}

TEST_F(WithMinisign, ItsSignatureIsAcceptedByUs) {
    ASSERT_EQ(run("minisign -G -W -p m.pub -s m.key && minisign -S -s m.key -m f"), 0);
    const PublicKey key = parse_public_key(read("m.pub"), "m.pub");
    EXPECT_TRUE(check_signature(message, read("f.minisig"), key, "f.minisig").valid);
    EXPECT_FALSE(check_signature(message + "x", read("f.minisig"), key, "f.minisig").valid);
    // It leaves out leading zeros.
    const std::string id = key_id_text(key);
    EXPECT_NE(read("m.pub").find(id.substr(id.find_first_not_of('0'))), std::string::npos);
    const SecretKey secret = parse_secret_key(read("m.key"), std::nullopt, "m.key");
    EXPECT_EQ(public_key_of(secret), key);

    ASSERT_EQ(run("minisign -S -l -s m.key -m f -x legacy.minisig"), 0);
    const SignatureCheck legacy =
        check_signature(message, read("legacy.minisig"), key, "legacy.minisig");
    EXPECT_FALSE(legacy.valid);
    EXPECT_NE(legacy.reason.find("legacy"), std::string::npos);
}

TEST_F(WithMinisign, SignsWithOurSecretKey) {
    const KeyPair pair = generate_key_pair();
    write("k.key", secret_key_file(pair, std::nullopt));
    ASSERT_EQ(run("minisign -S -s k.key -m f -t theirs"), 0);
    const SignatureCheck check =
        check_signature(message, read("f.minisig"), pair.public_key, "f.minisig");
    EXPECT_TRUE(check.valid) << check.reason;
    EXPECT_EQ(check.trusted_comment, "theirs");
}

TEST_F(WithMinisign, SecretKeysWithPasswordsGoBothWays) {
    const KeyPair pair = generate_key_pair();
    write("k.key", secret_key_file(pair, "läuft schnell"));
    ASSERT_EQ(run("echo 'läuft schnell' | minisign -S -s k.key -m f"), 0);
    EXPECT_TRUE(check_signature(message, read("f.minisig"), pair.public_key, "f.minisig").valid);
    EXPECT_NE(run("echo wrong | minisign -S -s k.key -m f"), 0);

    ASSERT_EQ(run("printf 'ihrs\\nihrs\\n' | minisign -G -p m.pub -s m.key"), 0);
    const SecretKey theirs = parse_secret_key(read("m.key"), "ihrs", "m.key");
    EXPECT_EQ(public_key_of(theirs), parse_public_key(read("m.pub"), "m.pub"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
