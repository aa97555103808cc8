#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <sstream>

#include "chain_support.h"
#include "store/sha256.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// A run of the example that is refused, made once; each test forges a copy.
class Recompute : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder();
        const ProcessResult result =
            certify(examples / "rejected" / "attempt.yaml", folder_->path() / "run");
        ASSERT_NE(result.exit_status, 2) << result.errors;
    }
    static void TearDownTestSuite() {
        delete folder_;
        folder_ = nullptr;
    }
    /// Without the pages, which take longest to make again.
    void SetUp() override {
        fs::copy(folder_->path() / "run", run());
        for (const char* page : {"report.html", "certificate.pdf", "report.pdf"})
            fs::remove(run() / page);
    }
    void TearDown() override { fs::remove_all(run()); }

    static fs::path run() { return folder_->path() / "copy"; }
    static std::string recomputed() {
        return runcert({"verify", run().string(), "--recompute", "--keep-going"}).output;
    }
    static void expect_in(const std::string& text, const std::vector<std::string>& all) {
        for (const std::string& said : all)
            EXPECT_NE(text.find(said), std::string::npos) << said << "\n" << text;
    }

    /// Writes a file, and repairs every hash of it down the chain, as a forger would.
    static void forge(const std::string& name, const std::string& text) {
        std::map<std::string, std::string> changed{{digest_file(run() / name).sha256, ""}};
        changed.begin()->second = sha256_hex(text);
        write_file_atomically(run() / name, text);
        for (const char* later : {"2-enu.ecsv", "3-screened.ecsv", "4-trajectory.ecsv",
                                  "5-windows.yaml", "6-verdict.yaml", "report.json"}) {
            if (later <= name) continue;
            std::string repaired = read_file(run() / later);
            for (const auto& [from, to] : changed)
                for (std::size_t at = repaired.find(from); at != std::string::npos;
                     at = repaired.find(from))
                    repaired.replace(at, from.size(), to);
            changed[digest_file(run() / later).sha256] = sha256_hex(repaired);
            write_file_atomically(run() / later, repaired);
        }
    }

    /// A line of a table with another cell in a column, told by the names in its first line.
    struct Edited {
        std::string text;
        std::size_t line = 0;
        std::string before;
    };
    static Edited edit_cell(const std::string& table, const std::string& epoch,
                            const std::string& column, const std::string& to) {
        std::istringstream lines(table);
        Edited edited;
        std::size_t index = 0;
        bool named = false;
        std::size_t number = 0;
        for (std::string line; std::getline(lines, line); edited.text += line + "\n") {
            ++number;
            if (line.starts_with("#")) continue;
            std::vector<std::string> cells;
            std::istringstream row(line + ",");
            for (std::string cell; std::getline(row, cell, ',');)
                cells.push_back(cell);
            if (!named) {
                index = static_cast<std::size_t>(std::find(cells.begin(), cells.end(), column) -
                                                 cells.begin());
                named = true;
            } else if (cells[0] == epoch) {
                edited.line = number;
                edited.before = cells.at(index);
                cells[index] = to;
                line.clear();
                for (const std::string& cell : cells)
                    line += (line.empty() ? "" : ",") + cell;
            }
        }
        return edited;
    }

    static TemporaryFolder* folder_;
};
TemporaryFolder* Recompute::folder_ = nullptr;

TEST_F(Recompute, FilesAndReportAreIdentical) {
    expect_in(recomputed(), {"yes  recompute     identical: all 6 files, byte for byte"});
}

TEST_F(Recompute, AForgedCellIsNamedByStageLineAndColumn) {
    struct Forgery {
        std::string stage, file, epoch, column, to;
    };
    for (const Forgery& forgery :
         {Forgery{"import", "1-observations.ecsv", "300", "satellites", "31"},
          Forgery{"enu", "2-enu.ecsv", "12", "north", "123.456789"},
          Forgery{"screen", "3-screened.ecsv", "601", "reason", "burst"},
          Forgery{"smooth", "4-trajectory.ecsv", "400", "speed", "99.000000"}}) {
        const std::string original = read_file(run() / forgery.file);
        const Edited edited = edit_cell(original, forgery.epoch, forgery.column, forgery.to);
        ASSERT_NE(edited.line, 0U);
        ASSERT_NE(edited.before, forgery.to);
        forge(forgery.file, edited.text);
        const std::string text = recomputed();
        expect_in(text,
                  {"yes  files", "yes  chain",
                   fmt::format("NO   recompute     different, first at the stage {}: {}, line {}, "
                               "column {}: {} in the folder, {} recomputed",
                               forgery.stage, forgery.file, edited.line, forgery.column, forgery.to,
                               edited.before)});
        TearDown();
        SetUp();
    }
}

