// Loaded before the system's library: lets calls of one kind fail from the one of a number on, or
// that one alone. Calls are counted over a program and all programs of the project that it starts.
#include "failing_calls.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

using runcert::chain::FaultState;

FaultState* state = nullptr;

/// Whether this call of that kind is one to fail.
bool fails(char kind) {
    if (state == nullptr) return false;
    const long number = ++state->calls[static_cast<std::size_t>(kind)];
    if (state->kind != kind) return false;
    const bool hit = state->from_then_on ? number >= state->at : number == state->at;
    return state->at > 0 && hit;
}

bool is_file(int number) {
    struct stat status {};
    return ::fstat(number, &status) == 0 && S_ISREG(status.st_mode);
}

long refuse(int error) {
    errno = error;
    return -1;
}

__attribute__((constructor)) void begin() {
    const char* const file = std::getenv(runcert::chain::fault_variable);
    if (file == nullptr || std::strncmp(program_invocation_short_name, "runcert", 7) != 0) return;
    const int number = ::open(file, O_RDWR | O_CLOEXEC);
    if (number < 0) std::abort();
    void* const mapped =
        ::mmap(nullptr, sizeof(FaultState), PROT_READ | PROT_WRITE, MAP_SHARED, number, 0);
    ::close(number);
    if (mapped == MAP_FAILED) std::abort();
    state = static_cast<FaultState*>(mapped);
}

}  // namespace

extern "C" {

ssize_t write(int number, const void* bytes, std::size_t size) {
    if (is_file(number)) {
        if (fails('w')) return refuse(ENOSPC);
        if (size > 1 && fails('h')) size /= 2;
    }
    return ::syscall(SYS_write, number, bytes, size);
}

ssize_t writev(int number, const iovec* pieces, int count) {
    if (is_file(number) && fails('w')) return refuse(ENOSPC);
    return ::syscall(SYS_writev, number, pieces, count);
}

int fsync(int number) {
    return static_cast<int>(fails('s') ? refuse(EIO) : ::syscall(SYS_fsync, number));
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned how) {
    return static_cast<int>(
        fails('r') ? refuse(EIO) : ::syscall(SYS_renameat2, from_folder, from, to_folder, to, how));
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) {
    return renameat2(from_folder, from, to_folder, to, 0);
}

int rename(const char* from, const char* to) {
    return renameat2(AT_FDCWD, from, AT_FDCWD, to, 0);
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int how) {
    return static_cast<int>(
        fails('r') ? refuse(EIO) : ::syscall(SYS_linkat, from_folder, from, to_folder, to, how));
}

int mkdirat(int folder, const char* name, mode_t mode) {
    return static_cast<int>(fails('m') ? refuse(ENOSPC)
                                       : ::syscall(SYS_mkdirat, folder, name, mode));
}

int mkdir(const char* name, mode_t mode) {
    return mkdirat(AT_FDCWD, name, mode);
}

int unlinkat(int folder, const char* name, int how) {
    return static_cast<int>(fails('u') ? refuse(EIO) : ::syscall(SYS_unlinkat, folder, name, how));
}

int unlink(const char* name) {
    return unlinkat(AT_FDCWD, name, 0);
}

void* malloc(std::size_t size) {
    if (!fails('a')) return __libc_malloc(size);
    errno = ENOMEM;
    return nullptr;
}

void* calloc(std::size_t count, std::size_t size) {
    if (!fails('a')) return __libc_calloc(count, size);
    errno = ENOMEM;
    return nullptr;
}

void* realloc(void* old, std::size_t size) {
    if (!fails('a')) return __libc_realloc(old, size);
    errno = ENOMEM;
    return nullptr;
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
    if (!fails('a')) return __libc_memalign(alignment, size);
    errno = ENOMEM;
    return nullptr;
}
}
