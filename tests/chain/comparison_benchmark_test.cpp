#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "chain_support.h"

// tests/benchmark/run at its smallest size: that the programs at hand agree, that one which is
// missing, fails or is wrong is found, and that options that are wrong are refused.

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Json = nlohmann::json;

const fs::path benchmark = fs::path(RUNCERT_SOURCE_DIR) / "tests/benchmark/run";

struct Measured {
    ProcessResult process;
    Json figures;

    const Json& programs() const { return figures.at("sizes").at(0).at("programs"); }
    std::string missing() const { return figures.at("missing").dump(); }
    /// Of a requirement: true, false, or null where it was not measured.
    Json is_met(const std::string& what) const {
        for (const Json& one : figures.at("requirements"))
            if (one.at("what") == what) return one.at("met");
        ADD_FAILURE() << what;
        return nullptr;
    }
};

class ComparisonBenchmark : public testing::Test {
  protected:
    void SetUp() override {
        if (!fs::exists("/usr/bin/python3")) GTEST_SKIP() << "python3 is not installed";
    }

    ProcessResult run(std::vector<std::string> arguments, const Environment& environment = {}) {
        arguments.insert(arguments.begin(), {benchmark.string(), "--build", RUNCERT_BUILD, "--out",
                                             (folder.path() / "out").string()});
        return run_process(arguments, {.environment = environment});
    }

