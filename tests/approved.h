#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

// What people read is held by files that a person has read and approved, tests/approved/NAME. Where
// a text changes on purpose: RUNCERT_APPROVE=1 writes the files anew, and `git diff` shows what
// there is to approve.

namespace runcert::test {

inline std::string text_of_file(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Where two texts first differ, as their lines.
inline std::string first_difference(const std::string& made, const std::string& approved) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < std::min(made.size(), approved.size()) && made[i] == approved[i];
         ++i)
        if (made[i] == '\n') begin = i + 1;
    const auto line = [begin](const std::string& text) {
        return begin < text.size() ? text.substr(begin, text.find('\n', begin) - begin)
                                   : std::string("(its end)");
    };
    return "made:     " + line(made) + "\napproved: " + line(approved);
}

inline void expect_approved(const std::string& name, const std::string& text) {
    const std::filesystem::path file =
        std::filesystem::path(RUNCERT_SOURCE_DIR) / "tests" / "approved" / name;
    if (std::getenv("RUNCERT_APPROVE") != nullptr) {
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << text;
    }
    const std::string approved = text_of_file(file);
    EXPECT_TRUE(text == approved)
        << name << " is not as approved:\n"
        << first_difference(text, approved)
        << "\nIf that is on purpose: RUNCERT_APPROVE=1, then read git diff tests/approved";
}

/// Several texts in one file, each under a title.
class ApprovedTexts {
  public:
    explicit ApprovedTexts(std::string name) : name_(std::move(name)) {}
    ApprovedTexts(const ApprovedTexts&) = delete;
    ApprovedTexts& operator=(const ApprovedTexts&) = delete;
    ~ApprovedTexts() { expect_approved(name_, all_); }

    void add(const std::string& title, const std::string& text) {
        all_ += "==== " + title + "\n" + text + (text.ends_with('\n') ? "\n" : "\n\n");
    }

  private:
    std::string name_;
    std::string all_;
};

}  // namespace runcert::test
