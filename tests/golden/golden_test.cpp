#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "golden_files.h"
#include "store/sha256.h"

// All golden files alike. What the readers find in them: golden_tables_test.cpp,
// golden_results_test.cpp, golden_inputs_test.cpp.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

using golden::text_of;

TEST(Golden, WritingWhatWasReadGivesTheSameBytes) {
    for (const golden::GoldenFile& file : golden::all_files()) {
        SCOPED_TRACE(file.path);
        const std::string text = text_of(file.path);
        const std::string again = file.kind.again(text, file.path);
        EXPECT_TRUE(again == text || again.empty()) << again;
    }
}

TEST(Golden, EveryFileIsTested) {
    std::set<std::string> paths;
    for (const golden::GoldenFile& file : golden::all_files())
        paths.insert(file.path);
    const fs::path folder = std::string(RUNCERT_SOURCE_DIR) + "/tests/golden";
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_directory() || entry.path().parent_path() == folder) continue;
        ++count;
        EXPECT_TRUE(paths.contains(fs::relative(entry.path(), folder))) << entry.path();
    }
    EXPECT_EQ(count, paths.size());
}

// No file changes unawares.
TEST(Golden, FilesAreAsListed) {
    const fs::path folder = std::string(RUNCERT_SOURCE_DIR) + "/tests/golden";
    std::map<std::string, std::string> listed;
    std::istringstream list(text_of("SHA256SUMS"));
    for (std::string hash, file; list >> hash >> file;)
        listed[file] = hash;
    for (const golden::GoldenFile& file : golden::all_files()) {
        EXPECT_EQ(listed[file.path], sha256_hex(text_of(file.path)))
            << file.path
            << ": a golden file changed, or is not listed. Where a schema changed, recompute its "
               "line in tests/golden/SHA256SUMS (sha256sum); a file that a release holds stays.";
        listed.erase(file.path);
    }
    for (const auto& [file, hash] : listed)
        ADD_FAILURE() << file
                      << " is listed in tests/golden/SHA256SUMS and not there: take it back "
                      << "from the history.";
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
