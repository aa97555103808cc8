#include <gtest/gtest.h>

#include <string>

#include "schemas/enu/declared.h"
#include "schemas/observations/observations.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "store_test_support.h"

// Tables that are gone through row by row, against the same read and written whole.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;

std::string golden(const std::string& name) {
    return test::slurp(std::string(RUNCERT_SOURCE_DIR) + "/tests/golden/" + name);
}

/// The table row by row, put together again.
template <class Table, class Open>
Table gathered(const std::string& text, Open open) {
    OpenTable<Table> opened = open(text, "f");
    Table table = opened.head;
    EXPECT_TRUE(table.rows.empty());
    for (typename OpenTable<Table>::Row row; opened.rows.next(row);)
        table.rows.push_back(row);
    EXPECT_EQ(opened.rows.offset(), text.size());
    return table;
}

TEST(StreamedRecording, ReadsWhatReadingTheWholeReads) {
    const std::string observations = golden("v1.0/1-observations.ecsv");
    EXPECT_EQ(write_observations(gathered<Observations>(observations, open_observations)),
              write_observations(read_observations(observations, "f")));
    const std::string enu = golden("v1.0/2-enu.ecsv");
    EXPECT_EQ(write_enu(gathered<EnuTable>(enu, open_enu)), write_enu(read_enu(enu, "f")));
    const std::string screened = golden("v1.0/3-screened.ecsv");
    EXPECT_EQ(write_screened(gathered<ScreenedTable>(screened, open_screened)),
              write_screened(read_screened(screened, "f")));
    const std::string trajectory = golden("v1.0/4-trajectory.ecsv");
    EXPECT_EQ(write_trajectory(gathered<TrajectoryTable>(trajectory, open_trajectory)),
              write_trajectory(read_trajectory(trajectory, "f")));
}

TEST(StreamedRecording, WritesWhatWritingTheWholeWrites) {
    const EnuTable enu = read_enu(golden("v1.0/2-enu.ecsv"), "f");
    ASSERT_FALSE(enu.rows.empty());
    std::string text;
    TableWriter<EnuEpoch> enu_rows =
        begin_enu(enu, [&text](std::string_view piece) { text += piece; });
    for (const EnuEpoch& row : enu.rows)
        enu_rows.write(row);
    enu_rows.finish();
    EXPECT_EQ(text, write_enu(enu));

    const Observations observations = read_observations(golden("v1.0/1-observations.ecsv"), "f");
    ASSERT_FALSE(observations.rows.empty());
    text.clear();
    TableWriter<Observation> rows =
        begin_observations(observations, [&text](std::string_view piece) { text += piece; });
    for (const Observation& row : observations.rows)
        rows.write(row);
    rows.finish();
    EXPECT_EQ(text, write_observations(observations));
}

TEST(StreamedRecording, ABadCellFailsAsInTheWhole) {
    std::string text = golden("v1.0/2-enu.ecsv");
    text[text.rfind('.')] = 'x';  // in the last row
    const auto whole = failure_of([&] { read_enu(text, "f"); });
    const auto streamed = failure_of([&] { gathered<EnuTable>(text, open_enu); });
    EXPECT_FALSE(whole.problem.empty());
    EXPECT_EQ(whole.where, streamed.where);
    EXPECT_EQ(whole.problem, streamed.problem);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
