#include "store/sha256.h"

#include <nettle/sha2.h>

#include <array>

#include "store/atomic_file.h"

namespace runcert {
namespace {

std::string hexadecimal(const std::array<std::uint8_t, SHA256_DIGEST_SIZE>& hash) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : hash) {
        text += digits[byte >> 4];
        text += digits[byte & 0xf];
    }
    return text;
}

/// SHA-256 of bytes that come in pieces. Nettle's, which uses the processor's own instructions for
/// it where there are some, and takes next to no time to load.
class Sha256 {
  public:
    Sha256() { sha256_init(&state_); }

    void add(std::string_view piece) {
        sha256_update(&state_, piece.size(), reinterpret_cast<const std::uint8_t*>(piece.data()));
        bytes_ += piece.size();
    }

    FileDigest digest() {
        std::array<std::uint8_t, SHA256_DIGEST_SIZE> hash{};
        sha256_digest(&state_, hash.size(), hash.data());
        return {hexadecimal(hash), bytes_};
    }

  private:
    sha256_ctx state_{};
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

FileDigest digest_of(const FileView& file) {
    Sha256 hash;
    file.for_each_piece([&hash](std::string_view piece) { hash.add(piece); });
    return hash.digest();
}

FileDigest digest_of_pieces(
    const std::function<void(const std::function<void(std::string_view)>& add)>& give) {
    Sha256 hash;
    give([&hash](std::string_view piece) { hash.add(piece); });
    return hash.digest();
}

FileDigest digest_file(const std::filesystem::path& path) {
    Sha256 hash;
    read_pieces(path, [&hash](std::string_view piece) { hash.add(piece); });
    return hash.digest();
}

}  // namespace runcert
