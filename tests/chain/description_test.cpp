#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "chain_support.h"
#include "schemas/observations/observations.h"
#include "schemas/recognition/declared.h"
#include "stages/import/recognise.h"
#include "store/yaml_input.h"

// What inspect says of a file, what new writes of it and what certify then reads is one thing.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// The recordings at hand: those of people, the cases beside them, and tables of other programs.
std::vector<fs::path> all_files() {
    std::vector<fs::path> folders{fs::path(RUNCERT_SOURCE_DIR) / "tests/chain/data/tables",
                                  fs::path(RUNCERT_SOURCE_DIR) / "examples"};
    if (const auto data = recordings())
        for (const fs::path& more :
             {*data, data->parent_path() / "cases", data->parent_path() / "cases-4"})
            if (fs::is_directory(more)) folders.push_back(more);
    std::vector<fs::path> files;
    for (const fs::path& folder : folders)
        for (const auto& entry : fs::recursive_directory_iterator(folder)) {
            const std::string suffix = entry.path().extension().string();
            if (entry.is_regular_file() && suffix != ".md" && suffix != ".yaml" &&
                suffix != ".py" && suffix != ".html")
                files.push_back(entry.path());
        }
    std::ranges::sort(files);
    return files;
}

/// What stands in for what a person would answer.
std::string stand_in(const NeededKey& needed) {
    static const std::map<std::string, std::string> answers{{"accuracy.horizontal_m", "1"},
                                                            {"accuracy.vertical_m", "2"},
                                                            {"height_m", "0"},
                                                            {"start_date", "2026-03-14"},
                                                            {"frame", "31 north"}};
    const auto known = answers.find(needed.key);
    return needed.key == "height_m" || needed.values.empty()
               ? (known == answers.end() ? "unanswered" : known->second)
               : needed.values.front();
}

bool says_bursts(const Recognition& is) {
    return std::ranges::any_of(is.concerns, [](const Concern& one) {
        return one.says.find("in bursts") != std::string::npos;
    });
}

/// The attempt that `new` writes of a file in its folder.
ProcessResult make_new(const fs::path& file, const Recognition& is) {
    std::vector<std::string> words{"new",
                                   file.string(),
                                   "--no-questions",
                                   "--out",
                                   (file.parent_path() / "attempt.yaml").string(),
                                   "--craft",
                                   "any",
                                   "--class",
                                   "car",
                                   "--rule",
                                   "nalsa"};
    for (const NeededKey& needed : is.needed)
        if (needed.required)
            words.insert(words.end(), {"--set", needed.key + "=" + stand_in(needed)});
    return runcert(words);
}

void expect_one_reading(const fs::path& file) {
    const TemporaryFolder folder;
    const fs::path brought = folder.path() / bring(file, folder.path());
    const ProcessResult inspected = runcert({"inspect", "--json", brought.string()});
    Recognition is;
    if (inspected.exit_status == 0)
        is = read_members<Recognition>(YamlValue(parse_yaml(inspected.output, "said"), "said"));
    if (is.kind == RecordingKind::signals) return;  // positions come of two files
    const ProcessResult made = make_new(brought, is);
    const bool positions = inspected.exit_status == 0 && is.kind == RecordingKind::positions;
    EXPECT_EQ(made.exit_status, positions ? 0 : 2) << made.output << made.errors;
    if (!positions || made.exit_status != 0) return;
    EXPECT_EQ(made.output.find("not yet"), std::string::npos) << made.output;
    const fs::path run = folder.path() / "run";
    fs::create_directory(run);
    const ProcessResult imported =
        run_process({RUNCERT_PROGRAMS "/runcert-import", "--attempt",
                     (folder.path() / "attempt.yaml").string(), "--run-dir", run.string()});
    ASSERT_EQ(imported.exit_status, says_bursts(is) ? 2 : 0) << imported.errors;
    if (imported.exit_status != 0) return;
    const std::string name = "1-observations.ecsv";
    const Observations read = read_observations(read_file(run / name), name);
    EXPECT_EQ(read.format, is.format);
    EXPECT_EQ(static_cast<std::int64_t>(read.rows.size()), is.epochs);
    const Recognition of_rows = recognition_of(read, {});
    const bool date_is_asked =
        std::ranges::find(is.needed, "start_date", &NeededKey::key) != is.needed.end();
    if (is.first && !date_is_asked) {
        EXPECT_EQ(to_iso(*of_rows.first), to_iso(*is.first));
    }
    EXPECT_EQ(of_rows.speed_m_s.has_value(), is.speed_m_s.has_value());
    if (is.speed_m_s) {
        EXPECT_NEAR(*of_rows.speed_m_s, *is.speed_m_s, 1e-3 + 1e-6 * *is.speed_m_s);
    }
}

TEST(Description, InspectNewAndCertifyReadEveryFileAlike) {
    const std::vector<fs::path> files = all_files();
    ASSERT_GE(files.size(), 12U);
    for (const fs::path& file : files) {
        SCOPED_TRACE(file.string());
        expect_one_reading(file);
    }
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
