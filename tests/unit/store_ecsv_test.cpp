#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "store/ecsv.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

constexpr std::int64_t smallest = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t largest = std::numeric_limits<std::int64_t>::max();

std::vector<EcsvColumn> one_of_each() {
    return {{.name = "flag", .type = CellType::boolean, .unit = {}, .description = "yes or no"},
            {.name = "count", .type = CellType::integer, .unit = {}, .description = {}},
            {.name = "speed", .unit = "m / s", .decimals = 3, .description = "how fast: #1, \"x\""},
            {.name = "word", .type = CellType::text, .unit = {}, .description = {}},
            {.name = "time", .unit = "s", .decimals = 9, .description = {}}};
}

TEST(Ecsv, EveryTypeRoundTrips) {
    const struct {
        std::optional<bool> flag;
        std::optional<std::int64_t> count;
        std::optional<double> speed;
        std::optional<std::string> word;
        std::optional<std::int64_t> time;
    } rows[] = {
        {true, 0, 0.0, "a", 0},
        {false, smallest, -1234567.125, "a,b", smallest},
        {std::nullopt, largest, 1e300, "say \"x\", \"\"", largest},
        {true, std::nullopt, 0.001, "#1", 100'000'000},
        {true, -1, std::nullopt, "True", -1},
        {true, 1, -0.001, std::nullopt, 1},
        {true, 1, 1.0, "a  b ~!'|;:\\", std::nullopt},
        {std::nullopt, std::nullopt, std::nullopt, std::nullopt, std::nullopt},
    };
    EcsvWriter out(one_of_each(), {{"k", 1}});
    for (const auto& row : rows) {
        row.flag ? out.boolean(*row.flag) : out.missing();
        row.count ? out.integer(*row.count) : out.missing();
        row.speed ? out.real(*row.speed) : out.missing();
        row.word ? out.text(*row.word) : out.missing();
        row.time ? out.seconds(*row.time) : out.missing();
    }
    const std::string text = std::move(out).take();

    EcsvReader in(text, "t.ecsv");
    ASSERT_EQ(in.columns().size(), 5U);
    const std::vector<EcsvColumn> expected = one_of_each();
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(in.columns()[i].name, expected[i].name);
        EXPECT_EQ(in.columns()[i].type, expected[i].type);
        EXPECT_EQ(in.columns()[i].unit, expected[i].unit);
        EXPECT_EQ(in.columns()[i].decimals, expected[i].decimals);
        EXPECT_EQ(in.columns()[i].description, expected[i].description);
    }
    EXPECT_EQ(in.meta()["k"].scalar(), "1");
    for (const auto& row : rows) {
        ASSERT_TRUE(in.next_row());
        EXPECT_EQ(in.is_missing(0) ? std::nullopt : std::optional(in.boolean(0)), row.flag);
        EXPECT_EQ(in.is_missing(1) ? std::nullopt : std::optional(in.integer(1)), row.count);
        EXPECT_EQ(in.is_missing(2) ? std::nullopt : std::optional(in.real(2)), row.speed);
        EXPECT_EQ(in.is_missing(3) ? std::nullopt : std::optional(in.text(3)), row.word);
        EXPECT_EQ(in.is_missing(4) ? std::nullopt : std::optional(in.seconds(4)), row.time);
    }
    EXPECT_FALSE(in.next_row());
}

TEST(Ecsv, WritesWhatTheFormatSays) {
    EcsvWriter out({{.name = "a", .unit = "m", .decimals = 2, .description = {}},
                    {.name = "b", .type = CellType::text, .unit = {}, .description = {}}},
                   {{"k", nullptr}});
    out.real(-0.001);
    out.text("x");
    out.missing();
    out.text("x,\"y\"");
    EXPECT_EQ(std::move(out).take(),
              "# %ECSV 1.0\n# ---\n# datatype:\n"
              "#   - name: a\n#     unit: m\n#     datatype: float64\n#     format: \"%.2f\"\n"
              "#   - name: b\n#     datatype: string\n"
              "# delimiter: \",\"\n# meta:\n#   k: null\n"
              "a,b\n0.00,x\n,\"x,\"\"y\"\"\"\n");
}

