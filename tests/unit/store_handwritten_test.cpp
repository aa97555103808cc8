#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/failure.h"
#include "store/atomic_file.h"
#include "store/process.h"

namespace runcert::RUNCERT_FILE {
namespace {

// An attempt of 1 GiB was read into memory whole before anyone looked at it.
TEST(HandwrittenText, LongerThanAnyIsRefusedUnread) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "attempt.yaml";
    std::ofstream(file) << "a";
    std::filesystem::resize_file(file, longest_handwritten);
    EXPECT_EQ(read_handwritten(file).size(), longest_handwritten);
    std::filesystem::resize_file(file, longest_handwritten + 1);
    EXPECT_THROW((void)read_handwritten(file), Failure);
    std::filesystem::resize_file(file, std::uintmax_t{1} << 40);
    EXPECT_THROW((void)read_handwritten(file), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
