#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "schemas/generator/declaration.h"
#include "store_test_support.h"

// What a declaration stands for: its field table and its C++.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;

/// A product "thing" that uses another, "shared".
class Generator : public testing::Test {
  protected:
    Generator() {
        write("shared", R"(schema: shared
version: "1.0"
words:
  Kind:
    about: "A kind"
    words:
      plain: "as it is"
      float: {enumerator: floating, description: "not fixed", phrase: "that float"}
groups:
  Accuracy:
    about: "An accuracy"
    compact: true
    columns:
      - {name: sigma, type: real, unit: m, decimals: 3, description: "its size"}
      - {name: kind, type: Kind, always: true, description: "its kind"}
      - {name: line, type: integer, bits: 16, description: "where"}
maps:
  Parameter:
    about: "A parameter"
    fields:
      value: {type: real, unit: "*", required: true, description: "its value"}
      note: {type: text, description: "of it"}
fields:
  any: {type: text, description: "one"}
)");
    }

    void write(const std::string& product, const std::string& text) const {
        std::filesystem::create_directories(folder_.path() / product);
        std::ofstream(folder_.path() / product / "v1.yaml") << text;
    }

    /// The product of these lines behind its head.
    Declaration thing(const std::string& lines) const {
        write("thing", "schema: thing\nversion: \"1.2\"\nuses: [shared]\n" + lines);
        return {(folder_.path() / "thing" / "v1.yaml").string(), folder_.path()};
    }

  private:
    TemporaryFolder folder_;
};

TEST_F(Generator, TheFieldTableHasEveryMapWhereItIsUsed) {
    const Declaration declaration = thing(R"(fields:
  first: {type: Parameter, unit: s, required: true, description: "the first"}
  rest: {type: list, of: Parameter, unit: m, item: "another", description: "the others"}
  names: {type: list, of: text, required: true, description: "names"}
  inside: {type: Parameter, flat: true, description: "beside"}
  kind: {type: Kind, required: true, initially: float, description: "which"}
  at: {type: gps_time, member: instant, description: "when"}
  top: {type: speed, description: "how fast"}
)");
    EXPECT_EQ(field_table_text(declaration), R"(schema: thing
version: "1.2"
fields:
  "first": {type: map, required: true, description: "the first"}
  "first.value": {type: real, unit: s, required: true, description: "its value"}
  "first.note": {type: text, description: "of it"}
  "rest": {type: list, description: "the others"}
  "rest[]": {type: map, description: "another"}
  "rest[].value": {type: real, unit: m, required: true, description: "its value"}
  "rest[].note": {type: text, description: "of it"}
  "names": {type: list, required: true, description: "names"}
  "names[]": {type: text, description: "one of them"}
  "value": {type: real, required: true, description: "its value"}
  "note": {type: text, description: "of it"}
  "kind": {type: text, values: ["plain", "float"], required: true, description: "which"}
  "at": {type: text, description: "when"}
  "top_km_h": {type: real, unit: km/h, decimals: 4, description: "how fast"}
  "top_m_s": {type: real, unit: m / s, decimals: 6, description: "how fast"}
  "top_knots": {type: real, unit: kn, decimals: 4, description: "how fast"}
  "top_mph": {type: real, unit: mph, decimals: 4, description: "how fast"}
)");
}