TEST(Ecsv, WriterRefusesWhatNoCellCanHold) {
    const auto refused = [](const auto& write) {
        return failure_of([&] {
                   EcsvWriter out({{.name = "c", .unit = {}, .description = {}}}, nullptr);
                   write(out);
               }).where == "column c";
    };
    for (const double value : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -HUGE_VAL})
        EXPECT_TRUE(refused([&](EcsvWriter& out) { out.real(value); })) << value;
    for (const char* text : {"", " a", "a ", " ", "a\nb", "a\tb", "a\rb", "\xc3\xa9", "\x7f"})
        EXPECT_TRUE(refused([&](EcsvWriter& out) { out.text(text); })) << text;
    EXPECT_TRUE(refused([](EcsvWriter& out) { out.text(std::string_view("a\0b", 3)); }));
}

TEST(Ecsv, AMissingCellAloneIsNoEmptyLine) {
    EcsvWriter out({{.name = "c", .unit = {}, .description = {}}}, nullptr);
    out.missing();
    out.real(1.0);
    const std::string text = std::move(out).take();
    EXPECT_TRUE(text.ends_with("\nc\n\"\"\n1\n")) << text;
    EcsvReader in(text, "t.ecsv");
    ASSERT_TRUE(in.next_row());
    EXPECT_TRUE(in.is_missing(0));
    ASSERT_TRUE(in.next_row());
    EXPECT_EQ(in.real(0), 1.0);
}

const std::string table =
    "# %ECSV 1.0\n"                           // 1
    "# ---\n"                                 // 2
    "# datatype:\n"                           // 3
    "#   - {name: epoch, datatype: int64}\n"  // 4
    "#   - {name: speed, unit: m / s, datatype: float64, format: \"%.3f\"}\n"
    "#   - {name: usable, datatype: bool}\n"    // 6
    "#   - {name: reason, datatype: string}\n"  // 7
    "# delimiter: \",\"\n"                      // 8
    "# meta:\n"                                 // 9
    "#   note: plain\n"                         // 10
    "epoch,speed,usable,reason\n"               // 11
    "1,61.500,True,none\n"                      // 12
    "2,61.250,False,\"a, b\"\n";                // 13

/// Reads every cell.
void read_all(const std::string& text) {
    EcsvReader in(text, "t.ecsv");
    while (in.next_row()) {
        (void)in.integer(0);
        (void)in.real(1);
        (void)in.boolean(2);
        (void)in.text(3);
    }
}

TEST(Ecsv, TheTableOfDeviationsIsGood) {
    EXPECT_NO_THROW(read_all(table));
}