TEST_F(Recompute, ARemovedRowIsNamed) {
    const std::string original = read_file(run() / "4-trajectory.ecsv");
    const Edited found = edit_cell(original, "300", "speed", "");
    std::istringstream lines(original);
    std::string fewer;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);)
        if (++number != found.line) fewer += line + "\n";
    forge("4-trajectory.ecsv", fewer);
    expect_in(recomputed(), {"NO   recompute", "first at the stage smooth: 4-trajectory.ecsv",
                             fmt::format("like line {} recomputed", found.line)});
}

TEST_F(Recompute, AForgedHeaderAndVerdictAreNamed) {
    std::string text = read_file(run() / "4-trajectory.ecsv");
    std::size_t at = text.find("correlated_error_detected: false");
    ASSERT_NE(at, std::string::npos);
    forge("4-trajectory.ecsv", text.replace(at, 32, "correlated_error_detected: true "));
    expect_in(recomputed(),
              {"first at the stage smooth: 4-trajectory.ecsv, header "
               "estimation.horizontal.noise.correlated_error_detected: true in the folder, false"});
    TearDown();
    SetUp();
    text = read_file(run() / "6-verdict.yaml");
    at = text.find("outcome: not_certifiable");
    ASSERT_NE(at, std::string::npos);
    forge("6-verdict.yaml", text.replace(at, 24, "outcome: beaten"));
    expect_in(recomputed(), {"first at the stage check: 6-verdict.yaml, profiles.0.outcome: "
                             "\"beaten\" in the folder, \"not_certifiable\" recomputed"});
}

TEST_F(Recompute, AReportThatDoesNotFollowFromTheFilesIsFound) {
    std::string text = read_file(run() / "report.json");
    const std::size_t at = text.find("\"outcome\": \"not_certifiable\"");
    ASSERT_NE(at, std::string::npos);
    forge("report.json", text.replace(at, 28, "\"outcome\": \"beaten\""));
    expect_in(
        recomputed(),
        {"yes  files", "NO   contents      report.json is not what its files make",
         "report.json, verdict.profiles.0.", "\"beaten\" in the folder, \"not_certifiable\" recomputed"});
}

TEST_F(Recompute, TheHeaderOfAFileDoesNotSayHowItIsCompared) {
    // Whole metres per second instead of micrometres: half a unit of that would be a record.
    std::string text = read_file(run() / "4-trajectory.ecsv");
    const std::size_t column = text.find("name: speed\n");
    ASSERT_NE(column, std::string::npos);
    const std::size_t format = text.find("%.6f", column);
    ASSERT_NE(format, std::string::npos);
    forge("4-trajectory.ecsv", text.replace(format, 4, "%.0f"));
    expect_in(recomputed(), {"NO   recompute",
                             "4-trajectory.ecsv, column speed: its header states "
                             "another type, unit or format"});
    TearDown();
    SetUp();
    // Of the figures that decide not even the last digit, and of a text nothing.
    for (const auto& [file, from, to] : std::vector<std::array<std::string, 3>>{
             {"5-windows.yaml", "duration_s: 3.0", "duration_s: 2.0"},
             {"5-windows.yaml", "duration_s: 3.0", "duration_s: 3.00000001"},
             {"6-verdict.yaml", "duration_s: 3.0", "duration_s: 3"},
             {"6-verdict.yaml", "(k = 2", "(k = 3"}}) {
        text = read_file(run() / file);
        const std::size_t at = text.rfind(from);
        if (at == std::string::npos) {
            ADD_FAILURE() << file << ": " << from;
            continue;
        }
        forge(file, text.replace(at, from.size(), to));
        // 3 and 3.0 are one number.
        if (to != "duration_s: 3")
            expect_in(recomputed(), {"NO   recompute", "first at the stage"});
        TearDown();
        SetUp();
    }
}

