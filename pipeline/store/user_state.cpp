#include "store/user_state.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <system_error>

#include "core/failure.h"
#include "store/atomic_file.h"
#include "store/folder.h"
#include "store/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view begin = ".runcert-";

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

/// Whether it is a folder in which nobody but this user can write. Links are not followed.
bool is_ours_alone(const fs::path& folder) {
    struct stat facts {};
    return lstat(folder.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode) &&
           facts.st_uid == geteuid() && (facts.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

std::optional<fs::path> folder_of_memory() {
    const auto state = state_folder();
    if (!state) return std::nullopt;
    return *state / "made";
}

fs::path memory_file(const fs::path& memory, std::string_view of) {
    constexpr std::size_t digits = 32;
    return memory / (sha256_hex(of).substr(0, digits) + ".json");
}

std::string random_text() {
    std::uint64_t random = 0;
    if (getrandom(&random, sizeof random, 0) != sizeof random)
        fail_of_system("/dev/urandom", "cannot draw a random name", errno);
    return fmt::format("{:016x}", random);
}

/// The secret that is kept, or the one given, which is kept then. Not written as other files are:
/// their names need this very secret.
std::string kept_secret(const std::string& fresh) {
    if (!missing_state().empty()) return fresh;
    const std::string file = (*folder_of_memory() / "names").string();
    const FileDescriptor made(open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
    if (made.is_open()) return write(made.number(), fresh.data(), fresh.size()) < 0 ? "" : fresh;
    try {
        const std::string kept = read_file(file);
        return kept.size() == fresh.size() ? kept : fresh;
    } catch (const Failure&) {
        return fresh;
    }
}

std::string proof_of(std::string_view stem) {
    constexpr std::size_t digits = 16;
    static const std::string secret = kept_secret(random_text() + random_text());
    return sha256_hex(fmt::format("{} {}", secret, stem)).substr(0, digits);
}

}  // namespace

std::optional<fs::path> state_folder() {
    if (auto named = absolute_folder(std::getenv("XDG_STATE_HOME"))) return *named / "runcert";
    if (auto own = home()) return *own / ".local/state/runcert";
    return std::nullopt;
}

std::string missing_state() {
    constexpr const char* again = "the next call makes every run again";
    const auto memory = folder_of_memory();
    if (!memory) return fmt::format("This user has no folder to keep in what was made: {}.", again);
    std::error_code error;
    fs::create_directories(memory->parent_path(), error);
    if (!error && mkdir(memory->c_str(), 0700) != 0 && errno != EEXIST)
        error.assign(errno, std::generic_category());
    if (error)
        return fmt::format("What was made cannot be kept in {}: {}; {}.", memory->string(),
                           error.message(), again);
    if (!is_ours_alone(*memory))
        return fmt::format("Others can write in {}, so that nothing there is believed; {}.",
                           memory->string(), again);
    return {};
}

std::string recalled(std::string_view of) {
    const auto memory = folder_of_memory();
    if (!memory || !is_ours_alone(*memory)) return {};
    try {
        return read_file(memory_file(*memory, of));
    } catch (const Failure&) {
        return {};
    }
}

void remember(std::string_view of, std::string_view text) {
    if (!missing_state().empty()) return;
    const fs::path file = memory_file(*folder_of_memory(), of);
    std::error_code ignored;
    try {
        if (text.empty())
            fs::remove(file, ignored);
        else
            write_file_unsynced(file, text);
    } catch (const Failure&) {
        // On a full disk: the next call makes the run again.
    }
}

std::string about_folder(std::string_view what, const fs::path& folder) {
    std::error_code error;
    const fs::path real = fs::weakly_canonical(fs::absolute(folder, error), error);
    return fmt::format("{} {}", what, real.string());
}

std::string own_name() {
    const std::string stem = fmt::format("{}{}-{}", begin, getpid(), random_text());
    return fmt::format("{}-{}", stem, proof_of(stem));
}

bool is_own_name(std::string_view name) {
    if (!name.starts_with(begin)) return false;
    name = name.substr(0, name.find('.', begin.size()));
    const std::size_t dash = name.rfind('-');
    return dash >= begin.size() && name.substr(dash + 1) == proof_of(name.substr(0, dash));
}

std::string remembered_sha256(const fs::path& file) {
    struct stat facts {};
    if (stat(file.c_str(), &facts) != 0) return digest_file(file).sha256;
    const std::string of = "program " + file.string();
    const std::string as_it_is =
        fmt::format("{} {} {} {}.{} ", facts.st_dev, facts.st_ino, facts.st_size,
                    facts.st_ctim.tv_sec, facts.st_ctim.tv_nsec);
    const std::string known = recalled(of);
    if (known.starts_with(as_it_is)) return known.substr(as_it_is.size());
    const std::string sha256 = digest_file(file).sha256;
    remember(of, as_it_is + sha256);
    return sha256;
}

}  // namespace runcert
