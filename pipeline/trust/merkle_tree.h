#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Merkle trees of a list of entries, as RFC 9162 section 2.1 has them, with SHA-256. Hashes are 64
// lower-case hexadecimal digits.

namespace runcert {

/// The hash of an entry: SHA-256(0x00, entry).
std::string leaf_hash(std::string_view entry);

/// The root over the hashes of entries; over none, that of no bytes (RFC 9162 2.1.1).
std::string tree_root(std::span<const std::string> leaves);

/// The hashes that lead from an entry, counted from 0, to the root (RFC 9162 2.1.3.1).
std::vector<std::string> inclusion_path(std::span<const std::string> leaves, std::size_t index);

/// The root to which a path leads from an entry's hash in a tree of `size` entries (RFC 9162
/// 2.1.3.2); nothing where the path is not one of that length.
std::optional<std::string> root_of_path(const std::string& leaf, std::size_t index,
                                        std::size_t size, std::span<const std::string> path);

}  // namespace runcert
