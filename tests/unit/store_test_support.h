#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "core/failure.h"
#include "store/process.h"

namespace runcert::test {

/// What a Failure says; all empty where there was none.
struct Said {
    std::string where{};
    std::string problem{};
    std::string remedy{};

    bool contains(std::string_view part) const {
        return (where + ": " + problem + ". " + remedy).find(part) != std::string::npos;
    }
};

/// Any other exception passes through, and fails the test.
template <class Call>
Said failure_of(const Call& call) {
    try {
        call();
    } catch (const Failure& failure) {
        EXPECT_FALSE(failure.where().empty());
        EXPECT_FALSE(failure.problem().empty());
        EXPECT_FALSE(failure.remedy().empty());
        return {failure.where(), failure.problem(), failure.remedy()};
    }
    return {};
}

inline std::string slurp(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    EXPECT_TRUE(in.good()) << path;
    return {std::istreambuf_iterator<char>(in), {}};
}

inline void spill(const std::filesystem::path& path, std::string_view text) {
    std::ofstream out(path, std::ios::binary);
    out << text;
    EXPECT_TRUE(out.good()) << path;
}

/// `text` with the one occurrence of `from` replaced.
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    return text;
}

/// Debian's Python, which has Debian's astropy and PyYAML.
inline bool python_has(const std::string& module) {
    try {
        return run_process({"/usr/bin/python3", "-c", "import " + module}).exit_status == 0;
    } catch (const Failure&) {
        return false;
    }
}

/// What a script prints, with `files` as its arguments. The test fails where the script does.
inline std::string python(const std::string& script, const std::vector<std::string>& files) {
    std::vector<std::string> command{"/usr/bin/python3", "-W", "error", "-c", script};
    command.insert(command.end(), files.begin(), files.end());
    const ProcessResult result =
        run_process(command, {.environment = {{"PYTHONIOENCODING", "utf-8"}}});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    return result.output;
}

}  // namespace runcert::test
