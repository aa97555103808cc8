#include "store/folder_lock.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <thread>
#include <vector>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

// A line of the file is one of these two words, of one length, and the words of Attempt::holder.
constexpr std::string_view held = "held by ";
constexpr std::string_view free_again = "free of ";
constexpr std::size_t longest_text = 65536;
constexpr std::chrono::milliseconds poll_interval{200};

// A program that a killed process was just starting has its lock until it has begun or ended.
constexpr std::chrono::seconds longest_inheritance{1};
constexpr std::chrono::milliseconds inheritance_interval{5};

std::string host_name() {
    std::array<char, 256> name{};
    gethostname(name.data(), name.size() - 1);
    return escape_for_message(name.data(), 64);
}

std::string this_process() {
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    return fmt::format("process {} on {}, since {:%Y-%m-%d %H:%M:%S} UTC", getpid(), host_name(),
                       now);
}

/// The end of the file's text, whatever is in it.
std::string text_of(int file) {
    struct stat facts {};
    if (fstat(file, &facts) != 0) return {};
    const off_t size = facts.st_size;
    const off_t limit = static_cast<off_t>(longest_text);
    std::string text(longest_text, '\0');
    const ssize_t count = pread(file, text.data(), text.size(), size > limit ? size - limit : 0);
    text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return text;
}

/// Who wrote that they hold the lock and not that they released it, the last first.
std::vector<std::string> entries(const std::string& text) {
    std::vector<std::string> list;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::string_view line(text.data() + begin, end - begin);
        if (line.starts_with(held))
            list.insert(list.begin(), escape_for_message(line.substr(held.size()), 160));
        begin = end + 1;
    }
    return list;
}

/// Whether an entry is of a process of this computer that is there no more.
bool has_died(const std::string& entry) {
    constexpr std::string_view word = "process ";
    const std::size_t number_end = entry.find(' ', word.size());
    if (!entry.starts_with(word) || number_end == std::string::npos) return false;
    if (!entry.substr(number_end).starts_with(" on " + host_name() + ", ")) return false;
    const auto process = parse_integer(entry.substr(word.size(), number_end - word.size()));
    return process && *process > 0 && kill(static_cast<pid_t>(*process), 0) != 0 && errno == ESRCH;
}

std::string holder_in(const std::string& text) {
    std::vector<std::string> alive;
    for (const std::string& entry : entries(text))
        if (!has_died(entry)) alive.push_back(entry);
    if (alive.empty()) return "another process";
    if (alive.size() == 1) return alive.front();
    return fmt::format("{} and {} more", alive.front(), alive.size() - 1);
}

/// Whether all who wrote that they hold the lock have died.
bool have_died(const std::string& text) {
    const std::vector<std::string> list = entries(text);
    return !list.empty() && std::ranges::all_of(list, has_died);
}

[[noreturn]] void refuse(const std::string& path, int error) {
    const bool no_locks = error == ENOLCK || error == ENOTSUP || error == EOPNOTSUPP ||
                          error == ENOSYS || error == EINVAL;
    if (no_locks)
        throw Failure(path,
                      fmt::format("its file system has no locks ({}), so that two programs could "
                                  "write there at once",
                                  std::strerror(error)),
                      "Name a folder on a local disk, or have the network folder mounted with "
                      "locks (NFS version 4; NFS 3 with its lock daemon; CIFS without nobrl)");
    const bool full = error == ENOSPC || error == EDQUOT;
    throw Failure(path, fmt::format("the lock cannot be taken: {}", std::strerror(error)),
                  full ? "Free some space there, or choose another place"
                       : "Check that the folder is there and that you may write in it");
}

FileDescriptor open_lock_file(const Folder& folder, const std::string& name) {
    if (folder.kind_of(name) == EntryKind::link)
        throw Failure((folder.path() / name).string(),
                      "this is a symbolic link, and nothing is locked through one",
                      "Remove the link");
    FileDescriptor file(openat(folder.number(), name.c_str(),
                               O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666));
    if (!file.is_open()) refuse((folder.path() / name).string(), errno);
    return file;
}

}  // namespace

FolderLock::Attempt FolderLock::try_lock(const Folder& folder, const std::string& name,
                                         LockKind kind) {
    const int operation = kind == LockKind::exclusive ? LOCK_EX : LOCK_SH;
    const auto last_try = std::chrono::steady_clock::now() + longest_inheritance;
    while (true) {
        FolderLock lock(open_lock_file(folder, name));
        const int number = lock.file_.number();
        if (flock(number, operation | LOCK_NB) != 0) {
            const int error = errno;
            if (error == EINTR) continue;
            if (error != EWOULDBLOCK) refuse((folder.path() / name).string(), error);
            const std::string text = text_of(number);
            if (!have_died(text) || std::chrono::steady_clock::now() > last_try)
                return {.lock = {}, .holder = holder_in(text)};
            std::this_thread::sleep_for(inheritance_interval);
            continue;
        }
        // Whoever held it may have removed the file meanwhile.
        if (!folder.has(number, name)) continue;
        lock.sign(kind);
        return {.lock = std::move(lock), .holder = {}};
    }
}

std::optional<FolderLock> FolderLock::wait_lock(
    const Folder& folder, const std::string& name, LockKind kind, const std::stop_token& stop,
    const std::function<void(const std::string& holder)>& waits) {
    std::mutex mutex;
    std::condition_variable_any wakes;
    for (bool reported = false; !stop.stop_requested(); reported = true) {
        Attempt attempt = try_lock(folder, name, kind);
        if (attempt.lock) return std::move(attempt.lock);
        if (!reported && waits) waits(attempt.holder);
        // A wait for the lock itself could not be stopped.
        std::unique_lock guard(mutex);
        wakes.wait_for(guard, stop, poll_interval, [] { return false; });
    }
    return std::nullopt;
}

/// Writes who holds the lock. That it cannot be written, on a full disk, is no reason not to hold
/// it: the text is for people.
void FolderLock::sign(LockKind kind) {
    if (kind == LockKind::exclusive) {
        const std::vector<std::string> before = entries(text_of(file_.number()));
        if (!before.empty()) left_by_ = before.front();
        if (ftruncate(file_.number(), 0) != 0) return;
    }
    const std::string line = std::string(held) + this_process() + "\n";
    // The file is open for appending, which is one step: those who share do not overwrite each
    // other.
    const ssize_t written = ::write(file_.number(), line.data(), line.size());
    if (written == static_cast<ssize_t>(line.size()))
        entry_ = lseek(file_.number(), 0, SEEK_CUR) - static_cast<long>(line.size());
}

FolderLock::~FolderLock() {
    if (!file_.is_open()) return;
    if (entry_ >= 0 && fcntl(file_.number(), F_SETFL, 0) == 0) {
        [[maybe_unused]] const ssize_t written =
            pwrite(file_.number(), free_again.data(), free_again.size(), entry_);
    }
    // Closing alone would wait for a program that another thread is just starting.
    flock(file_.number(), LOCK_UN);
}

}  // namespace runcert
