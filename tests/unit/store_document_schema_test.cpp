#include <gtest/gtest.h>

#include <string>

#include "store/document_schema.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;

const DocumentSchema& schema() {
    static const DocumentSchema instance = DocumentSchema::parse(R"(
schema: sample
version: "1.3"
fields:
  name: {type: text, required: true, description: "its name"}
  kind: {type: text, values: [land, ice], default: land, description: "what kind"}
  count: {type: integer, min: 1, max: 10, description: "how many"}
  speed: {type: real, unit: m / s, min: 0, max: 1.0e+3, decimals: 2, description: "how fast"}
  flag: {type: boolean, description: "whether"}
  column: {type: text|integer, description: "name or number"}
  frame: {type: text|map, description: "word, or more"}
  frame.utm: {type: map, required: true, description: "grid"}
  frame.utm.zone: {type: integer, min: 1, max: 60, required: true, description: "zone"}
  list: {type: list, description: "some"}
  list[]: {type: map, description: "one"}
  list[].id: {type: text, required: true, description: "its id"}
  list[].words: {type: list, description: "words"}
  list[].words[]: {type: text, values: [a, b], description: "a word"}
  counts: {type: map, description: "by reason"}
  counts.*: {type: integer, min: 0, description: "so many"}
  free: {type: any, description: "anything"}
)",
                                                                 "sample/v1.yaml");
    return instance;
}

test::Said check(const std::string& text) {
    return failure_of([&] { schema().validate({parse_yaml(text, "f"), "f"}); });
}

TEST(DocumentSchema, ReadsItsFieldTable) {
    EXPECT_EQ(schema().name(), "sample");
    EXPECT_EQ(schema().version(), "1.3");
    EXPECT_EQ(schema().fields().size(), 17U);
    const FieldRule& speed = *schema().find("speed");
    EXPECT_EQ(speed.unit, "m / s");
    EXPECT_EQ(speed.minimum, 0.0);
    EXPECT_EQ(speed.maximum, 1000.0);
    EXPECT_EQ(speed.decimals, 2);
    EXPECT_FALSE(speed.required);
    EXPECT_EQ(schema().find("count")->decimals, 6);
    EXPECT_EQ(schema().find("column")->types, (std::vector<std::string>{"text", "integer"}));
    EXPECT_EQ(schema().find("kind")->default_value.text(), "land");
    EXPECT_TRUE(schema().find("name")->required);
    EXPECT_EQ(schema().find("nothing"), nullptr);
    EXPECT_NE(schema().field_table().find("how fast (real, m / s)"), std::string::npos);
}

TEST(DocumentSchema, AFaultInTheFieldTableIsAFailure) {
    for (const char* fields :
         {"a: {description: x}", "a: {type: text}", "a: {type: text, description: x, min: low}",
          "a: {type: text, description: x, required: maybe}", "a: text"}) {
        const std::string text =
            std::string("schema: s\nversion: '1.0'\nfields:\n  ") + fields + "\n";
        const auto said = failure_of([&] { DocumentSchema::parse(text, "s"); });
        EXPECT_EQ(said.where.substr(0, 1), "s") << fields;
        EXPECT_TRUE(said.problem.starts_with("fields.a")) << said.problem;  // the path of the fault
    }
}

TEST(DocumentSchema, AcceptsWhatFollowsIt) {
    for (const char* text :
         {"name: x\n", "name: 5\n", "name: x\nkind: ice\ncount: 10\nspeed: 0\nflag: false\n",
          "name: x\nspeed: 1.0e+3\n", "name: x\ncolumn: 3\n", "name: x\ncolumn: three\n",
          "name: x\nframe: word\n", "name: x\nframe: {utm: {zone: 60}}\n", "name: x\nlist: []\n",
          "name: x\nlist: [{id: a, words: [a, b, a]}]\n", "name: x\nkind: null\nlist:\nframe: ~\n",
          "name: x\ncounts: {gap: 1, '*': 2, a.b: 3}\n", "name: x\nfree: [1, {a: b}, null]\n"})
        EXPECT_EQ(check(text).problem, "") << text;
}

