#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <string>

#include "core/failure.h"
#include "store/folder_lock.h"
#include "store/process.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Makes flock fail in this process with an error number, as file systems without locks do.
void refuse_flock(int error) {
    std::array<sock_filter, 4> program{{
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_flock, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<unsigned>(error)),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    }};
    const sock_fprog filter{program.size(), program.data()};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) != 0)
        _exit(9);
}

TEST(FolderLockFailure, AFileSystemWithoutLocksHasARemedy) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "day";
    for (const int error : {ENOLCK, EOPNOTSUPP, ENOSYS}) {
        const pid_t process = fork();
        if (process == 0) {
            refuse_flock(error);
            try {
                FolderLock::try_lock(Folder(file.parent_path()), file.filename().string(),
                                     LockKind::exclusive);
            } catch (const Failure& failure) {
                _exit(failure.where() == file.string() &&
                              failure.problem().find("has no locks") != std::string::npos &&
                              failure.remedy().find("local disk") != std::string::npos
                          ? 0
                          : 1);
            }
            _exit(2);
        }
        int status = 0;
        waitpid(process, &status, 0);
        EXPECT_EQ(WEXITSTATUS(status), 0) << error;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
