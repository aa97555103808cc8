#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "handover_support.h"
#include "store/external_program.h"
#include "trust/verification.h"

// Verification where a program is missing, or is another than made the run: what holds is said to
// hold, and what could not be checked is said in the last line.

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Json = nlohmann::json;

/// What `verify` says to programs; `last_line` is what people read last.
struct Found {
    int exit_status = 0;
    std::string text{};
    std::string last_line{};
    Json layers{};

    Json layer(const std::string& name) const {
        for (const Json& one : layers)
            if (one["layer"] == name) return one;
        ADD_FAILURE() << "no layer " << name << " in " << text;
        return Json::object({{"answer", nullptr}});
    }
    std::string answer(const std::string& name) const { return layer(name)["answer"]; }
    bool says(const std::string& name, const std::string& part) const {
        return holds(layer(name).dump(), part);
    }
};

Found verified(std::vector<std::string> arguments, const Environment& env = {}) {
    arguments.insert(arguments.begin(), {"verify", "--json"});
    const ProcessResult result = runcert(arguments, env);
    Found found{.exit_status = result.exit_status, .text = result.output + result.errors};
    const Json json = Json::parse(result.output, nullptr, false);
    EXPECT_TRUE(json.is_object()) << found.text;
    if (!json.is_object()) return found;
    EXPECT_EQ(json["exit_status"], found.exit_status);
    found.last_line = json["verdict"];
    found.layers = json["layers"];
    return found;
}

/// The programs of others that are here, by links in a folder, but for those of a package.
class ProgramsHere {
  public:
    explicit ProgramsHere(std::string_view hidden_package = "") {
        for (const ExternalProgram& program : external_programs()) {
            const fs::path file = external_program_file(program.name);
            if (!file.empty() && program.package != hidden_package)
                fs::create_symlink(file, folder_.path() / program.name);
        }
    }
    /// Puts a script in the place of one.
    void replace(const std::string& name, const std::string& script) const {
        const fs::path file = folder_.path() / name;
        fs::remove(file);
        write_quickly(file, "#!/bin/sh\n" + script + "\n");
        fs::permissions(file, fs::perms::owner_all | fs::perms::group_exec |
                                  fs::perms::others_exec | fs::perms::others_read);
    }
    Environment env() const { return {{"RUNCERT_EXTERNAL_PATH", folder_.path().string()}}; }

  private:
    TemporaryFolder folder_;
};

/// A signed run with its pages, made once; each test has a copy.
class ThreeAnswers : public testing::Test {
  protected:
    static void SetUpTestSuite() { original_ = new SignedRun("land_yacht", "--brief"); }
    static void TearDownTestSuite() { delete original_; }
    void SetUp() override {
        for (const char* program : {"weasyprint", "pdfinfo"})
            if (external_program_file(program).empty())
                GTEST_SKIP() << program << " is not installed";
        fs::copy(original_->run(), run(), fs::copy_options::recursive);
    }
    fs::path run() const { return folder_.path() / "run"; }
    fs::path path(const std::string& name) const { return folder_.path() / name; }
    Found found(const Environment& env = {}, std::vector<std::string> more = {}) const {
        more.insert(more.begin(), {run().string(), "--pubkey", original_->public_key()});
        return verified(more, env);
    }
    /// Text of a file of the run changed, at its first place.
    void change(const std::string& file, const std::string& from, const std::string& to) const {
        std::string text = read_file(run() / file);
        const std::size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << file << ": " << from;
        write_quickly(run() / file, text.replace(at, from.size(), to));
    }
    /// A page as WeasyPrint makes it of that text, which carries the run's report.
    void forge_pdf(const std::string& html) const {
        write_quickly(path("page.html"), html);
        const ProcessResult made = run_process(
            {"weasyprint", "--pdf-variant", "pdf/ua-1", "-a", (run() / "report.json").string(),
             path("page.html").string(), (run() / "certificate.pdf").string()});
        ASSERT_EQ(made.exit_status, 0) << made.errors;
    }
    /// The title of the genuine PDF, which a forger copies.
    std::string title() const {
        const Json report = Json::parse(read_file(run() / "report.json"))["predicate"];
        return "Measurement report " + report["report_id"].get<std::string>() + ": " +
               report["attempt"]["id"].get<std::string>();
    }

