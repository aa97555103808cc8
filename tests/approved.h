#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

/// Whether two texts are equal but for figures with decimals that differ by one in the last digit
/// shown: another compiler may round so.
inline bool equal_but_for_rounding(const std::string& a, const std::string& b) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto figure_at = [&](const std::string& text, std::size_t at) {
        std::size_t end = at;
        while (end < text.size() && (is_digit(text[end]) || text[end] == '.'))
            ++end;
        return text.substr(at, end - at);
    };
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < a.size() && j < b.size()) {
        if (!is_digit(a[i]) || !is_digit(b[j])) {
            if (a[i++] != b[j++]) return false;
            continue;
        }
        const std::string x = figure_at(a, i);
        const std::string y = figure_at(b, j);
        const std::size_t point = x.find('.');
        const bool same_form = point != std::string::npos && y.find('.') != std::string::npos &&
                               x.size() - point == y.size() - y.find('.');
        if (x != y &&
            (!same_form || std::abs(std::stod(x) - std::stod(y)) >
                               1.5 * std::pow(10.0, -static_cast<double>(x.size() - point - 1))))
            return false;
        i += x.size();
        j += y.size();
    }
    return i == a.size() && j == b.size();
}

inline void expect_approved(const std::string& name, const std::string& text) {
    const std::filesystem::path file =
        std::filesystem::path(RUNCERT_SOURCE_DIR) / "tests" / "approved" / name;
    if (std::getenv("RUNCERT_APPROVE") != nullptr &&
        !equal_but_for_rounding(text, text_of_file(file))) {
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << text;
    }
    const std::string approved = text_of_file(file);
    EXPECT_TRUE(equal_but_for_rounding(text, approved))
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