TEST(Ecsv, EveryDeviationIsAFailureWithItsPlace) {
    const struct {
        std::string from, to, where, said;
    } cases[] = {
        {"# %ECSV 1.0\n# ---\n", "", "t.ecsv:1:1", "expected \"# %ECSV 1.0\""},
        {"# %ECSV 1.0", "# %ECSV 0.9", "t.ecsv:1:1", "expected \"# %ECSV 1.0\""},
        {"# %ECSV 1.0", "# %ECSV 1.0 ", "t.ecsv:1:1", "expected \"# %ECSV 1.0\""},
        {"# %ECSV 1.0", "\xef\xbb\xbf# %ECSV 1.0", "t.ecsv:1:1", "\\xef\\xbb\\xbf"},
        {"# delimiter: \",\"", "# delimiter: \" \"", "t.ecsv:8:14", "not a comma"},
        {"# delimiter: \",\"\n", "", "t.ecsv:2:1", "not a comma"},
        {"epoch,speed,", "epoch,velocity,", "t.ecsv:11:1", "line of column names"},
        {"epoch,speed,", "speed,epoch,", "t.ecsv:11:1", "line of column names"},
        {"usable,reason", "usable", "t.ecsv:11:1", "line of column names"},
        {"usable,reason", "usable,reason,more", "t.ecsv:11:1", "line of column names"},
        {"name: usable", "name: epoch", "t.ecsv:6:7", "two columns are named \"epoch\""},
        {"{name: usable, ", "{", "t.ecsv:6:7", "column 3 has no name"},
        {"datatype: bool", "datatype: float32", "t.ecsv:6:7", "has the type \"float32\""},
        {"datatype: bool", "datatype: \"bool\\nx\"", "t.ecsv:6:7", "has the type"},
        {", datatype: bool", "", "t.ecsv:6:7", "has the type \"\""},
        {"datatype: bool", "subtype: json", "t.ecsv:6:22", "unknown column key \"subtype\""},
        {"# delimiter", "# more: 1\n# delimiter", "t.ecsv:8:3", "unknown header key \"more\""},
        {"# datatype:", "# columns:", "t.ecsv:2:1", "no list \"datatype\""},
        {"# meta:", "#meta:", "t.ecsv:9:2", "must begin with \"# \""},
        {"plain", "*alias", "t.ecsv:10:11", "anchor"},
        {"plain", "&anchor x", "t.ecsv:10:11", "aliases"},
        {"plain", "!mine x", "t.ecsv:10:11", "tag \"!mine\""},
        {"plain", "!!python/name:os.system x", "t.ecsv:10:11", "is not understood"},
        {"plain", "!!omap [a]", "t.ecsv:10:19", "!!omap"},
        {"plain", "!!omap [{a: 1}, {a: 2}]", "t.ecsv:10:27", "!!omap"},
        {"plain", std::string(40, '[') + std::string(40, ']'), "t.ecsv:10:41", "32 levels"},
        {"plain", "x\n#   note: y", "t.ecsv:11:5", "twice"},
        {"plain", "\"x", "t.ecsv:10:11", "a quote is not closed"},
        {"plain", "na\xc3\xafve", "t.ecsv:10:1", "not printable ASCII"},
        {"plain", "a\rdelimiter: x", "t.ecsv:10:1", "not printable ASCII"},
        {"plain", "x\n# ---\n# y: 1", "t.ecsv:11:1", "more than one YAML document"},
        {"1,61.500,True,none\n", "1,61.500,True\n", "t.ecsv:12:1", "3 cells"},
        {"1,61.500,True,none\n", "1,61.500,True,none,\n", "t.ecsv:12:1", "5 cells"},
        {"1,61.500,True,none\n", "\n", "t.ecsv:12:1", "empty"},
        {"1,61.500,True,none\n", "#1,61.500,True,none\n", "t.ecsv:12:1", "comment"},
        {"1,61.500", "1,fast", "t.ecsv:12:3", "column \"speed\": \"fast\" is not a finite number"},
        {"1,61.500", "1,nan", "t.ecsv:12:3", "not a finite number"},
        {"1,61.500", "1,inf", "t.ecsv:12:3", "not a finite number"},
        {"1,61.500", "1,-inf", "t.ecsv:12:3", "not a finite number"},
        {"1,61.500", "1,1e400", "t.ecsv:12:3", "not a finite number"},
        {"1,61.500", "1,0x10", "t.ecsv:12:3", "not a finite number"},
        {"1,61.500", "1,\"1,5\"", "t.ecsv:12:3", "\"1,5\" is not a finite number"},
        {"1,61.500", "1, 61.5", "t.ecsv:12:3", "blank"},
        {"1,61.500", "1,61.5 ", "t.ecsv:12:3", "blank"},
        {"1,61.500", "1,", "t.ecsv:12:3", "empty but must not be"},
        {"1,61.500", "1,\"\"", "t.ecsv:12:3", "empty but must not be"},
        {"1,61.500", "1.0,61.500", "t.ecsv:12:1", "not a whole number"},
        {"1,61.500", "9223372036854775808,61.500", "t.ecsv:12:1", "not a whole number"},
        {"True,none", "true,none", "t.ecsv:12:10", "neither True nor False"},
        {"True,none", "1,none", "t.ecsv:12:10", "neither True nor False"},
        {"True,none", "True,\"none", "t.ecsv:12:15", "not closed"},
        {"True,none", "True,\"no\nne\"", "t.ecsv:12:15", "not closed"},
        {"True,none", "True,\"no\"ne", "t.ecsv:12:19", "after a closing quote"},
        {"True,none", "True,no\"ne\"", "t.ecsv:12:17", "not quoted"},
        {"True,none", "True,\" none\"", "t.ecsv:12:15", "blank"},
        {"True,none", "True,na\xc3\xafve", "t.ecsv:12:15", "printable ASCII"},
        {"True,none", "True,no\tne", "t.ecsv:12:15", "printable ASCII"},
        {"True,none", "True,no\rne", "t.ecsv:12:15", "printable ASCII"},
        {"True,none", "True,none\r\r", "t.ecsv:12:15", "printable ASCII"},
        {"True,none", std::string("True,no\0ne", 10), "t.ecsv:12:15", "printable ASCII"},
        {"\"a, b\"\n", "\"a, b\"", "t.ecsv:13:22", "cut off"},
        {"\"a, b\"\n", "\"a,", "t.ecsv:13:19", "cut off"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_all(replaced(table, c.from, c.to)); });
        EXPECT_EQ(said.where, c.where) << c.from << " -> " << c.to << "\n" << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.to << "\n" << said.problem;
    }
}

