#include <gtest/gtest.h>

#include <string>

#include "schemas/common/members.h"
#include "store_test_support.h"

namespace runcert {
namespace {

using test::failure_of;

enum class Colour { red, blue };
std::string_view to_text(Colour colour) {
    return colour == Colour::red ? "red" : "blue";
}
bool from_text(std::string_view text, Colour& colour) {
    colour = text == "blue" ? Colour::blue : Colour::red;
    return text == "red" || text == "blue";
}
struct Painted {
    Colour colour = Colour::red;
    std::optional<Colour> other;
};

struct Inner {
    double value = 0.0;
    std::optional<double> maybe;
};
struct Outer {
    std::string text;
    std::int64_t count = 7;
    bool yes = false;
    std::optional<Inner> inner;
    std::vector<Inner> list;
};

}  // namespace

// As the build writes them of a declaration.
template <>
nlohmann::ordered_json members_json(const Painted& value) {
    nlohmann::ordered_json map = nlohmann::ordered_json::object();
    member::write(map, "colour", value.colour);
    member::write(map, "other", value.other);
    return map;
}
template <>
Painted read_members(const YamlValue& map) {
    Painted value;
    member::take(map, "colour", value.colour);
    member::take(map, "other", value.other);
    return value;
}
template <>
nlohmann::ordered_json members_json(const Inner& value) {
    nlohmann::ordered_json map = nlohmann::ordered_json::object();
    member::write(map, "value_m", value.value);
    member::write(map, "maybe", value.maybe);
    return map;
}
template <>
Inner read_members(const YamlValue& map) {
    Inner value;
    member::take(map, "value_m", value.value);
    member::take(map, "maybe", value.maybe);
    return value;
}
template <>
nlohmann::ordered_json members_json(const Outer& value) {
    nlohmann::ordered_json map = nlohmann::ordered_json::object();
    member::write(map, "text", value.text);
    member::write(map, "count", value.count);
    member::write(map, "yes", value.yes);
    member::write(map, "inner", value.inner);
    member::write(map, "list", value.list);
    return map;
}
template <>
Outer read_members(const YamlValue& map) {
    Outer value;
    member::take(map, "text", value.text);
    member::take(map, "count", value.count);
    member::take(map, "yes", value.yes);
    member::take(map, "inner", value.inner);
    member::take(map, "list", value.list);
    return value;
}

namespace {

TEST(Members, RoundTripAndLeaveOutWhatIsUntoldOrInfinite) {
    const Outer full{.text = "t",
                     .count = 3,
                     .yes = true,
                     .inner = Inner{1.5, 2.5},
                     .list = {{1.0, std::numeric_limits<double>::infinity()}, {2.0, std::nullopt}}};
    const nlohmann::ordered_json json = members_json(full);
    EXPECT_EQ(json.dump(),
              R"({"text":"t","count":3,"yes":true,"inner":{"value_m":1.5,"maybe":2.5},)"
              R"("list":[{"value_m":1.0},{"value_m":2.0}]})");
    const Outer back = read_members<Outer>({parse_yaml(json.dump(), "f"), "f"});
    EXPECT_EQ(members_json(back), json);
    EXPECT_EQ(members_json(Outer{}).dump(), R"({"count":7,"yes":false,"list":[]})");
    const Outer none = read_members<Outer>({parse_yaml("{}", "f"), "f"});
    EXPECT_EQ(none.count, 7);
    EXPECT_FALSE(none.inner);
    const auto wrong = failure_of([] {
        read_members<Outer>({parse_yaml("count: many\n", "f"), "f"});
    });
    EXPECT_EQ(wrong.where, "f:1:8");
}

TEST(Members, AnEnumerationStandsAsItsWord) {
    EXPECT_EQ(members_json(Painted{Colour::blue, Colour::red}).dump(),
              R"({"colour":"blue","other":"red"})");
    EXPECT_EQ(members_json(Painted{}).dump(), R"({"colour":"red"})");
    const auto read = [](const std::string& text) {
        return read_members<Painted>({parse_yaml(text, "f"), "f"});
    };
    EXPECT_EQ(read("colour: blue\n").colour, Colour::blue);
    EXPECT_FALSE(read("colour: blue\n").other);
    EXPECT_EQ(read("other: blue\n").other, Colour::blue);
    const auto wrong = failure_of([&] { read("colour: \"gre\\nen\"\n"); });
    EXPECT_EQ(wrong.where, "f:1:9");
    EXPECT_TRUE(wrong.contains("\"gre\\x0aen\" is not one of the known words")) << wrong.problem;
}

}  // namespace
}  // namespace runcert