    static inline SignedRun* original_ = nullptr;
    TemporaryFolder folder_;
};

TEST_F(ThreeAnswers, WhereAllIsHereAllIsVerified) {
    const Found all = found({}, {"--recompute"});
    EXPECT_EQ(all.exit_status, 0) << all.text;
    EXPECT_EQ(all.last_line, "VERIFIED");
    for (const char* layer : {"files", "chain", "schemas", "rules", "report", "contents",
                              "signatures", "pages", "recompute"})
        EXPECT_EQ(all.answer(layer), "verified") << layer;
    for (const char* layer : {"time stamps", "attestations"})
        EXPECT_EQ(all.answer(layer), "nothing to check") << layer;
}

TEST_F(ThreeAnswers, WithoutWeasyPrintThePdfAloneIsNotChecked) {
    const ProgramsHere without("weasyprint");
    const Found some = found(without.env(), {"--recompute"});
    EXPECT_EQ(some.exit_status, 0) << some.text;
    EXPECT_EQ(some.last_line, "VERIFIED; pages not checked here");
    EXPECT_TRUE(some.says("pages", "report.html: identical"));
    EXPECT_TRUE(some.says("pages",
                          "certificate.pdf: not checked here: weasyprint is not installed here "
                          "(package weasyprint)"));
}

TEST_F(ThreeAnswers, WhatTheRunDoesNotNeedIsNotMissed) {
    for (const char* package :
         {"gpsbabel", "rtklib", "poppler-utils", "libpodofo-utils", "openssl"}) {
        const ProgramsHere without(package);
        EXPECT_EQ(found(without.env(), {"--recompute"}).last_line, "VERIFIED") << package;
    }
}

TEST_F(ThreeAnswers, WithoutBubblewrapTheAnswersAreTheSame) {
    const std::string hidden = "mount --bind /dev/null /usr/bin/bwrap; ";
    if (!has_sandbox() ||
        run_process({"unshare", "-m", "sh", "-c", hidden + "true"}).exit_status != 0)
        GTEST_SKIP() << "bubblewrap cannot be hidden here";
    const ProcessResult said =
        run_process({"unshare", "-m", "sh", "-c",
                     fmt::format("{}{}/runcert verify {} --pubkey {} --recompute", hidden,
                                 RUNCERT_PROGRAMS, run().string(), original_->public_key())});
    EXPECT_EQ(said.exit_status, 0) << said.output << said.errors;
    EXPECT_TRUE(said.output.ends_with("\nVERIFIED\n")) << said.output;
    EXPECT_TRUE(holds(said.output, "The sandbox is not in force (bubblewrap is not installed)"));
}

// A page that somebody changed must not hide behind a program that is missing.
TEST_F(ThreeAnswers, AForgedPageIsFoundWithoutARenderer) {
    const std::string page = read_file(run() / "report.html");
    const ProgramsHere no_poppler("poppler-utils"), no_weasyprint("weasyprint");
    const std::string drawing = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=";
    std::string redrawn = page;
    redrawn.replace(redrawn.find("L", redrawn.find("<path d=\"", redrawn.find(drawing))), 1, "M");
    std::string undrawn = page;
    const std::size_t image = undrawn.find(drawing);
    undrawn.erase(image, undrawn.find("</svg>", image) + 6 - image);
    std::string faster = page;
    faster.replace(faster.find(" km/h ±") - 1, 1, "9");
    fs::remove(run() / "certificate.pdf");
    for (const std::string& forged : {redrawn, undrawn, faster, page + " ", std::string("<html>")})
        for (const auto* programs : {&no_poppler, &no_weasyprint}) {
            write_quickly(run() / "report.html", forged);
            const Found no = found(programs->env());
            EXPECT_EQ(no.exit_status, 1) << no.text;
            EXPECT_EQ(no.last_line, "NOT VERIFIED");
            EXPECT_TRUE(no.says("pages", "report.html: it")) << no.text;
        }
}

