#include <gtest/gtest.h>

#include "reports/explain/explain.h"
#include "store/atomic_file.h"

namespace runcert::RUNCERT_FILE {
namespace {

TEST(Origins, TheTableOfTheMethodIsMadeFromTheDeclarations) {
    const std::string table = inputs_table_text();
    for (const char* line :
         {"| `record` | claimed | outcome | the rule's by `margin`, else record-to-beat (judge) |",
          "| `gates.file` | handed in | uncertainty | gates-as-measured (measurer) |",
          "| `receivers[].solution` | claimed | uncertainty, requirements | kind-of-solution "
          "(measurer) |"})
        EXPECT_NE(table.find(line), std::string::npos) << line;
    const std::string method = read_file(std::string(RUNCERT_SOURCE_DIR) + "/reports/METHOD.md");
    EXPECT_NE(method.find(table), std::string::npos)
        << "Put what `runcert explain --inputs` prints into reports/METHOD.md:\n"
        << table;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
