#include <gtest/gtest.h>

#include <string>

#include "schemas/common/document.h"
#include "schemas/common/members.h"
#include "schemas/common/revision.h"
#include "store_test_support.h"

namespace runcert {
namespace {

using test::failure_of;

/// A table of revision 1.2, with fields of all three revisions.
const DocumentSchema& sample() {
    static const DocumentSchema schema = DocumentSchema::parse(
        "schema: sample\nversion: \"1.2\"\nfields:\n"
        "  schema: {type: text, required: true, description: s}\n"
        "  first: {type: integer, required: true, description: f}\n"
        "  map: {type: map, since: \"1.1\", description: m}\n"
        "  map.inside: {type: real, required: true, description: i}\n"
        "  map.later: {type: text, since: \"1.2\", description: l}\n"
        "  list: {type: list, description: l}\n"
        "  list[]: {type: map, description: i}\n"
        "  list[].old: {type: text, description: o}\n"
        "  list[].new: {type: text, required: true, since: \"1.1\", description: n}\n"
        "  needed: {type: boolean, required: true, since: \"1.2\", description: n}\n",
        "sample");
    return schema;
}

TEST(Since, IsAFieldsOwnRevisionOrThatOfWhatItStandsIn) {
    EXPECT_EQ(since_of(sample(), "first"), 0);
    EXPECT_EQ(since_of(sample(), "map"), 1);
    EXPECT_EQ(since_of(sample(), "map.inside"), 1);
    EXPECT_EQ(since_of(sample(), "map.later"), 2);
    EXPECT_EQ(since_of(sample(), "list[].old"), 0);
    EXPECT_EQ(since_of(sample(), "list[].new"), 1);
}

TEST(Since, AFaultInTheTableIsNamed) {
    const auto since = [](const std::string& text) {
        const YamlValue entry(parse_yaml("since: " + text + "\n", "t"), "t");
        return read_since(entry, {.model = 1, .revision = 1});
    };
    EXPECT_EQ(since("\"1.1\""), 1);
    EXPECT_EQ(since("\"1.0\""), 0);
    for (const char* text : {"\"1.2\"", "\"2.0\"", "\"0.9\"", "\"1\"", "later"})
        EXPECT_TRUE(failure_of([&] { since(text); }).contains("no revision of this field table"))
            << text;
}

/// What validating a document of that revision says; empty where it is valid.
std::string said(const std::string& text, std::int64_t revision) {
    const auto failure = failure_of([&] {
        validate_revision({parse_yaml(text, "f"), "f"}, sample(), revision);
    });
    return failure.where.empty() ? "" : failure.where + ": " + failure.problem;
}

TEST(ValidateRevision, TakesADocumentByTheTableOfItsRevision) {
    const std::string first = "schema: s\nfirst: 1\nlist: [{old: a}]\n";
    EXPECT_EQ(said(first, 0), "");
    EXPECT_EQ(said(first, 1).find("f:3:8: list[0]: the key \"new\" is missing"), 0U);
    const std::string second = "schema: s\nfirst: 1\nmap: {inside: 2}\nlist: [{new: a}]\n";
    EXPECT_EQ(said(second, 1), "");
    EXPECT_EQ(said(second, 2).find("f:1:1: the key \"needed\" is missing"), 0U) << said(second, 2);
    EXPECT_EQ(said(second + "needed: true\n", 2), "");
    EXPECT_EQ(said(second + "needed: true\nmore: 1\n", 3), "");
    // Within its revision a field is as strict as ever.
    EXPECT_EQ(said("schema: s\nfirst: 1\nmap: {}\n", 1).find("f:3:6: map: the key \"inside\""), 0U);
    EXPECT_NE(said("schema: s\nfirst: x\n", 0), "");
    EXPECT_NE(said("schema: s\n", 0).find("the key \"first\" is missing"), std::string::npos);
    EXPECT_NE(said(first + "more: 1\n", 0).find("unknown key \"more\""), std::string::npos);
}

TEST(ValidateRevision, ALaterFieldIsRefusedWithTheRevisionItNeeds) {
    const std::string first = "schema: s\nfirst: 1\n";
    const std::string needs = " the field needs revision 1.";
    EXPECT_EQ(said(first + "map: {inside: 2}\n", 0),
              "f:3:6: map:" + needs + "1 of the schema sample; the file follows sample/1.0");
    EXPECT_EQ(
        said(first + "list: [{old: a}, {new: b}]\n", 0),
        "f:3:24: list[1].new:" + needs + "1 of the schema sample; the file follows sample/1.0");
    EXPECT_EQ(said(first + "map: {inside: 2, later: x}\n", 1),
              "f:3:25: map.later:" + needs + "2 of the schema sample; the file follows sample/1.1");
    EXPECT_NE(said(first + "needed: null\n", 1).find("needed:" + needs + "2"), std::string::npos);
}

TEST(WrittenRevision, KnowsEveryRevisionUpToItsOwn) {
    const auto written = [](const std::string& text) {
        return written_revision({parse_yaml(text, "f"), "f"}, sample());
    };
    EXPECT_EQ(written("schema: sample/1.0\n"), 0);
    EXPECT_EQ(written("schema: sample/1.2\n"), 2);
    for (const char* text :
         {"schema: sample/1.3\n", "schema: sample/2.0\n", "schema: sample/1.02\n",
          "schema: sample\n", "schema: other/1.0\n", "first: 1\n"})
        EXPECT_EQ(written(text), std::nullopt) << text;
    EXPECT_EQ(known_revisions(sample()), "sample/1.0 or sample/1.1 or sample/1.2");
}

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
