#include "store/record_key.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <optional>

#include "core/failure.h"
#include "store/atomic_file.h"
#include "store/folder.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* key_file = "records.key";

void start_sodium() {
    if (sodium_init() < 0)
        throw Failure("libsodium", "the library could not be started",
                      "Install it again (Debian: libsodium23)");
}

std::optional<fs::path> absolute_folder(const char* text) {
    // By the XDG base directory specification a relative one counts as none.
    if (text == nullptr || !fs::path(text).is_absolute()) return std::nullopt;
    return fs::path(text);
}

std::optional<fs::path> home() {
    if (auto named = absolute_folder(std::getenv("HOME"))) return named;
    const passwd* user = getpwuid(getuid());
    return user == nullptr ? std::nullopt : absolute_folder(user->pw_dir);
}

std::string hexadecimal(const RecordKey::Bytes& bytes) {
    std::string text(2 * bytes.size() + 1, '\0');
    sodium_bin2hex(text.data(), text.size(), bytes.data(), bytes.size());
    text.pop_back();
    return text;
}

[[noreturn]] void refuse_key(const fs::path& path, const std::string& problem) {
    throw Failure(path.string(), problem,
                  "Remove the file: a new secret is made, and every run is recomputed once");
}

RecordKey read_key(const fs::path& path) {
    const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    struct stat status {};
    if (!file.is_open() || fstat(file.number(), &status) != 0)
        refuse_key(path,
                   std::string("the secret of records cannot be read: ") + std::strerror(errno));
    if (!S_ISREG(status.st_mode) || status.st_uid != geteuid() ||
        (status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
        refuse_key(path, "others than its owner can use the secret of records");
    std::array<char, 2 * RecordKey::size + 2> text{};
    const ssize_t length = read(file.number(), text.data(), text.size());
    RecordKey::Bytes bytes{};
    std::size_t read_bytes = 0;
    const bool whole = length == 2 * static_cast<ssize_t>(RecordKey::size) + 1 &&
                       text[2 * RecordKey::size] == '\n' &&
                       sodium_hex2bin(bytes.data(), bytes.size(), text.data(), 2 * bytes.size(),
                                      nullptr, &read_bytes, nullptr) == 0 &&
                       read_bytes == bytes.size();
    sodium_memzero(text.data(), text.size());
    if (!whole) refuse_key(path, "the secret of records is not as it was written");
    return RecordKey(bytes);
}

/// Writes a file for its owner alone. Not as others are written: their names need this very secret.
void write_draft(const fs::path& draft, const std::string& text) {
    FileDescriptor file(open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
    if (!file.is_open()) fail_of_system(draft, "cannot create a file in this folder", errno);
    if (write(file.number(), text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
        fsync(file.number()) != 0 || file.close() != 0)
        fail_of_system(draft, "cannot write this file", errno);
}

/// Writes a new secret under another name and links it to its own: the first of several that do so
/// at once has made it.
void make_key(const fs::path& path) {
    RecordKey::Bytes bytes{};
    randombytes_buf(bytes.data(), bytes.size());
    const fs::path draft =
        fmt::format("{}.{}.{:08x}", path.string(), getpid(), randombytes_random());
    write_draft(draft, hexadecimal(bytes) + "\n");
    const int linked = link(draft.c_str(), path.c_str());
    const int error = errno;
    std::error_code ignored;
    if (linked != 0 && error != EEXIST && error != EPERM && error != EOPNOTSUPP) {
        fs::remove(draft, ignored);
        throw Failure(
            path.string(),
            std::string("the secret of records could not be made: ") + std::strerror(error),
            "Check that the folder can be written and has space");
    }
    // A file system without links has one writer at a time: the name is taken if it is free.
    if (linked != 0 && error != EEXIST && !fs::exists(path)) fs::rename(draft, path, ignored);
    fs::remove(draft, ignored);
}

constexpr std::string_view begin = ".runcert-";

/// The kept one from when there is one; before that one of this process.
RecordKey own_key() {
    static std::mutex turn;
    static const RecordKey passing;
    static std::optional<RecordKey> kept;
    const std::lock_guard<std::mutex> lock(turn);
    if (!kept) kept = kept_record_key();
    return kept.value_or(passing);
}

std::string seal_of(const Folder& folder, std::string_view stem) {
    constexpr std::size_t digits = 16;
    return own_seal(fmt::format("name {} in {}", stem, identity_of(folder))).substr(0, digits);
}

}  // namespace

RecordKey::RecordKey() {
    start_sodium();
    randombytes_buf(bytes_.data(), bytes_.size());
}

std::string RecordKey::seal(std::string_view text) const {
    start_sodium();
    Bytes hash{};
    crypto_generichash(hash.data(), hash.size(),
                       reinterpret_cast<const unsigned char*>(text.data()), text.size(),
                       bytes_.data(), bytes_.size());
    return hexadecimal(hash);
}

bool RecordKey::sealed(std::string_view text, std::string_view seal) const {
    const std::string own = this->seal(text);
    return seal.size() == own.size() && sodium_memcmp(own.data(), seal.data(), own.size()) == 0;
}

std::optional<fs::path> state_folder() {
    if (auto named = absolute_folder(std::getenv("XDG_STATE_HOME"))) return *named / "runcert";
    if (auto own = home()) return *own / ".local/state/runcert";
    return std::nullopt;
}

std::optional<RecordKey> kept_record_key() {
    const auto folder = state_folder();
    std::error_code ignored;
    if (!folder || !fs::exists(*folder / key_file, ignored)) return std::nullopt;
    try {
        return read_key(*folder / key_file);
    } catch (const Failure&) {
        return std::nullopt;
    }
}

KeptRecordKey record_key_in(const std::optional<fs::path>& folder) {
    constexpr const char* again = "the next call recomputes every run";
    if (!folder)
        return {.passing = fmt::format("This user has no folder to keep the secret of records in: "
                                       "{}.",
                                       again)};
    start_sodium();
    const fs::path path = *folder / key_file;
    std::error_code ignored;
    if (!fs::exists(fs::symlink_status(path, ignored))) {
        try {
            make_directory(*folder);
            make_key(path);
        } catch (const Failure& failure) {
            return {.passing = fmt::format("The secret of records cannot be kept in {}: {}.",
                                           folder->string(), again)};
        }
    }
    return {.key = read_key(path)};
}

std::string identity_of(const Folder& folder) {
    struct statx facts {};
    if (statx(folder.number(), "", AT_EMPTY_PATH, STATX_INO | STATX_BTIME, &facts) != 0) return {};
    const bool has_birth = (facts.stx_mask & STATX_BTIME) != 0;
    return fmt::format("{}, {}.{}", facts.stx_ino, has_birth ? facts.stx_btime.tv_sec : 0,
                       has_birth ? facts.stx_btime.tv_nsec : 0);
}

std::string own_name(const Folder& folder, std::string_view what) {
    static std::atomic<unsigned> counter{0};
    const std::string stem =
        fmt::format("{}{}{}{}-{}", begin, what, what.empty() ? "" : "-", getpid(), counter++);
    return fmt::format("{}-{}", stem, seal_of(folder, stem));
}

bool is_own_name(const Folder& folder, std::string_view name) {
    if (!name.starts_with(begin)) return false;
    name = name.substr(0, name.find('.', begin.size()));
    const std::size_t dash = name.rfind('-');
    return dash >= begin.size() && name.substr(dash + 1) == seal_of(folder, name.substr(0, dash));
}

std::string own_seal(std::string_view text) {
    return own_key().seal(text);
}

bool is_own_seal(std::string_view text, std::string_view seal) {
    return own_key().sealed(text, seal);
}

void keep_own_names() {
    try {
        (void)record_key_in(state_folder());
    } catch (const Failure&) {
        // A secret that others can use is none; batch says so.
    }
}

}  // namespace runcert