TEST_F(Generator, AStructHasAMemberForEachField) {
    const std::string header = header_text(thing(R"(maps:
  Inner:
    about: "A map"
    comparable: true
    functions: [bool fast() const]
    fields:
      rate_m_s: {type: real, required: true, initially: 2.5, description: "a rate"}
      late_s: {type: real, description: "may be absent"}
      kind: {type: Kind, required: true, initially: float, description: "which"}
      empty: {type: boolean, computed: late_s.has_value(), description: "no member"}
      list: {type: list, of: Parameter, description: "some"}
fields:
  inner: {type: Inner, required: true, description: "it"}
)"));
    for (const char* member :
         {"struct Inner {", "    double rate_m_s = 2.5;",
          "    std::optional<double> late_s = std::nullopt;", "    Kind kind = Kind::floating;",
          "    std::vector<Parameter> list = {};", "    bool fast() const;",
          "    bool operator==(const Inner&) const = default;"})
        EXPECT_NE(header.find(member), std::string::npos) << member << "\n" << header;
    EXPECT_EQ(header.find("empty"), std::string::npos);
}

TEST_F(Generator, TheSourceWritesAndReadsWhatTheHeaderDeclares) {
    const std::string source = source_text(thing(R"(struct: {name: Thing, about: "a thing"}
fields:
  rate_m_s: {type: real, required: true, description: "a rate"}
  length_m: {type: real, omit: 0, description: "a length"}
  speed_km_h: {type: real, member: speed_m_s, scale: 3.6, required: true, description: "a speed"}
  bare: {type: boolean, computed: length_m == 0, description: "whether there is none"}
  some: {type: list, of: Parameter, description: "some"}
)"));
    for (const char* line :
         {"member::write(map, \"rate_m_s\", value.rate_m_s);",
          "member::take(map, \"rate_m_s\", value.rate_m_s);",
          "if (value.length_m != 0) member::write(map, \"length_m\", value.length_m);",
          "member::write(map, \"speed_km_h\", value.speed_m_s * 3.6);",
          "map[\"bare\"] = value.length_m == 0;",
          "if (!value.some.empty()) member::write(map, \"some\", value.some);",
          "std::string write_thing(const Thing& value) {"})
        EXPECT_NE(source.find(line), std::string::npos) << line << "\n" << source;
    EXPECT_EQ(source.find("member::take(map, \"bare\""), std::string::npos);
}

TEST_F(Generator, ColumnsStandInTheRowAndInItsGroups) {
    const Declaration declaration = thing(R"(row: {name: Row, about: "a row"}
columns:
  - {name: epoch, type: integer, always: true, description: "number"}
  - {name: time, type: elapsed, always: true, description: "when"}
  - {name: speed, type: real, unit: m / s, decimals: 2, description: "how fast"}
  - {group: Accuracy, member: stated}
fields: {}
)");
    const std::string header = header_text(declaration);
    for (const char* member : {"    std::int64_t epoch = 0;", "    ElapsedTime time = {};",
                               "    std::optional<double> speed_m_s = {};", "    Accuracy stated;"})
        EXPECT_NE(header.find(member), std::string::npos) << member << "\n" << header;
    EXPECT_NE(
        source_text(declaration).find("column<Row, &Row::stated, &Accuracy::sigma_m>(\"sigma\")"),
        std::string::npos);
    const std::string table = field_table_text(declaration);
    EXPECT_NE(table.find("{name: time, type: real, unit: s, decimals: 9, description: \"when\"}"),
              std::string::npos)
        << table;
    EXPECT_NE(table.find("{name: sigma, type: real, unit: m, decimals: 3"), std::string::npos);
}

/// Smallest first, so that no room is lost between them in a table of millions of rows.
TEST_F(Generator, ACompactGroupStandsBySize) {
    const std::string header = header_text(thing(R"(groups:
  Small:
    about: "A group"
    compact: true
    columns:
      - {name: size, type: real, unit: m, decimals: 3, description: "eight bytes"}
      - {name: kind, type: Kind, always: true, description: "one byte"}
      - {name: line, type: integer, bits: 16, description: "two bytes"}
fields: {}
)"));
    const std::size_t kind = header.find("    Kind kind = Kind::plain;");
    const std::size_t line = header.find("    OptionalNumber<std::int16_t> line = {};");
    const std::size_t size = header.find("    OptionalReal size_m = {};");
    EXPECT_TRUE(kind < line && line < size && size != std::string::npos) << header;
}

TEST_F(Generator, AFaultOfADeclarationIsNamedWithItsPlace) {
    const auto group = failure_of([&] {
        thing("row: {name: Row, about: \"a row\"}\ncolumns:\n  - {group: Nothing}\nfields: {}\n");
    });
    EXPECT_TRUE(group.contains("is no group of columns")) << group.problem;
    const auto type = failure_of([&] {
        header_text(
            thing("struct: {name: Thing, about: \"a\"}\nfields:\n"
                  "  x: {type: number, description: \"of no type\"}\n"));
    });
    EXPECT_TRUE(type.contains("has no type in C++")) << type.problem;
    const auto word = failure_of([&] {
        header_text(
            thing("struct: {name: Thing, about: \"a\"}\nfields:\n"
                  "  x: {type: Kind, required: true, initially: no, description: \"d\"}\n"));
    });
    EXPECT_TRUE(word.contains("is no word of Kind")) << word.problem;
    const auto rule = failure_of([&] {
        field_table_text(
            thing("struct: {name: Thing, about: \"a\"}\nrules:\n  - {together: [x, y]}\nfields:\n"
                  "  x: {type: text, description: \"d\"}\n"));
    });
    EXPECT_TRUE(rule.contains("there is no field y")) << rule.problem;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