    /// At the smallest size, once.
    Measured measured(std::vector<std::string> more, const Environment& environment = {}) {
        const fs::path json = folder.path() / "figures.json";
        std::vector<std::string> arguments{"--epochs", "451",    "--repeats",
                                           "1",        "--json", json.string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        Measured result{.process = run(arguments, environment), .figures = {}};
        if (result.process.exit_status < 2) result.figures = Json::parse(read_file(json));
        return result;
    }

    /// A PATH that begins with an octave-cli that is this script.
    std::string path_with_octave(const std::string& script) {
        const fs::path program = folder.path() / "bin/octave-cli";
        fs::create_directories(program.parent_path());
        write_file_atomically(program, "#!/bin/sh\n" + script);
        fs::permissions(program, fs::perms::owner_all);
        return program.parent_path().string() + ":/usr/bin:/bin";
    }

    TemporaryFolder folder;
};

void expect_spread(const Json& figure) {
    const double lower = figure.at("lower"), median = figure.at("median"),
                 upper = figure.at("upper");
    EXPECT_TRUE(0.0 < lower && lower <= median && median <= upper) << figure;
}

/// Whether the exit status is 1 just where a requirement is not met.
void expect_status_of_requirements(const Measured& found) {
    bool unmet = false;
    for (const Json& one : found.figures.at("requirements"))
        unmet = unmet || one.at("met") == false;
    EXPECT_EQ(found.process.exit_status, unmet ? 1 : 0);
}

TEST_F(ComparisonBenchmark, ProgramsAtHandAgree) {
    const fs::path page = folder.path() / "page.md";
    write_file_atomically(
        page,
        "before\n<!-- comparison: begin -->\nstale page\n<!-- comparison: end -->\n"
        "after\n");
    const Measured found = measured({"--readme", page.string()});
    ASSERT_LT(found.process.exit_status, 2) << found.process.errors;
    expect_status_of_requirements(found);
    EXPECT_EQ(found.figures["sizes"][0]["failed"], Json::object());
    for (const char* own : {"library", "eigen", "ceres", "certify", "tables", "nmea"})
        EXPECT_TRUE(found.programs().contains(own)) << own;
    for (const auto& [other, word] :
         {std::pair{"octave", "octave-cli"}, {"numpy", "numpy"}, {"statsmodels", "statsmodels"}})
        EXPECT_NE(found.programs().contains(other), found.missing().find(word) != std::string::npos)
            << other;
    for (const char* key :
         {"eigen", "ceres", "octave", "numpy", "statsmodels", "statsmodels-all"}) {
        if (!found.programs().contains(key)) continue;
        expect_spread(found.programs()[key].at("seconds"));
        const Json& agreement = found.programs()[key].at("agreement");
        EXPECT_LT(agreement.at("means_in_sigmas"), 1e-6) << key;
        const Json& sigmas = agreement.at("sigmas_relative");  // Ceres gives none
        EXPECT_TRUE(sigmas.is_null() ? key == std::string("ceres") : sigmas < 1e-6) << key;
    }
    EXPECT_EQ(found.is_met("smoothers: largest difference"), true);

    const std::string text = read_file(page);
    EXPECT_TRUE(text.starts_with("before\n<!-- comparison: begin -->\n"));
    EXPECT_TRUE(text.ends_with("<!-- comparison: end -->\nafter\n"));
    EXPECT_EQ(text.find("stale page"), std::string::npos);
    EXPECT_NE(text.find(found.process.output), std::string::npos) << "the tables that it printed";
    const bool drawn = found.missing().find("gnuplot") == std::string::npos;
    EXPECT_EQ(fs::exists(folder.path() / "comparison.svg"), drawn);
    EXPECT_FALSE(fs::exists(folder.path() / "out/451")) << "data are removed";
}

TEST_F(ComparisonBenchmark, TimesOfTheStagesAddUpToTheRun) {
    const Measured found = measured({"--only", "certify"});
    ASSERT_LT(found.process.exit_status, 2) << found.process.errors;
    const Json& certify = found.programs().at("certify");
    double stages = 0.0;
    for (const char* stage : {"import", "enu", "screen", "smooth", "window", "check"}) {
        expect_spread(certify.at(std::string("stage ") + stage));
        stages += certify.at(std::string("stage ") + stage).at("median").get<double>();
    }
    const double run = certify.at("seconds").at("median");
    EXPECT_LT(stages, run + 0.01);
    const double report = certify.at("stage report").at("median");
    EXPECT_NEAR(run + report, certify.at("process_seconds").at("median"), 1e-9);
    EXPECT_EQ(found.programs().size(), 1u);
    EXPECT_NE(found.is_met("certify, 451 epochs"), nullptr);
    EXPECT_EQ(found.is_met("certify, 28,200 epochs"), nullptr);
}

TEST_F(ComparisonBenchmark, MissingProgramsAreSaidAndLeftOut) {
    const Measured found = measured({"--only", "eigen,octave,gpsbabel,rnx2rtkp"},
                                    {{"PATH", (folder.path() / "nothing").string()}});
    ASSERT_LT(found.process.exit_status, 2) << found.process.errors;
    for (const char* said : {"octave-cli is missing (apt-get install octave)",
                             "gpsbabel is missing (apt-get install gpsbabel)",
                             "rnx2rtkp is missing (apt-get install rtklib)",
                             "gnuplot is missing (apt-get install gnuplot-nox)"}) {
        EXPECT_NE(found.process.errors.find(said), std::string::npos) << said;
        EXPECT_NE(found.process.output.find(said), std::string::npos) << said;
        EXPECT_NE(found.missing().find(said), std::string::npos) << said;
    }
    EXPECT_TRUE(found.programs().contains("eigen"));
    EXPECT_TRUE(found.programs().contains("library")) << "what the others are compared with";
    EXPECT_FALSE(found.programs().contains("octave"));
    EXPECT_EQ(found.is_met("Octave / runcert"), nullptr);
}

TEST_F(ComparisonBenchmark, AWrongAnswerIsFound) {
    // Every position 1 um off, a ten-thousandth of its standard deviation.
    const std::string off =
        "/usr/bin/python3 - \"$7\" <<'EOF'\n"  // its arguments: four options, script, data
        "import array, pathlib, sys\n"
        "result = pathlib.Path(sys.argv[1])\n"
        "points = array.array('d', (result.parent / 'library.points').read_bytes())\n"
        "for i in range(0, len(points), 12):\n"
        "    points[i] += 1e-6\n"
        "result.write_bytes(points.tobytes())\n"
        "EOF\n"
        "echo '{\"seconds\": 1.0, \"filter_seconds\": 0.5}'\n";
    const Measured found = measured({"--only", "octave"}, {{"PATH", path_with_octave(off)}});
    ASSERT_EQ(found.process.exit_status, 1) << found.process.errors;
    EXPECT_EQ(found.is_met("smoothers: largest difference"), false);
    const double difference = found.programs().at("octave").at("agreement").at("means_in_sigmas");
    EXPECT_GT(difference, 1e-5);
    EXPECT_LT(difference, 1e-2);
}

TEST_F(ComparisonBenchmark, AProgramThatFailsIsSaid) {
    const Measured found = measured(
        {"--only", "octave"}, {{"PATH", path_with_octave("echo 'out of memory' >&2; exit 3\n")}});
    ASSERT_EQ(found.process.exit_status, 1) << found.process.errors;
    const std::string failed = found.figures["sizes"][0]["failed"].at("octave");
    EXPECT_NE(failed.find("ended with status 3: out of memory"), std::string::npos) << failed;
    EXPECT_EQ(found.is_met("programs that failed"), false);
    EXPECT_TRUE(found.programs().contains("library"));
}

TEST_F(ComparisonBenchmark, FiguresOfKnownTimesAreRight) {
    // Times that are powers of the epochs, and targets just reached and just missed.
    const std::string script = R"(
import sys
sys.path.insert(0, sys.argv[1])
from comparison.measure import spread
from comparison.requirements import Measured, exponents, requirements

def size(epochs, **seconds):
    times = {key: {"seconds": {"median": value}} for key, value in seconds.items()}
    times["certify"] = {
        "seconds": {"median": 44.9e-6 * epochs},
        "peak_bytes": {"median": epochs**0.75},
        "stage import": {"median": epochs**1.04},
        "stage enu": {"median": epochs**1.06},
    }
    return {"epochs": epochs, "programs": times, "failed": {}}

def met(sizes):
    measured = Measured(sizes)
    return {one.what: one.is_met() for one in requirements(measured, exponents(measured))}

smoothers = dict(library=1.0, eigen=1.42, octave=24.9, statsmodels=15.0)
sizes = [size(28_200, **smoothers), size(1_000_000), size(10_000_000)]
sizes.append(size(451))
sizes[-1]["programs"]["certify"]["stage import"]["median"] = 1e3  # no part of the slope
slopes = exponents(Measured(sizes))
assert abs(slopes["stage import"]["all"] - 1.04) < 1e-12, slopes
assert [pair["to"] for pair in slopes["stage enu"]["pairs"]] == [1_000_000, 10_000_000]
found = met(sizes)
assert found["runcert / plain Eigen"] is False
assert found["Octave / runcert"] is False
assert found["statsmodels, its fastest / runcert"] is True
assert found["statsmodels, as it comes / runcert"] is None
assert found["exponent of import"] is True
assert found["exponent of enu"] is False
assert found["exponent of screen"] is None
assert found["certify, 1,000,000 epochs"] is True
assert found["10,000,000 / 1,000,000, memory"] is True
assert met([size(28_200), size(60_000)])["exponent of import"] is None
assert spread([3.0, 1.0, 2.0, 5.0, 4.0])["upper"] == 4.0
)";
    const ProcessResult result =
        run_process({"/usr/bin/python3", "-B", "-c", script, benchmark.parent_path().string()});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
}

TEST_F(ComparisonBenchmark, WrongOptionsAreRefused) {
    const std::string nowhere = (folder.path() / "nowhere/f").string();
    const std::array<std::vector<std::string>, 8> cases{{{"--epochs", "451,many"},
                                                         {"--epochs", "3"},
                                                         {"--repeats", "0"},
                                                         {"--only", "octvae"},
                                                         {"--json", nowhere},
                                                         {"--readme", nowhere},
                                                         {"--build", nowhere},
                                                         {"--colour", "red"}}};
    for (const auto& options : cases) {
        const ProcessResult result = run(options);
        EXPECT_EQ(result.exit_status, 2) << options[0];
        const std::string& named = options[1] == nowhere ? nowhere : options[0];
        EXPECT_NE(result.errors.find(named), std::string::npos) << result.errors;
        EXPECT_EQ(result.errors.find("Traceback"), std::string::npos) << result.errors;
    }
    write_file_atomically(folder.path() / "page.md", "no marks\n");
    const ProcessResult unmarked = run({"--readme", (folder.path() / "page.md").string()});
    EXPECT_EQ(unmarked.exit_status, 2);
    EXPECT_NE(unmarked.errors.find("comparison: begin"), std::string::npos) << unmarked.errors;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
