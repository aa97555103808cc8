#pragma once

#include <gtest/gtest.h>

#include <string>

#include "schemas/attempt/attempt.h"
#include "store_test_support.h"

namespace runcert::rule_input_test {

using test::failure_of;
using test::replaced;
using test::Said;

/// The least that an attempt says, then `more`.
inline std::string with(const std::string& more) {
    return R"(schema: attempt/1.0
id: a
craft: {name: b, class: board}
receivers:
  - {id: primary, recording: r.csv}
profiles: [nalsa, rules/my-rule.yaml]
)" + more;
}

inline Attempt read(const std::string& more) {
    return read_attempt(with(more), "f");
}

inline Said refused(const std::string& more) {
    return failure_of([&] { read(more); });
}

/// Every case is refused at its place, with these words.
struct Case {
    std::string more, where, said;
};

template <std::size_t count>
void expect_refused(const Case (&cases)[count]) {
    for (const Case& c : cases) {
        const Said said = refused(c.more);
        EXPECT_EQ(said.where, c.where) << c.more << "\n" << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.more << "\n" << said.problem << ". " << said.remedy;
    }
}

/// A course, its lines' ends in the order of the text.
inline std::string course_of(const std::string& start_left, const std::string& rest = "") {
    return "course:\n  length_m: 502.25\n  length_expanded_uncertainty_m: 0.02\n  start: {left: " +
           start_left +
           ", right: {east_m: 10, north_m: 0}}\n  finish: {left: {east_m: -10, north_m: 500}, "
           "right: {east_m: 10, north_m: 500.5}}\n" +
           rest;
}

}  // namespace runcert::rule_input_test
