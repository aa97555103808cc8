#include <gtest/gtest.h>

#include <string>

#include "store/document_schema.h"
#include "store_test_support.h"

// Rules across the keys of a document.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;

const DocumentSchema& schema() {
    static const DocumentSchema instance = DocumentSchema::parse(R"(
schema: sample
version: "1.0"
fields:
  arm: {type: real, description: "its arm"}
  box: {type: map, description: "a box"}
  bound: {type: real, description: "a bound"}
  speed: {type: real, description: "a speed"}
  unit: {type: text, description: "its unit"}
  of: {type: text, default: time, description: "of what"}
  low: {type: real, default: 5, description: "from"}
  high: {type: real, default: 10, description: "to"}
  from: {type: text, description: "from"}
  to: {type: text, description: "to"}
  parts: {type: list, description: "parts"}
  parts[]: {type: map, description: "a part"}
  parts[].id: {type: text, required: true, description: "its id"}
  parts[].frame: {type: text|map, description: "its frame"}
  parts[].frame.utm: {type: any, description: "a grid"}
rules:
  - {at: "", when: {box: given}, must: {arm: absent}}
  - {at: "", when: {bound: given, box: absent}, must: {arm: given}}
  - {at: "", when: {unit: given}, must: {of: [speed, way]}}
  - {at: "", together: [speed, unit], because: "a speed has a unit", remedy: "Give both"}
  - {at: "", ascending: [low, high]}
  - {at: "", ascending: [from, to]}
  - {at: "", list: parts, least: 1, most: 2, remedy: "List one or two"}
  - {at: "", unique: id, in: [parts]}
  - {at: "parts[]", when: {frame: utm}, must: {/arm: given}}
)",
                                                                 "sample/v1.yaml");
    return instance;
}

const std::string least = "parts: [{id: a}]\n";

std::string said(const std::string& text, Completeness completeness = Completeness::whole) {
    const auto all = failure_of([&] {
        schema().validate({parse_yaml(text, "f"), "f"}, completeness);
    });
    return all.where + " " + all.problem + ". " + all.remedy;
}

TEST(KeyRules, SayWhatIsNeededExcludedAndAllowed) {
    EXPECT_NO_THROW(schema().validate({parse_yaml(least, "f"), "f"}));
    EXPECT_EQ(said(least + "box: {}\narm: 1\n"),
              "f:3:6 arm: box goes without arm. Remove arm or box");
    EXPECT_EQ(said(least + "bound: 1\n"),
              "f:2:8 bound: bound needs arm. Add arm: its arm; or remove bound");
    EXPECT_NO_THROW(schema().validate({parse_yaml(least + "bound: 1\nbox: {}\n", "f"), "f"}));
    // By default, too.
    EXPECT_EQ(said(least + "speed: 1\nunit: m\n"),
              "f:3:7 unit: unit needs of: speed or way. Write of: speed or way, or remove unit");
    EXPECT_NO_THROW(
        schema().validate({parse_yaml(least + "speed: 1\nunit: m\nof: way\n", "f"), "f"}));
    EXPECT_EQ(said(least + "speed: 1\n"), "f:1:1 a speed has a unit. Give both");
    EXPECT_EQ(said("parts: [{id: a, frame: {utm: 1}}]\n"),
              "f:1:24 parts[0].frame: utm needs arm. Add arm: its arm");
}

TEST(KeyRules, ComparesNumbersAndTimesAndCountsItems) {
    EXPECT_EQ(said(least + "low: 10\n"),
              "f:2:6 low: high is 10, which is not above low, 10. Give high above low");
    EXPECT_EQ(said(least + "from: \"2026-03-14T10:00:00\"\nto: \"2026-03-14T09:00:00Z\"\n"),
              "f:3:5 to: to is 2026-03-14T09:00:00Z, which is not above from, "
              "2026-03-14T10:00:00. Give to above from");
    EXPECT_EQ(said("parts: []\n"), "f:1:8 parts: 0 parts are listed. List one or two");
    EXPECT_EQ(said("parts: [{id: a}, {id: a}]\n"),
              "f:1:23 parts[1].id: two parts have the id \"a\". Give each an id of its own");
}

TEST(KeyRules, MissNothingInADocumentThatIsBegun) {
    for (const char* text : {"parts: [{}]\n", "bound: 1\n", "speed: 1\n", "{}\n"})
        EXPECT_NO_THROW(schema().validate({parse_yaml(text, "f"), "f"}, Completeness::begun))
            << text;
    EXPECT_EQ(said("box: {}\narm: 1\n", Completeness::begun),
              "f:2:6 arm: box goes without arm. Remove arm or box");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
