#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "guardian.h"

namespace {

std::string name_of(const testing::TestInfo& test) {
    return std::string(test.test_suite_name()) + "." + test.name();
}

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

/// Adds to the file RUNCERT_SKIPPED a line for each test that is skipped, with its reason.
class Skipped : public testing::EmptyTestEventListener {
    void OnTestPartResult(const testing::TestPartResult& result) override {
        if (result.skipped()) reason_ = result.message();
    }
    void OnTestEnd(const testing::TestInfo& test) override {
        const std::string reason = std::exchange(reason_, {});
        const char* file = std::getenv("RUNCERT_SKIPPED");
        if (reason.empty() || file == nullptr) return;
        if (std::FILE* out = std::fopen(file, "a")) {
            std::fprintf(out, "%s: %s\n", name_of(test).c_str(), reason.c_str());
            std::fclose(out);
        }
    }

    std::string reason_;
};

/// Programs keep their user's state, as the secret of a batch's records, in a folder of this
/// process's own, and not in that of who runs the tests.
class OwnState : public testing::Environment {
    void SetUp() override {
        std::string name =
            (std::filesystem::temp_directory_path() / "runcert-test-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
        ASSERT_EQ(setenv("XDG_STATE_HOME", name.c_str(), 1), 0);
    }
    void TearDown() override {
        std::error_code ignored;
        if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
    }
    std::filesystem::path folder_;
};

}  // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    if (GTEST_FLAG_GET(list_tests)) return RUN_ALL_TESTS();
    return runcert::test::guarded([] {
        testing::AddGlobalTestEnvironment(new OwnState);
        auto& listeners = testing::UnitTest::GetInstance()->listeners();
        listeners.Append(new FailedSetUp);
        listeners.Append(new Skipped);
        return RUN_ALL_TESTS();
    });
}
