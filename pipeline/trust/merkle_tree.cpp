#include "trust/merkle_tree.h"

#include <bit>

#include "store/base64.h"
#include "store/sha256.h"

namespace runcert {
namespace {

/// SHA-256(0x01, left, right).
std::string node_hash(const std::string& left, const std::string& right) {
    std::string bytes(1, '\x01');
    for (const std::string& one : {left, right})
        bytes += decode_base64(base64_of_hex(one)).value_or("");
    return sha256_hex(bytes);
}

/// The largest power of two below a size above 1.
std::size_t left_size(std::size_t size) {
    return std::bit_floor(size - 1);
}

}  // namespace

std::string leaf_hash(std::string_view entry) {
    return sha256_hex(std::string(1, '\0') + std::string(entry));
}

std::string tree_root(std::span<const std::string> leaves) {
    if (leaves.empty()) return sha256_hex("");
    if (leaves.size() == 1) return leaves.front();
    const std::size_t left = left_size(leaves.size());
    return node_hash(tree_root(leaves.first(left)), tree_root(leaves.subspan(left)));
}

std::vector<std::string> inclusion_path(std::span<const std::string> leaves, std::size_t index) {
    if (leaves.size() < 2) return {};
    const std::size_t left = left_size(leaves.size());
    const auto first = leaves.first(left), rest = leaves.subspan(left);
    std::vector<std::string> path =
        index < left ? inclusion_path(first, index) : inclusion_path(rest, index - left);
    path.push_back(tree_root(index < left ? rest : first));
    return path;
}

std::optional<std::string> root_of_path(const std::string& leaf, std::size_t index,
                                        std::size_t size, std::span<const std::string> path) {
    if (index >= size) return std::nullopt;
    if (size == 1) return path.empty() ? std::optional(leaf) : std::nullopt;
    if (path.empty()) return std::nullopt;
    const std::size_t left = left_size(size);
    const auto below = path.first(path.size() - 1);
    const auto side = index < left ? root_of_path(leaf, index, left, below)
                                   : root_of_path(leaf, index - left, size - left, below);
    if (!side) return std::nullopt;
    return index < left ? node_hash(*side, path.back()) : node_hash(path.back(), *side);
}

}  // namespace runcert
