#include <nlohmann/json.hpp>

#include "signatures_support.h"

// Run folders that were changed, each refused in the words of its layer.

namespace runcert::chain::RUNCERT_FILE {
namespace {

class TamperedRun : public SignedRuns {
  protected:
    void SetUp() override {
        SignedRuns::SetUp();
        must_sign("measurer", "measurer");
    }
    nlohmann::json found() const { return verify_json({"--roster", roster()}); }
    void make_sums() const {
        const ProcessResult made =
            run_process({"sh", "-c",
                         "cd \"$0\" && find . -type f ! -name SHA256SUMS | sed 's,^./,,' | "
                         "LC_ALL=C sort | xargs sha256sum > SHA256SUMS",
                         run().string()});
        ASSERT_EQ(made.exit_status, 0) << made.errors;
    }
};

TEST_F(TamperedRun, FilesOfAnotherRunAreNamed) {
    for (const char* file : {"3-screened.ecsv", "6-verdict.yaml", "report.json"}) {
        const std::string own = read_file(run() / file);
        write_file_atomically(run() / file, read_file(other_run() / file));
        const auto result = found();
        EXPECT_EQ(result["exit_status"], 1);
        const bool is_report = std::string(file) == "report.json";
        EXPECT_TRUE(says(layer(result, is_report ? "signatures" : "files"),
                         is_report ? "replayed" : std::string(file) + ": changed"))
            << result.dump(1);
        write_file_atomically(run() / file, own);
    }
    EXPECT_EQ(found()["exit_status"], 0);
}

TEST_F(TamperedRun, ARemovedRowIsFoundWhetherItsHashIsPutRightOrNot) {
    std::string text = read_file(run() / "3-screened.ecsv");
    const std::size_t last = text.rfind('\n', text.size() - 2);
    write_file_atomically(run() / "3-screened.ecsv", text.substr(0, last + 1));
    auto result = found();
    EXPECT_TRUE(says(layer(result, "files"), "3-screened.ecsv: changed")) << result.dump(1);
    EXPECT_EQ(layer(result, "signatures")["passed"], true);
    fix_hash("3-screened.ecsv");
    result = found();
    EXPECT_EQ(layer(result, "files")["passed"], true);
    EXPECT_TRUE(says(layer(result, "chain"), "made from another 3-screened.ecsv"))
        << result.dump(1);
    EXPECT_TRUE(says(layer(result, "signatures"), "not as it was when it was signed"))
        << result.dump(1);
    EXPECT_EQ(result["exit_status"], 1);
}

TEST_F(TamperedRun, AFileOfAnotherProgramOrAnUnknownModelIsCalledThat) {
    change("3-screened.ecsv", "source_revision: ", "source_revision: 0");
    fix_hash("3-screened.ecsv");
    auto result = found();
    EXPECT_EQ(layer(result, "schemas")["passed"], false);
    EXPECT_TRUE(says(layer(result, "schemas"), "3-screened.ecsv: its header says that"))
        << result.dump(1);
    change("3-screened.ecsv", "version: \"1.0\"", "version: \"7.0\"");
    fix_hash("3-screened.ecsv");
    EXPECT_TRUE(says(layer(found(), "schemas"), "is not known"));
}

TEST_F(TamperedRun, AFileOfAnotherVersionIsCalledThat) {
    change("3-screened.ecsv", "version: \"1.0\"", "version: \"1.7\"");
    fix_hash("3-screened.ecsv");
    EXPECT_TRUE(says(layer(found(), "schemas"),
                     R"(3-screened.ecsv: version \"1.7\" of the schema screened is not known)"));
}

TEST_F(TamperedRun, AFileOfAnotherVersionIsRefusedByEveryCommand) {
    const std::string where = run().string();
    const std::vector<std::vector<std::string>> commands{
        {"explain", where},
        {"audit", where},
        {"compare", where},
        {"diff", where, original().string()},
        {"diff", original().string(), where},
        {"bundle", where, "--out", path("b.tar.zst").string()},
        {"attest", where},
        {"export", where, "--format", "csv", "--out", path("e").string()}};
    const auto expect_refused = [&](const std::string& file, const std::string& said) {
        for (const auto& command : commands) {
            const ProcessResult result = runcert(command);
            EXPECT_EQ(result.exit_status, 2) << command[0] << " " << file << "\n" << result.output;
            EXPECT_NE(result.errors.find(said), std::string::npos) << result.errors;
        }
    };
    const std::vector<std::array<std::string, 4>> cases{
        {"3-screened.ecsv", "version: \"1.0\"", "version: \"1.7\"", "ersion \"1.7\" of the schema"},
        {"5-windows.yaml", "version: \"1.0\"", "version: \"2.0\"", "ersion \"2.0\" of the schema"},
        {"attempt.yaml", "attempt/1.0", "attempt/1.3", "ersion \"1.3\" of attempt"},
        {"report.json", "\"version\": \"1.0\"", "\"version\": \"1.1\"", "of version \"1.1\""}};
    for (const auto& [file, is, becomes, said] : cases) {
        const std::string text = read_file(run() / file);
        change(file, is, becomes);
        if (file != "report.json") fix_hash(file);
        expect_refused(file, said);
        write_file_atomically(run() / file, text);
    }
}

TEST_F(TamperedRun, ExtraFilesAndLinksAreNamed) {
    write_file_atomically(run() / "notes.txt", "extra");
    auto result = found();
    EXPECT_EQ(result["exit_status"], 1);
    EXPECT_TRUE(says(layer(result, "files"), "notes.txt: not part of the report: move it away"));
    fs::remove(run() / "notes.txt");
    fs::rename(run() / "2-enu.ecsv", path("2-enu.ecsv"));
    fs::create_symlink(path("2-enu.ecsv"), run() / "2-enu.ecsv");
    result = found();
    EXPECT_EQ(result["exit_status"], 1);
    EXPECT_TRUE(says(layer(result, "files"), "2-enu.ecsv: a symbolic link")) << result.dump(1);
    fs::remove(run() / "2-enu.ecsv");
    fs::rename(path("2-enu.ecsv"), run() / "2-enu.ecsv");
    fs::rename(run() / "report.json.minisig", path("away"));
    fs::create_symlink(path("away"), run() / "report.json.minisig");
    result = found();
    EXPECT_EQ(result["exit_status"], 1);
    EXPECT_TRUE(says(layer(result, "files"), "report.json.minisig: a symbolic link"));
    fs::remove(run() / "report.json.minisig");
    fs::create_directory(run() / "odd\x1B[2J");
    result = found();
    EXPECT_TRUE(says(layer(result, "files"), "odd\\\\x1b[2J")) << result.dump(1);
}

TEST_F(TamperedRun, OfABundleEveryChangedByteIsFound) {
    fs::create_directory(run() / "keys");
    write_file_atomically(run() / "keys" / "roster", read_file(roster()));
    write_file_atomically(run() / "VERIFY.txt", "how to verify\n");
    make_sums();
    auto result = found();
    EXPECT_EQ(result["exit_status"], 0) << result.dump(1);
    EXPECT_EQ(layer(result, "bundle")["passed"], true);
    std::size_t changes = 0;
    for (const auto& [name, bytes] : contents_of(run()))
        for (std::size_t i = 0; i < 3; ++i) {
            std::string changed = bytes;
            const std::size_t at = (i * 2654435761U + bytes.size() / 3) % bytes.size();
            changed[at] = static_cast<char>(changed[at] ^ (1 << (at % 7)));
            write_file_atomically(run() / name, changed);
            const ProcessResult verified = verify({"--roster", roster()});
            EXPECT_NE(verified.exit_status, 0) << name << " byte " << at;
            const bool named = (verified.output + verified.errors).find(name) != std::string::npos;
            EXPECT_TRUE(named) << name << " byte " << at << verified.output << verified.errors;
            write_file_atomically(run() / name, bytes);
            ++changes;
        }
    EXPECT_GT(changes, 40U);
    EXPECT_EQ(found()["exit_status"], 0);
}

TEST_F(TamperedRun, OfABundleTheListItselfIsChecked) {
    fs::create_directory(run() / "keys");
    write_file_atomically(run() / "keys" / "a", "a");
    make_sums();
    const std::string sums = read_file(run() / "SHA256SUMS");
    const auto expect_said = [&](const std::string& list, const std::string& said) {
        write_file_atomically(run() / "SHA256SUMS", list);
        const auto bundle = layer(found(), "bundle");
        EXPECT_EQ(bundle["passed"], false) << said;
        EXPECT_TRUE(says(bundle, said)) << said << bundle.dump(1);
    };
    const std::string first = sums.substr(0, sums.find('\n') + 1);
    expect_said(sums.substr(first.size()), "1-observations.ecsv is not named in SHA256SUMS");
    expect_said(sums + first, "1-observations.ecsv is there twice or out of order");
    expect_said(first.substr(0, 64) + " *" + first.substr(66) + sums.substr(first.size()),
                "SHA256SUMS line 1 is not a hash");
    expect_said(sums + std::string(64, 'a') + "  ../away\n",
                "is not a hash of 64 digits, two blanks and a name");
    expect_said(sums + std::string(64, 'a') + "  keys/b\n", "keys/b is missing");
    expect_said(sums.substr(0, sums.size() - 1), "run.yaml is not named");
    write_file_atomically(run() / "SHA256SUMS", sums);
    write_file_atomically(run() / "keys" / "b", "b");
    EXPECT_TRUE(says(layer(found(), "bundle"), "keys/b is not named"));
}

/// Pages of the run, as the program renders them.
class TamperedPages : public TamperedRun {
  protected:
    /// The signed run with its pages, which are rendered once.
    void SetUp() override {
        SignedRuns::SetUp();
        const fs::path rendered = shared_->path() / "rendered";
        if (!fs::exists(rendered)) {
            must_sign("measurer", "measurer");
            const ProcessResult made =
                run_process({RUNCERT_PROGRAMS "/runcert-report", "--render-only", "--page",
                             "report.html", "--page", "certificate.pdf", "--attempt",
                             (run() / "attempt.yaml").string(), "--run-dir", run().string()});
            ASSERT_EQ(made.exit_status, 0) << made.errors;
            fs::rename(run(), rendered);
        }
        fs::remove_all(run());
        fs::copy(rendered, run(), fs::copy_options::recursive);
    }
    /// Of one page alone: the other would be rendered for nothing.
    void keep_only(const std::string& page) const {
        for (const std::string& other :
             {std::string("report.html"), std::string("certificate.pdf")})
            if (other != page) fs::remove(run() / other);
    }
    nlohmann::json pages() const { return layer(found(), "pages"); }
    nlohmann::json page(const std::string& text) const {
        write_file_atomically(run() / "report.html", text);
        return pages();
    }
};

TEST_F(TamperedPages, AreRenderedAgainEachTime) {
    EXPECT_EQ(pages()["passed"], true) << pages();
    EXPECT_TRUE(says(pages(), "report.html: identical")) << pages();
    EXPECT_TRUE(says(pages(), "certificate.pdf: identical")) << pages();
    const std::string whole = read_file(run() / "report.html");
    keep_only("report.html");
    for (const std::string& changed :
         {whole + "\n", "<!-- -->" + whole, whole.substr(0, whole.size() - 1), std::string("")}) {
        const auto said = page(changed);
        EXPECT_EQ(said["passed"], false) << said;
        EXPECT_TRUE(says(said, "it is not what the report renders to")) << said;
    }
    fs::remove(run() / "report.html");
    EXPECT_EQ(pages()["passed"], nullptr);
}

TEST_F(TamperedPages, APdfIsComparedByWhatItCarriesAndShows) {
    keep_only("certificate.pdf");
    const std::string json = (run() / "report.json").string();
    const auto render = [&](const std::string& html, const std::vector<std::string>& attached) {
        write_file_atomically(path("page.html"), html);
        std::vector<std::string> command{"weasyprint"};
        for (const std::string& file : attached)
            command.insert(command.end(), {"-a", file});
        command.insert(command.end(),
                       {path("page.html").string(), (run() / "certificate.pdf").string()});
        const ProcessResult made = run_process(command);
        EXPECT_EQ(made.exit_status, 0) << made.errors;
        const auto said = pages();
        EXPECT_EQ(said["passed"], false) << said;
        return said;
    };
    EXPECT_TRUE(says(render("<p>page</p>", {json}), "its title is"));
    EXPECT_TRUE(says(render("<p>page</p>", {}), "does not carry report.json"));
    fs::create_directory(path("b"));
    const std::string other = (path("b") / "report.json").string();
    write_file_atomically(other, read_file(json) + " ");
    EXPECT_TRUE(says(render("<p>page</p>", {other}), "attached to it is not report.json"));
    EXPECT_TRUE(says(render("<p>page</p>", {other, json}), "no other file"));
    EXPECT_TRUE(says(render("<p>page</p>", {json, path("page.html")}), "no other file"));
    write_file_atomically(run() / "certificate.pdf", "hello");
    EXPECT_TRUE(says(pages(), "cannot be read as a PDF"));
    EXPECT_EQ(pages()["passed"], false);
}

/// Its length tells nothing: several rules take more than one page.
TEST_F(TamperedPages, TheCertificateAloneIsKnownAndStaysAlone) {
    fs::copy(examples / "salt_lake", path("many"), fs::copy_options::recursive);
    const fs::path file = path("many") / "attempt.yaml";
    std::string text = read_file(file);
    for (const char* rule : {"10s", "2s", "500m", "5x10s", "nautical-mile"})
        for (const char* of : {"sailing", "ice"}) {
            const std::string sport =
                of == std::string_view("ice") ? "ice-sailing" : "speed-sailing";
            text += fmt::format("  - gps-{}-{}\n", sport, rule);
        }
    write_file_atomically(file, text);
    fs::remove_all(run());
    certify(file, run(), {"--brief"});
    const auto pages_of_pdf = [&] {
        const std::string facts =
            run_process({"pdfinfo", (run() / "certificate.pdf").string()}).output;
        const std::size_t at = facts.find("Pages:") + 6;
        return std::stoi(facts.substr(at, facts.find('\n', at) - at));
    };
    const int alone = pages_of_pdf();
    EXPECT_GT(alone, 1);
    EXPECT_LT(alone, 5);
    EXPECT_EQ(pages()["passed"], true) << pages();
    const ProcessResult again = runcert({"attest", run().string(), "--render"});
    EXPECT_EQ(again.exit_status, 0) << again.errors;
    EXPECT_EQ(pages_of_pdf(), alone);
}

TEST_F(TamperedPages, APdfThatWasEditedIsNotThePage) {
    keep_only("certificate.pdf");
    const auto with = [&](const std::string& from, const std::string& to) {
        const ProcessResult plain =
            run_process({"qpdf", "--qdf", "--object-streams=disable",
                         (run() / "certificate.pdf").string(), path("plain.pdf").string()});
        EXPECT_EQ(plain.exit_status, 0) << plain.errors;
        std::string text = read_file(path("plain.pdf"));
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos);
        write_file_atomically(run() / "certificate.pdf", text.replace(at, from.size(), to));
        const auto said = pages();
        EXPECT_EQ(said["passed"], false) << said;
        return said;
    };
    // Rewritten by another program, unchanged in what it shows; then with another colour.
    EXPECT_TRUE(says(with("%PDF", "%PDF"), "no seal covers its bytes"));
    EXPECT_TRUE(says(with(" rg\n", " RG\n"), "does not look as it is rendered"));
}

TEST_F(TamperedPages, OfAnotherProgramAreNotCheckable) {
    // As its own signer may write it: nothing else tells that another program made the report.
    for (const char* file : {"1-observations.ecsv", "2-enu.ecsv", "3-screened.ecsv",
                             "4-trajectory.ecsv", "5-windows.yaml", "6-verdict.yaml"}) {
        change(file, "source_revision: ", "source_revision: f");
        fix_hash(file);
    }
    const std::string page = read_file(run() / "report.html");
    change("report.json", "\"source_revision\": \"", "\"source_revision\": \"f");
    change("report.json", "\"template_sha256\": \"", "\"template_sha256\": \"f");
    const auto found_of = [&](const std::string& html) {
        write_file_atomically(run() / "report.html", html);
        return nlohmann::json::parse(
            runcert({"verify", run().string(), "--json", "--keep-going"}).output);
    };
    // Whatever program made them, they carry the report that they are of.
    auto said = layer(found_of(page), "pages");
    EXPECT_EQ(said["answer"], "not verified");
    EXPECT_TRUE(says(said, "report.html: it carries another report than report.json")) << said;
    EXPECT_TRUE(says(said, "certificate.pdf: the report attached to it is not report.json"))
        << said;
    keep_only("report.html");
    std::string carrying = page;
    const std::string mark = "id=\"report-json\">";
    const std::size_t carried = carrying.find(mark) + mark.size();
    carrying.replace(carried, carrying.find("</script>", carried) - carried,
                     read_file(run() / "report.json"));
    const auto result = found_of(carrying);
    said = layer(result, "pages");
    EXPECT_EQ(said["answer"], "not checkable here");
    EXPECT_EQ(said["passed"], nullptr);
    EXPECT_TRUE(says(said, "not checked here: made by runcert")) << said;
    EXPECT_TRUE(says(result["not_checked_here"], "pages"));
    EXPECT_EQ(result["exit_status"], 1);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
