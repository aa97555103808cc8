#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "schemas/common/document.h"
#include "schemas/common/window_span.h"
#include "store/yaml_output.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

/// The fields of the header, and one real number.
const DocumentSchema& product() {
    static const DocumentSchema schema = DocumentSchema::parse(
        "schema: sample\nversion: \"1.0\"\nfields:\n"
        "  value: {type: real, unit: m, decimals: 3, description: v}\n"
        "  list: {type: list, description: l}\n"
        "  list[]: {type: real, decimals: 1, description: i}\n",
        "sample", &header_schema());
    return schema;
}

const std::string document = R"(schema: {name: sample, version: "1.0"}
stage: {name: enu, version: "1.0.0", source_revision: 0123456789ab}
inputs:
  - {role: observations, file: 1-observations.ecsv, sha256: "00", bytes: 12}
parameters: {a: {b: [1, 2.5, "3", yes, true, null]}}
value: 1.5
)";

TEST(CheckVersion, KnowsOne) {
    const auto checked = [](const std::string& schema) {
        check_version({parse_yaml("schema: " + schema + "\n", "f"), "f"}, product());
    };
    EXPECT_NO_THROW(checked("{name: sample, version: \"1.0\"}"));
    EXPECT_NO_THROW(checked("{name: sample, version: 1.0}"));
    const struct {
        const char *schema, *where, *said;
    } cases[] = {
        {"{name: sample, version: \"2.0\"}", "f:1:33",
         "version \"2.0\" of the schema sample is not"},
        {"{name: sample, version: \"0.9\"}", "f:1:33", "not known, this program reads 1.0"},
        {"{name: sample, version: \"1.1\"}", "f:1:33", "version \"1.1\" of the schema sample is"},
        {"{name: sample, version: \"10.0\"}", "f:1:33", "not known"},
        {"{name: sample, version: \"1\"}", "f:1:33", "not known"},
        {"{name: sample, version: \"1.\"}", "f:1:33", "not known"},
        {"{name: sample, version: \"1.0.0\"}", "f:1:33", "not known"},
        {"{name: sample, version: \"1.-5\"}", "f:1:33", "not known"},
        {"{name: sample, version: \"+1.0\"}", "f:1:33", "not known"},
        {"{name: sample, version: \"1.0b\"}", "f:1:33", "not known"},
        {"{name: sample, version: \"1.99999999999999999999\"}", "f:1:33", "not known"},
        {"{name: enu, version: \"1.0\"}", "f:1:16", "a file of the schema \"enu\", expected \"sam"},
        {"{version: \"1.0\"}", "f", "schema.name: is missing"},
        {"{name: sample}", "f", "schema.version: is missing"},
        {"sample/1.0", "f", "schema.name: is missing"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { checked(c.schema); });
        EXPECT_EQ(said.where, c.where) << c.schema;
        EXPECT_TRUE(said.contains(c.said)) << c.schema << ": " << said.problem;
    }
}

TEST(ReadDocument, AnotherVersionIsRefusedWithWhatToDo) {
    const auto said =
        failure_of([] { read_document(replaced(document, "1.0", "1.1"), "f", product()); });
    EXPECT_EQ(said.problem,
              "version \"1.1\" of the schema sample is not known, this program reads 1.0");
    EXPECT_EQ(said.remedy, "Certify the recording again with this program");
    const std::string wrong = replaced(document, "value: 1.5", "value: x");
    EXPECT_TRUE(failure_of([&] { read_document(wrong, "f", product()); }).contains("not a number"));
}

TEST(Header, RoundTrips) {
    const Header header = read_header(read_document(document, "f", product()));
    EXPECT_EQ(header.schema_name, "sample");
    EXPECT_EQ(header.schema_version, "1.0");
    EXPECT_EQ(header.stage, "enu");
    EXPECT_EQ(header.program_version, "1.0.0");
    EXPECT_EQ(header.source_revision, "0123456789ab");
    ASSERT_EQ(header.inputs.size(), 1U);
    EXPECT_EQ(header.inputs[0].file, "1-observations.ecsv");
    EXPECT_EQ(header.inputs[0].bytes, 12U);
    EXPECT_EQ(header.inputs[0].original, "");
    const nlohmann::ordered_json parameters = {{"a", {{"b", {1, 2.5, "3", "yes", true, nullptr}}}}};
    EXPECT_EQ(*header.parameters, parameters);
    EXPECT_EQ(header.parameters.at("a")["b"][0].type(), nlohmann::json::value_t::number_integer);
    const std::string text = write_document(header_json(header), product());
    EXPECT_EQ(header_json(read_header(read_document(text, "f", product()))), header_json(header));
}

TEST(WriteDocument, RoundsToTheDecimalsOfTheTableAndChecksItself) {
    nlohmann::ordered_json json = header_json(read_header(read_document(document, "f", product())));
    json["value"] = 1.23456;
    json["list"] = {0.05, 0.25, 1.0};
    const YamlValue back = read_document(write_document(json, product()), "f", product());
    EXPECT_EQ(back["value"].real(), 1.235);
    EXPECT_EQ(back["list"].list()[0].real(), 0.1);
    EXPECT_EQ(back["parameters"]["a"]["b"].list()[1].real(), 2.5);
    json["more"] = 1;
    EXPECT_TRUE(failure_of([&] { write_document(json, product()); }).contains("sample as written"));
    json.erase("more");
    json["value"] = std::nan("");
    EXPECT_TRUE(failure_of([&] { write_document(json, product()); }).contains("finite"));
}

TEST(WindowSpan, RoundTripsToTheNanosecond) {
    for (const std::int64_t start :
         {0LL, 1LL, 999LL, 99'999LL, 100'000LL, 40'146'414'343LL, 86'400'000'000'001LL}) {
        const WindowSpan span{.first_epoch = 3,
                              .last_epoch = 33,
                              .start = {start},
                              .duration = {3'000'000'001},
                              .start_gps = parse_gps_iso("2022-03-18T08:51:22.300")};
        const std::string text = to_yaml_text(members_json(span));
        const WindowSpan back = read_members<WindowSpan>({parse_yaml(text, "f"), "f"});
        EXPECT_EQ(back.start.nanoseconds, start) << text;
        EXPECT_EQ(back.duration.nanoseconds, 3'000'000'001);
        EXPECT_EQ(back.first_epoch, 3);
        EXPECT_EQ(back.last_epoch, 33);
        EXPECT_EQ(back.start_gps, span.start_gps);
    }
}

TEST(WindowSpan, BadTimesAreNamedWithTheirPlace) {
    const std::string good = "first_epoch: 1\nlast_epoch: 2\nstart_time_s: 1.5\nduration_s: 3.0\n";
    const struct {
        const char *from, *to, *where, *said;
    } cases[] = {
        {"1.5", "1.0e+300", "f:3:15", "start_time_s: is not a time in seconds"},
        {"1.5", "1.5e0", "f:3:15", "is not a time in seconds"},
        {"1.5", "1.0000000001", "f:3:15", "at most nine decimals"},
        {"1.5", "\"1.5\"", "f:3:15", "not a number"},
        {"1.5", "soon", "f:3:15", "not a number"},
        {"3.0", "", "f:4:12", "duration_s: is missing"},
        {"3.0\n", "3.0\nstart_gps: today\n", "f:5:12", "start_gps: \"today\""},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] {
            read_members<WindowSpan>({parse_yaml(replaced(good, c.from, c.to), "f"), "f"});
        });
        EXPECT_EQ(said.where, c.where) << c.to << ": " << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.to << ": " << said.problem;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
