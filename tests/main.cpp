#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

namespace {

/// Where the set-up of a suite fails, GoogleTest calls its tests skipped, and CTest then takes them
/// for tests that had nothing to do here. They have failed.
class FailedSetUp : public testing::EmptyTestEventListener {
    void OnTestStart(const testing::TestInfo& test) override {
        const testing::TestSuite* suite = testing::UnitTest::GetInstance()->current_test_suite();
        if (suite == nullptr || !suite->ad_hoc_test_result().Failed()) return;
        std::printf("the set-up of %s failed, so that %s could not be made\n",
                    test.test_suite_name(), test.name());
        std::fflush(stdout);
        std::_Exit(EXIT_FAILURE);
    }
};

}  // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    testing::UnitTest::GetInstance()->listeners().Append(new FailedSetUp);
    return RUN_ALL_TESTS();
}