TEST_F(Recompute, FilesOfAnotherProgramThatSayTheSameAreEqual) {
    for (const char* name : {"1-observations.ecsv", "2-enu.ecsv", "3-screened.ecsv",
                             "4-trajectory.ecsv", "5-windows.yaml", "6-verdict.yaml"}) {
        std::string text = read_file(run() / name);
        const std::size_t at = text.find("version: \"1.0.0\"");
        ASSERT_NE(at, std::string::npos) << name;
        forge(name, text.replace(at, 16, "version: \"0.9.9\""));
    }
    expect_in(recomputed(), {"yes  recompute     equal within 1/1000 of the stated uncertainty",
                             "note: the folder's files were made by runcert 0.9.9"});
    // What it says is compared to the letter.
    const std::string verdict = read_file(run() / "6-verdict.yaml");
    const std::size_t words = verdict.find("(k = 2");
    ASSERT_NE(words, std::string::npos);
    forge("6-verdict.yaml", std::string(verdict).replace(words, 6, "(k is 2"));
    expect_in(recomputed(),
              {"NO   recompute", "note: the folder's files were made by runcert 0.9.9"});
}

TEST_F(Recompute, NoParameterIsMissing) {
    std::string text = read_file(run() / "5-windows.yaml");
    const std::string said = "  plane_scale_bound: 0.001\n";
    const std::size_t at = text.find(said);
    ASSERT_NE(at, std::string::npos);
    forge("5-windows.yaml", text.erase(at, said.size()));
    expect_in(recomputed(),
              {"NO   recompute", "parameter plane_scale_bound: absent in the folder"});
}

/// The C library of a processor without fused multiply-add and AVX2 has other last bits in sin, exp
/// and log. Nothing on the way may make more of that than the tolerance.
/// The observations with another text between their inputs and what follows the parameters.
std::string with_origin(const std::string& text, const std::string& inputs,
                        const std::string& parameters) {
    const std::string at_inputs = "#   inputs:\n";
    const std::string at_parameters = "#   parameters:\n#     format: rtklib-pos\n";
    std::string changed = text;
    EXPECT_NE(changed.find(at_inputs), std::string::npos);
    EXPECT_NE(changed.find(at_parameters), std::string::npos);
    changed.replace(changed.find(at_parameters), at_parameters.size(), parameters);
    return changed.insert(changed.find(at_inputs) + at_inputs.size(), inputs);
}

TEST_F(Recompute, ObservationsRepeatWhatTheAttemptStatesOfTheirReceiver) {
    const std::string observations = read_file(run() / "1-observations.ecsv");
    const FileDigest attempt = digest_file(run() / "attempt.yaml");
    const std::string named = fmt::format(
        "#     - role: attempt\n#       file: attempt.yaml\n#       sha256: \"{}\"\n#       bytes: "
        "{}\n",
        attempt.sha256, attempt.bytes);
    const auto verified = [&](const std::string& inputs, const std::string& parameters) {
        forge("1-observations.ecsv", with_origin(observations, inputs, parameters));
        EXPECT_EQ(run_process({RUNCERT_PROGRAMS "/runcert-report", "--attempt",
                               (run() / "attempt.yaml").string(), "--run-dir", run().string(),
                               "--no-render"})
                      .exit_status,
                  0);
        return recomputed();
    };
    for (const std::string parameters :
         {"#   parameters: {}\n", "#   parameters:\n#     format: csv\n"})
        expect_in(verified(named, parameters),
                  {"NO   chain", "the recording was not read as attempt.yaml has it"});
}

TEST_F(Recompute, AnotherProcessorsLastBitsAreWithinTheTolerance) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    write_file_atomically(
        folder.path() / "attempt.yaml",
        fmt::format("schema: attempt/1.0\nid: recorded\ncraft: {{name: car, class: car}}\n"
                    "receivers: [{{id: primary, recording: \"{}\"}}]\nprofiles: [nalsa]\n",
                    bring(*data / "ppk_urban_car" / "rover.pos", folder.path())));
    const fs::path made = folder.path() / "run";
    ASSERT_NE(certify(folder.path() / "attempt.yaml", made, {"--no-render"}).exit_status, 2);
    const std::string text = runcert({"verify", made.string(), "--recompute"},
                                     {{"GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-FMA"}})
                                 .output;
    expect_in(text, {"yes  recompute",
                     "note: the mathematical library or the processor that "
                     "computed ("});
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
