#include <gtest/gtest.h>

#include "trust/merkle_tree.h"

// Roots and paths of the eight entries by which implementations of RFC 6962 and RFC 9162 test
// themselves (certificate-transparency, merkletree tests).

namespace runcert::RUNCERT_FILE {
namespace {

std::vector<std::string> leaves(std::size_t count) {
    const std::vector<std::string> entries{std::string(),
                                           std::string(1, '\0'),
                                           "\x10",
                                           "\x20\x21",
                                           "\x30\x31",
                                           "\x40\x41\x42\x43",
                                           "\x50\x51\x52\x53\x54\x55\x56\x57",
                                           "\x60\x61\x62\x63\x64\x65\x66\x67\x68\x69\x6a\x6b"
                                           "\x6c\x6d\x6e\x6f"};
    std::vector<std::string> hashes;
    for (std::size_t i = 0; i < count; ++i)
        hashes.push_back(leaf_hash(entries[i]));
    return hashes;
}

TEST(MerkleTree, RootsAreThoseOfTheReference) {
    const std::vector<std::string> roots{
        "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855",
        "6e340b9cffb37a989ca544e6bb780a2c78901d3fb33738768511a30617afa01d",
        "fac54203e7cc696cf0dfcb42c92a1d9dbaf70ad9e621f4bd8d98662f00e3c125",
        "aeb6bcfe274b70a14fb067a5e5578264db0fa9b51af5e0ba159158f329e06e77",
        "d37ee418976dd95753c1c73862b9398fa2a2cf9b4ff0fdfe8b30cd95209614b7",
        "4e3bbb1f7b478dcfe71fb631631519a3bca12c9aefca1612bfce4c13a86264d4",
        "76e67dadbcdf1e10e1b74ddc608abd2f98dfb16fbce75277b5232a127f2087ef",
        "ddb89be403809e325750d3d263cd78929c2942b7942a34b77e122c9594a74c8c",
        "5dc9da79a70659a9ad559cb701ded9a2ab9d823aad2f4960cfe370eff4604328"};
    for (std::size_t size = 0; size < roots.size(); ++size)
        EXPECT_EQ(tree_root(leaves(size)), roots[size]) << size;
}

TEST(MerkleTree, PathsAreThoseOfTheReference) {
    EXPECT_EQ(inclusion_path(leaves(8), 0),
              (std::vector<std::string>{
                  "96a296d224f285c67bee93c30f8a309157f0daa35dc5b87e410b78630a09cfc7",
                  "5f083f0a1a33ca076a95279832580db3e0ef4584bdff1f54c8a360f50de3031e",
                  "6b47aaf29ee3c2af9af889bc1fb9254dabd31177f16232dd6aab035ca39bf6e4"}));
    EXPECT_EQ(inclusion_path(leaves(8), 5),
              (std::vector<std::string>{
                  "bc1a0643b12e4d2d7c77918f44e0f4f79a838b6cf9ec5b5c283e1f4d88599e6b",
                  "ca854ea128ed050b41b35ffc1b87b8eb2bde461e9e3b5596ece6b9d5975a0ae0",
                  "d37ee418976dd95753c1c73862b9398fa2a2cf9b4ff0fdfe8b30cd95209614b7"}));
}

TEST(MerkleTree, APathLeadsToTheRootOfItsEntryAlone) {
    for (std::size_t size = 1; size <= 8; ++size) {
        const auto all = leaves(size);
        for (std::size_t i = 0; i < size; ++i) {
            SCOPED_TRACE(i);
            std::vector<std::string> path = inclusion_path(all, i);
            EXPECT_EQ(root_of_path(all[i], i, size, path), tree_root(all));
            EXPECT_NE(root_of_path(all[i], (i + 1) % (size + 1), size, path), tree_root(all));
            EXPECT_NE(root_of_path(leaf_hash("another"), i, size, path), tree_root(all));
            path.push_back(all[0]);
            EXPECT_FALSE(root_of_path(all[i], i, size, path));
        }
    }
    EXPECT_FALSE(root_of_path(leaf_hash("one"), 1, 1, {}));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
