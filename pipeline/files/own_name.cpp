#include "files/own_name.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <mutex>
#include <optional>

#include "core/failure.h"
#include "files/folder.h"
#include "files/record_key.h"

namespace runcert {
namespace {

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
