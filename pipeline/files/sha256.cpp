#include "files/sha256.h"

#include <sodium.h>

#include <array>

#include "files/atomic_file.h"

namespace runcert {
namespace {

/// SHA-256 of bytes that come in pieces.
class Sha256 {
  public:
    Sha256() { crypto_hash_sha256_init(&state_); }

    void add(std::string_view piece) {
        crypto_hash_sha256_update(&state_, reinterpret_cast<const unsigned char*>(piece.data()),
                                  piece.size());
        bytes_ += piece.size();
    }

    FileDigest digest() {
        std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
        crypto_hash_sha256_final(&state_, hash.data());
        std::array<char, 2 * crypto_hash_sha256_BYTES + 1> text{};
        sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
        return {text.data(), bytes_};
    }

  private:
    crypto_hash_sha256_state state_{};
    std::uint64_t bytes_ = 0;
};

}  // namespace

std::string sha256_hex(std::string_view bytes) {
    return digest_of(bytes).sha256;
}

FileDigest digest_of(std::string_view bytes) {
    Sha256 hash;
    hash.add(bytes);
    return hash.digest();
}

FileDigest digest_file(const std::filesystem::path& path) {
    Sha256 hash;
    read_pieces(path, [&hash](std::string_view piece) { hash.add(piece); });
    return hash.digest();
}

}  // namespace runcert