TEST(Ecsv, WholeFilesThatAreNoTables) {
    const std::string header = table.substr(0, table.find("epoch,speed"));
    const struct {
        std::string text, where, said;
    } cases[] = {
        {"", "t.ecsv", "the file is empty"},
        {"\n", "t.ecsv:1:1", "expected \"# %ECSV 1.0\""},
        {"# %ECSV 1.0", "t.ecsv:1:12", "cut off"},
        {"# %ECSV 1.0\n", "t.ecsv:1:1", "not followed"},
        {"# %ECSV 1.0\nepoch\n", "t.ecsv", "empty"},
        {"# %ECSV 1.0\n# - a\nepoch\n", "t.ecsv:2:1", "no list \"datatype\""},
        {header, "t.ecsv:10:1", "not followed by the line of column names"},
        {header + "\n", "t.ecsv:11:1", "line of column names"},
        {"# %ECSV 1.0\n# datatype: []\n# delimiter: ','\n\n", "t.ecsv:4:1", "column names"},
        {std::string(3, '\0'), "t.ecsv:1:4", "cut off"},
        {"\xff\xfe#\n", "t.ecsv:1:1", "\\xff\\xfe#"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_all(c.text); });
        EXPECT_EQ(said.where, c.where) << c.text;
        EXPECT_TRUE(said.contains(c.said)) << c.text << said.problem;
    }
}

TEST(Ecsv, ReadsWhatOtherWritersMake) {
    // Lines that end in CR LF, ignored comments, no meta, a schema, keys in another order.
    std::string text =
        replaced(table, "# meta:\n#   note: plain\n", "## not yaml: [\n# schema: x\n");
    std::string crlf;
    for (const char c : text)
        crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    EXPECT_NO_THROW(read_all(crlf));
    EcsvReader in(text, "t.ecsv");
    EXPECT_TRUE(in.meta().is_null());
    // Header alone: a table of no rows.
    const std::string empty = table.substr(0, table.find("1,61"));
    EcsvReader rows(empty, "t.ecsv");
    EXPECT_FALSE(rows.next_row());
}

TEST(Ecsv, OrderedMapsAreMapsWhereverTheyStand) {
    const std::string text = replaced(
        table, "# meta:\n#   note: plain\n",
        "# meta:\n#   a: !!omap\n#   - b: !!omap\n#     - {c: 1}\n#     - d:\n#       - !!omap\n"
        "#         - {e: 2}\n#   - {f: 3}\n");
    EcsvReader in(text, "t");
    const YamlNode& meta = in.meta();
    EXPECT_EQ(meta["a"]["b"]["c"].scalar(), "1");
    EXPECT_EQ(meta["a"]["b"]["d"][0]["e"].scalar(), "2");
    EXPECT_EQ(meta["a"]["f"].scalar(), "3");
    const std::string top = replaced(table, "# meta:\n#   note: plain\n",
                                     "# meta: !!omap\n# - {note: plain}\n# - {more: [1]}\n");
    EcsvReader ordered(top, "t");
    EXPECT_EQ(ordered.meta()["note"].scalar(), "plain");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
