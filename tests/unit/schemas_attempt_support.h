#pragma once

#include <gtest/gtest.h>

#include <span>
#include <string>

#include "schemas/attempt/attempt.h"
#include "store_test_support.h"

namespace runcert::test {

/// A change of an attempt's text that makes it wrong: where the fault must be named, and how.
struct BadAttempt {
    std::string from, to, where, said;
};

inline void expect_named(const std::string& good, std::span<const BadAttempt> cases) {
    for (const BadAttempt& c : cases) {
        const auto said = failure_of([&] { read_attempt(replaced(good, c.from, c.to), "f"); });
        EXPECT_EQ(said.where, c.where) << c.to << "\n" << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.to << "\n" << said.problem << ". " << said.remedy;
    }
}

}  // namespace runcert::test