TEST(DocumentSchema, RefusesWhatDoesNot) {
    const struct {
        const char *text, *where, *said;
    } cases[] = {
        {"[a]\n", "f:1:1", "not a map"},
        {"word\n", "f:1:1", "not a map of keys and values"},
        {"kind: ice\n", "f:1:1", "the key \"name\" is missing (its name)"},
        {"name: null\n", "f:1:1", "the key \"name\" is missing"},
        {"name: x\nknd: ice\n", "f:2:1", "unknown key \"knd\". Did you mean \"kind\"?"},
        {"name: x\nspede: 1\n", "f:2:1", "Did you mean \"speed\"?"},
        {"name: x\nKind: ice\n", "f:2:1", "Did you mean \"kind\"?"},
        {"name: x\nlist:\n  - id: a\n    wrods: []\n", "f:4:5",
         "unknown key \"wrods\" in list[]. Did you mean \"words\"? Known keys here: id, words"},
        {"name: x\nframe.utm: {zone: 5}\n", "f:2:1", "unknown key \"frame.utm\""},
        {"name: x\n'list[]': {id: a}\n", "f:2:1", "unknown key \"list[]\""},
        {"name: x\nlist[].id: a\n", "f:2:1", "unknown key \"list[].id\""},
        {"name: x\n'': 1\n", "f:2:1", "unknown key \"\""},
        {"name: x\n\"\\e[1m\": 1\n", "f:2:1", "unknown key \"\\x1b[1m\""},
        {"name: x\nkind: water\n", "f:2:7", "kind: \"water\" is not one of land, ice"},
        {"name: x\ncount: 0\n", "f:2:8", "count: 0 is below 1"},
        {"name: x\ncount: 11\n", "f:2:8", "count: 11 is above 10"},
        {"name: x\ncount: 1.0\n", "f:2:8", "not a whole number"},
        {"name: x\ncount: \"5\"\n", "f:2:8", "not a whole number"},
        {"name: x\nspeed: -0.1\n", "f:2:8", "speed: -0.1 is below 0 m / s"},
        {"name: x\nspeed: fast\n", "f:2:8", "not a number"},
        {"name: x\nspeed: '5'\n", "f:2:8", "not a number"},
        {"name: x\nspeed: 5 m/s\n", "f:2:8", "not a number"},
        {"name: x\nspeed: .inf\n", "f:2:8", "not a number"},
        // A decimal comma, which between braces makes a key of the decimals.
        {"name: x\nspeed: 440,5\n", "f:2:8",
         "speed: \"440,5\" is not a number: it has a decimal comma. Write it with a decimal point: "
         "440.5"},
        {"{name: x, speed: 440,5, kind: ice}\n", "f:1:18",
         "speed: \"440,5\" is not a number: it has a decimal comma. Write it with a decimal point: "
         "440.5"},
        {"{name: x, speed: 0,05}\n", "f:1:18", "decimal point: 0.05"},
        {"{name: x, speed: 440, 5: 1}\n", "f:1:23", "unknown key \"5\""},
        {"{name: x, speed: 440.5, 5}\n", "f:1:25", "unknown key \"5\""},
        {"{name: x, spede: 440, 5}\n", "f:1:11", "unknown key \"spede\""},
        {"name: x\nspeed: [5]\n", "f:2:8", "speed: is a list, not real"},
        {"name: x\nflag: yes\n", "f:2:7", "neither true nor false"},
        {"name: x\nflag: 'true'\n", "f:2:7", "neither true nor false"},
        {"name: {a: b}\n", "f:1:7", "name: is a map, not text"},
        {"name: x\ncolumn: [1]\n", "f:2:9", "is a list, not text or integer"},
        {"name: x\nframe: {}\n", "f:2:8", "frame: the key \"utm\" is missing"},
        {"name: x\nframe: {utm: null}\n", "f:2:8", "frame: the key \"utm\" is missing"},
        {"name: x\nframe: {utm: 5}\n", "f:2:14", "frame.utm: is a single value, not a map"},
        {"name: x\nframe: {utm: {zone: 61}}\n", "f:2:21", "frame.utm.zone: 61 is above 60"},
        {"name: x\nframe: [utm]\n", "f:2:8", "is a list, not text or map"},
        {"name: x\nlist: {id: a}\n", "f:2:7", "is a map, not list"},
        {"name: x\nlist: a\n", "f:2:7", "is a single value, not a list"},
        {"name: x\nlist: [a]\n", "f:2:8", "list[0]: is a single value, not a map"},
        {"name: x\nlist: [{id: a}, {}]\n", "f:2:17", "list[1]: the key \"id\" is missing"},
        {"name: x\nlist: [{id: a}, ~]\n", "f:2:17", "list[1]: is empty"},
        {"name: x\nlist: [{id: a, words: [c]}]\n", "f:2:24", "list[0].words[0]: \"c\""},
        {"name: x\ncounts: {gap: -1}\n", "f:2:15", "counts.gap: -1 is below 0"},
        {"name: x\ncounts: {gap: many}\n", "f:2:15", "not a whole number"},
    };
    for (const auto& c : cases) {
        const auto said = check(c.text);
        EXPECT_EQ(said.where, c.where) << c.text << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.text << said.problem << ". " << said.remedy;
    }
}

TEST(DocumentSchema, TheCommonPartStandsInFront) {
    const DocumentSchema common = DocumentSchema::parse(
        "schema: c\nversion: '1.0'\nfields:\n  stage: {type: text, required: true, description: "
        "s}\n",
        "c");
    const DocumentSchema both = DocumentSchema::parse(
        "schema: d\nversion: '1.0'\nfields:\n  own: {type: text, description: o}\n", "d", &common);
    EXPECT_EQ(both.name(), "d");
    EXPECT_EQ(both.fields().at(0).path, "stage");
    EXPECT_TRUE(failure_of([&] {
                    both.validate({parse_yaml("own: x\n", "f"), "f"});
                }).contains("\"stage\" is missing"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