TEST_F(ThreeAnswers, AForgedPdfIsFoundWhereTheRendererIsAndNeverCalledVerifiedElsewhere) {
    forge_pdf("<title>" + title() + "</title><p>999.99 km/h</p>");
    Found said = found();
    EXPECT_EQ(said.last_line, "NOT VERIFIED") << said.text;
    EXPECT_TRUE(said.says("pages", "do not go by what it shows")) << said.text;
    const ProgramsHere without("weasyprint");
    said = found(without.env(), {"--recompute"});
    EXPECT_EQ(said.exit_status, 0) << said.text;
    EXPECT_EQ(said.last_line, "VERIFIED; pages not checked here");
    // It says that another renderer made it, which nobody can check; its first page says it all.
    change("certificate.pdf", "WeasyPrint ", "WeasyPrunt ");
    said = found();
    EXPECT_EQ(said.last_line, "NOT VERIFIED") << said.text;
    EXPECT_TRUE(said.says("pages", "its first page says other than is rendered")) << said.text;
    // What it carries is compared whatever is missing.
    write_quickly(path("report.json"), read_file(run() / "report.json") + " ");
    const ProcessResult made =
        run_process({"weasyprint", "-a", path("report.json").string(), path("page.html").string(),
                     (run() / "certificate.pdf").string()});
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    said = found(without.env());
    EXPECT_EQ(said.last_line, "NOT VERIFIED") << said.text;
    EXPECT_TRUE(said.says("pages", "the report attached to it is not report.json")) << said.text;
}

// An honest page of another version: which it is only the file itself says.
TEST_F(ThreeAnswers, APdfOfAnotherRendererIsNotCheckable) {
    const ProgramsHere others;
    others.replace("weasyprint",
                   "/usr/bin/weasyprint \"$@\" && sed -i 's/(WeasyPrint [0-9]/(WeasyPrint 9/' "
                   "report.pdf");
    const auto render = [&](const Environment& env) {
        return run_process({RUNCERT_PROGRAMS "/runcert-report", "--render-only", "--page",
                            "report.html", "--page", "certificate.pdf", "--attempt",
                            (run() / "attempt.yaml").string(), "--run-dir", run().string()},
                           {.environment = env});
    };
    const ProcessResult made = render(others.env());
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    EXPECT_EQ(found(others.env()).last_line, "SIGNED, NOT RECOMPUTED");
    Found said = found({}, {"--recompute"});
    EXPECT_EQ(said.exit_status, 0) << said.text;
    EXPECT_EQ(said.last_line, "VERIFIED; pages not checked here");
    EXPECT_TRUE(said.says("pages", "report.html: identical"));
    EXPECT_TRUE(
        said.says("pages", "certificate.pdf: not checked here: it was made by WeasyPrint 9"))
        << said.text;
    EXPECT_TRUE(said.says("pages", ", here is WeasyPrint ")) << said.text;
    // Of the same version with other fonts; what its first page says does not depend on them.
    if (run_process({"fc-list", "FreeSans"}).output.empty()) return;
    others.replace(
        "weasyprint",
        "sed 's/DejaVu Sans/FreeSans/g' report.html > other.html; mv other.html report.html; "
        "exec /usr/bin/weasyprint \"$@\"");
    ASSERT_EQ(render(others.env()).exit_status, 0);
    said = found();
    EXPECT_EQ(said.last_line, "SIGNED, NOT RECOMPUTED; pages not checked here");
    EXPECT_TRUE(said.says("pages", "it was made with the fonts ")) << said.text;
}

/// A run that the program of a package made a table for.
struct Imported {
    std::string package;
    std::string program;
    std::string receiver;  ///< of the attempt
};

class WithoutConverter : public testing::TestWithParam<Imported> {};

