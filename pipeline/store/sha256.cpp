#include "store/sha256.h"

#include <nettle/base16.h>
#include <nettle/sha2.h>

#include <array>

#include "store/atomic_file.h"

namespace runcert {

std::string sha256_hex(std::string_view bytes) {
    return digest_of(bytes).sha256;
}

FileDigest digest_of(std::string_view bytes) {
    return digest_of_pieces([&](const auto& add) { add(bytes); });
}

FileDigest digest_of(const FileView& file) {
    return digest_of_pieces([&](const auto& add) { file.for_each_piece(add); });
}

FileDigest digest_file(const std::filesystem::path& path) {
    return digest_of_pieces([&](const auto& add) { read_pieces(path, add); });
}

// Nettle's uses the processor's own instructions where there are some, and takes next to no time to
// load.
FileDigest digest_of_pieces(
    const std::function<void(const std::function<void(std::string_view)>& add)>& give) {
    FileDigest digest{.sha256 = std::string(BASE16_ENCODE_LENGTH(SHA256_DIGEST_SIZE), '\0')};
    sha256_ctx state{};
    sha256_init(&state);
    give([&](std::string_view piece) {
        sha256_update(&state, piece.size(), reinterpret_cast<const std::uint8_t*>(piece.data()));
        digest.bytes += piece.size();
    });
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> hash{};
    sha256_digest(&state, hash.size(), hash.data());
    base16_encode_update(digest.sha256.data(), hash.size(), hash.data());
    return digest;
}

}  // namespace runcert
