// Files that change while a batch reads them.
#include "batch_bad_days.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// The programs, of which import first does something once: what `happens` says, in a shell.
fs::path programs_in_which(const fs::path& folder, const std::string& happens) {
    fs::create_directories(folder);
    for (const auto& entry : fs::directory_iterator(RUNCERT_PROGRAMS)) {
        const std::string name = entry.path().filename().string();
        if (name == "runcert")
            fs::copy_file(entry.path(), folder / name);
        else if (name.starts_with("runcert-") && name != "runcert-import")
            fs::create_symlink(entry.path(), folder / name);
    }
    const fs::path import = folder / "runcert-import";
    std::ofstream(import) << "#!/bin/sh\nimport() { " RUNCERT_PROGRAMS
                             "/runcert-import \"$@\"; }\ncd "
                          << folder.parent_path()
                          << "/day\nif mkdir ../happened 2>/dev/null; then\n"
                          << happens << "\nelse\n  import \"$@\"\nfi\n";
    fs::permissions(import, fs::perms::owner_all);
    return folder / "runcert";
}

TEST_F(BadDays, WhatChangesWhileARunIsMadeIsNeverTakenForWhatItWas) {
    make_day(path("other"), 2, 110);
    fs::copy_file(path("other/recordings/0002.pos"), path("other.pos"));
    write("a.yaml", attempt("a"));
    std::ofstream(day() / "rule.yaml")
        << read_file(fs::path(RUNCERT_SOURCE_DIR) / "stages/check/profiles/nalsa.yaml");
    edit(day() / "rule.yaml", "id: nalsa", "id: rule");
    edit(day() / "a.yaml", "[nalsa]", "[rule.yaml]");
    ASSERT_EQ(run().exit_status, 0);
    const auto undisturbed = contents_of(out() / "a");
    // Each is put back before anybody can look at it.
    const std::vector<std::pair<std::string, std::string>> swapped{
        {"run.pos", "cp ../other.pos run.pos"},
        {"rule.yaml", "sed -i 's/duration_s: 3/duration_s: 4/' rule.yaml"},
        {"a.yaml", "sed -i 's/recording: /height_m: 5, recording: /' a.yaml"}};
    for (const auto& [name, change] : swapped) {
        const fs::path results = path("out " + name);
        fs::remove_all(path("happened"));
        fs::remove_all(path("bin"));
        const std::string program =
            programs_in_which(path("bin"), fmt::format("  cp {0} ../kept\n  {1}\n  import \"$@\"\n"
                                                       "  status=$?\n  cp ../kept {0}\n"
                                                       "  exit $status",
                                                       name, change))
                .string();
        const BatchSaid said = batch_json(day(), results, {"--no-render"}, program);
        if (name != "a.yaml") {  // which is read once, before
            EXPECT_EQ(said.exit_status, 2) << name;
            EXPECT_TRUE(holds(said.problems.at("a"), "changed while it was read"))
                << said.problems.at("a");
        }
        EXPECT_EQ(batch_json(day(), results, {"--no-render"}, program).exit_status, 0);
        auto made = contents_of(results / "a");
        made["run.yaml"] = undisturbed.at("run.yaml");
        EXPECT_EQ(made, undisturbed) << name;
    }
}

TEST_F(BadDays, AnIdThatChangesWhileTheBatchRunsIsSaid) {
    write("a.yaml", attempt("a"));
    write("b.yaml", attempt("b"));
    const std::string program =
        programs_in_which(path("bin"), "  sed -i 's/id: b/id: c/' b.yaml\n  import \"$@\"")
            .string();
    const BatchSaid said = batch_json(day(), out(), {"--no-render"}, program);
    EXPECT_EQ(said.exit_status, 2);
    EXPECT_EQ(said.states.at("a"), "done");
    EXPECT_TRUE(holds(said.problems.at("b"), "the id is \"c\"")) << said.problems.at("b");
    EXPECT_FALSE(fs::exists(out() / "c"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
