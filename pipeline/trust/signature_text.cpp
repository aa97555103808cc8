#include "trust/signature_text.h"

#include <sodium.h>

#include <stdexcept>

#include "core/failure.h"
#include "files/base64.h"

namespace runcert::signature_text {

void start_libsodium() {
    // A negative status means that the system has no random source.
    if (sodium_init() < 0)
        throw Failure("libsodium", "cannot start the cryptographic library",
                      "Check that the system has a random source (/dev/urandom)");
}

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        std::string_view line = text.substr(0, end);
        if (line.ends_with('\r')) line.remove_suffix(1);
        lines.push_back(line);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    while (!lines.empty() && lines.back().empty())
        lines.pop_back();
    return lines;
}

std::string base64_of(const unsigned char* bytes, std::size_t count) {
    return base64({reinterpret_cast<const char*>(bytes), count});
}

std::string bytes_of_base64(std::string_view line, std::size_t count, const std::string& what,
                            const std::string& where) {
    const std::string remedy = "Use the file as it was made, whole and unchanged";
    std::string bytes(line.size(), '\0');
    std::size_t decoded = 0;
    const char* end = nullptr;
    if (sodium_base642bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), line.data(),
                          line.size(), nullptr, &decoded, &end,
                          sodium_base64_VARIANT_ORIGINAL) != 0 ||
        end != line.data() + line.size())
        throw Failure(where, "the line of " + what + " is not base64", remedy);
    if (decoded != count)
        throw Failure(where,
                      "the line of " + what + " holds " + std::to_string(decoded) +
                          " bytes where " + std::to_string(count) + " are expected",
                      remedy);
    bytes.resize(decoded);
    return bytes;
}

}  // namespace runcert::signature_text
