#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "store/atomic_file.h"

// Every citation key stands in REFERENCES.md, and every entry there is cited.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

/// What looks like a key: capitals, perhaps with figures ("[GUM-S1]"), or a name and a year
/// ("[Kuhn55]").
std::set<std::string> keys_in(const std::string& text) {
    static const std::regex key(R"(\[([A-Z]{2,}[A-Za-z0-9-]*|[A-Z][a-z]+[0-9]{2})\])");
    std::set<std::string> keys;
    for (std::sregex_iterator at(text.begin(), text.end(), key), end; at != end; ++at)
        keys.insert((*at)[1].str());
    return keys;
}

/// Words in brackets on command lines and in the format of messages.
const std::set<std::string> no_keys{"OPTIONS", "CLAUSE", "CTEST", "OK", "PDF"};

/// The keys of all sources, with a file that cites each.
std::map<std::string, std::string> cited() {
    const fs::path source(RUNCERT_SOURCE_DIR);
    const std::set<std::string> kinds{".cpp", ".h", ".yaml", ".js", ".html", ".md"};
    std::map<std::string, std::string> files;
    for (const char* part : {"pipeline", "schemas", "stages", "reports", "tests", "examples"})
        for (const auto& entry : fs::recursive_directory_iterator(source / part)) {
            if (!entry.is_regular_file() || !kinds.contains(entry.path().extension().string()) ||
                entry.path().string().find("/vendor/") != std::string::npos ||
                entry.path().string().find("/node_modules/") != std::string::npos ||
                entry.path().filename() == fs::path(__FILE__).filename())
                continue;
            for (const std::string& key : keys_in(read_file(entry.path())))
                if (!no_keys.contains(key)) files.emplace(key, entry.path().string());
        }
    return files;
}

TEST(References, OfEveryKeyAreListedAndEveryEntryIsCited) {
    const std::set<std::string> listed =
        keys_in(read_file(fs::path(RUNCERT_SOURCE_DIR) / "REFERENCES.md"));
    const auto files = cited();
    for (const auto& [key, file] : files)
        EXPECT_TRUE(listed.contains(key))
            << "[" << key << "] in " << file << ": add it to REFERENCES.md";
    for (const std::string& key : listed)
        EXPECT_TRUE(files.contains(key)) << "nothing cites [" << key << "]: take it out";
    EXPECT_GE(files.size(), 20u);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