TEST_P(WithoutConverter, ImportIsNotCheckableAndTheLaterStagesAre) {
    const Imported& one = GetParam();
    if (external_program_file(one.program).empty()) GTEST_SKIP() << one.program << " is missing";
    const auto data = recordings();
    if (!data && one.package == "rtklib") GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    std::string points;
    for (int i = 0; i < 60; ++i)
        points += fmt::format(
            "<Trackpoint><Time>2019-04-12T00:39:{:02}Z</Time><Position><LatitudeDegrees>{:.7f}"
            "</LatitudeDegrees><LongitudeDegrees>-1.3000000</LongitudeDegrees></Position>"
            "<AltitudeMeters>10.0</AltitudeMeters></Trackpoint>",
            i, 54.3 + i * 1e-4);
    write_quickly(
        folder.path() / "track.tcx",
        "<?xml version=\"1.0\"?><TrainingCenterDatabase><Activities><Activity Sport=\"Other\">"
        "<Id>2019-04-12T00:39:00Z</Id><Lap StartTime=\"2019-04-12T00:39:00Z\"><Track>" +
            points + "</Track></Lap></Activity></Activities></TrainingCenterDatabase>");
    if (one.package == "rtklib")
        for (const char* name : {"rover.obs", "master.obs", "rover.nav"})
            bring(*data / "rinex_pair" / (std::string("yamatogawa_") + name), folder.path());
    write_quickly(folder.path() / "attempt.yaml",
                  "schema: attempt/1.0\nid: converted\ncraft: {name: y, class: land-yacht}\n"
                  "receivers:\n  - {id: primary, " +
                      one.receiver + "}\nprofiles: [nalsa]\n");
    const std::string key = (folder.path() / "measurer").string();
    ASSERT_EQ(runcert({"keygen", "--out", key, "--no-password"}).exit_status, 0);
    const ProcessResult made =
        certify(folder.path() / "attempt.yaml", run, {"--no-render", "--key", key + ".key"});
    ASSERT_LT(made.exit_status, 2) << made.errors;
    const ProgramsHere without(one.package);
    const auto verify = [&](const Environment& env, std::vector<std::string> more) {
        more.insert(more.begin(), {run.string(), "--pubkey", key + ".pub"});
        return verified(more, env);
    };
    EXPECT_EQ(verify({}, {"--recompute"}).last_line, "VERIFIED");
    const Found plain = verify(without.env(), {});
    EXPECT_EQ(plain.exit_status, 0) << plain.text;
    EXPECT_EQ(plain.last_line, "SIGNED, NOT RECOMPUTED");
    // What was asked for could not be done.
    const Found some = verify(without.env(), {"--recompute"});
    EXPECT_EQ(some.exit_status, 2) << some.text;
    EXPECT_EQ(some.last_line, "SIGNED, NOT RECOMPUTED; recompute not checked here");
    EXPECT_TRUE(
        some.says("recompute", fmt::format("import not checked here: {} is not installed here "
                                           "(package {}). From its files on: identical",
                                           one.program, one.package)))
        << some.text;
    const ProcessResult refused =
        runcert({"sign", run.string(), "--key", key + ".key", "--role", "measurer", "--no-render"},
                without.env());
    expect_refused(refused, {"Nothing was signed", "Install what is missing"});
    // A later stage that was forged does not hide behind the program that is missing.
    std::string text = read_file(run / "4-trajectory.ecsv");
    const std::size_t digit = text.find_last_of("123456789", text.size() - 4);
    text[digit] = text[digit] == '7' ? '4' : '7';
    write_quickly(run / "4-trajectory.ecsv", text);
    const Found forged = verify(without.env(), {"--recompute", "--keep-going"});
    EXPECT_EQ(forged.answer("recompute"), "not verified") << forged.text;
    EXPECT_EQ(forged.exit_status, 1);
}

INSTANTIATE_TEST_SUITE_P(
    Each, WithoutConverter,
    testing::Values(
        Imported{"gpsbabel", "gpsbabel",
                 "recording: track.tcx, accuracy: {horizontal_m: 0.5, vertical_m: 1.0}"},
        Imported{"rtklib", "rnx2rtkp",
                 "recording: yamatogawa_rover.obs, base: yamatogawa_master.obs, navigation: "
                 "yamatogawa_rover.nav"}),
    [](const auto& one) { return one.param.program; });

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
