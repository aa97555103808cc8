#include <gtest/gtest.h>

#include <iterator>
#include <regex>
#include <sstream>

#include "chain_support.h"
#include "core/text.h"
#include "store/sha256.h"

// The README and its pages: their commands, each as it stands there, by this and other programs.

namespace runcert::chain::RUNCERT_FILE {
namespace {

const fs::path source = RUNCERT_SOURCE_DIR;

/// The lines of the blocks of code of a page, without their remarks.
std::vector<std::string> commands_of(const std::string& page) {
    std::vector<std::string> commands;
    bool code = false;
    bool commands_follow = false;
    for (const std::string& line : lines_of(read_file(source / page))) {
        if (line.starts_with("```")) {
            code = !code;
            commands_follow = line == "```";
        } else if (code && commands_follow) {
            commands.push_back(line.substr(0, line.find("  ")));
        }
    }
    return commands;
}

class Readme : public testing::Test {
  protected:
    ProcessResult shell(const std::string& command) const {
        return run_process({"sh", "-c", "cd '" + folder_.path().string() + "' && " + command},
                           {.environment = {{"LC_ALL", "C.UTF-8"}}});
    }
    void must(const std::string& command) const {
        const ProcessResult result = shell(command);
        EXPECT_EQ(result.exit_status, 0) << command << "\n" << result.output << result.errors;
        last_said_ = result.output;
    }
    /// What the README takes to be there.
    void prepare() const {
        const std::string curve = "-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes";
        must("ln -s " RUNCERT_PROGRAMS "/runcert runcert");
        must("cp -r " + (examples / "salt_lake").string() + " attempt && cp attempt/* . && mv " +
             "attempt.yaml ATTEMPT.yaml");
        must(
            "ssh-keygen -q -t ed25519 -N '' -C observer -f observer && printf 'observer "
            "namespaces=\"*@runcert\" %s\\n' \"$(cat observer.pub)\" > roster");
        must("openssl req -x509 " + curve + " -keyout seal.pem -out seal.crt -subj /CN=seal");
        must("openssl req -x509 " + curve + " -keyout ca.key -out ca.pem -subj /CN=root");
        must("openssl req " + curve + " -keyout tsa.key -out tsa.csr -subj /CN=stamps");
        must(
            "printf 'extendedKeyUsage=critical,timeStamping\\n' > ext && openssl x509 -req -in "
            "tsa.csr -CA ca.pem -CAkey ca.key -CAcreateserial -extfile ext -out tsa.pem");
        must(
            "printf '[a]\\nserial=serial\\nsigner_digest=sha256\\ndefault_policy=1.2.3\\n"
            "digests=sha512\\n' > tsa.cnf && echo 1000 > serial && chmod 600 *.pem");
    }
    void answer_query() const {
        must(
            "openssl ts -reply -config tsa.cnf -section a -queryfile "
            "RUN/report.json.minisig.tsq -signer tsa.pem -inkey tsa.key -out reply.tsr");
    }

    TemporaryFolder folder_;
    mutable std::string last_said_;
};

TEST_F(Readme, ItsCommandsToSignAndVerifyWork) {
    prepare();
    const std::vector<std::string> commands = commands_of("pipeline/trust/README.md");
    ASSERT_EQ(commands.size(), 16U);
    for (const std::string& command : commands) {
        SCOPED_TRACE(command);
        if (command.find("--reply") != std::string::npos) answer_query();
        // The password, where one is asked for, twice where it is new.
        must("printf 'correct horse\\ncorrect horse\\n' | " + command);
        if (command.find(" keygen ") != std::string::npos)
            write_file_atomically(folder_.path() / "roster",
                                  read_file(folder_.path() / "roster") +
                                      last_said_.substr(last_said_.find("roster") + 6));
    }
    // The last one asked pdfsig for its words.
    EXPECT_NE(last_said_.find("Signature is Valid"), std::string::npos) << last_said_;
    EXPECT_NE(last_said_.find("Total document signed"), std::string::npos);
    must("./runcert verify RUN --roster roster --tsa-ca ca.pem");
    EXPECT_NE(last_said_.find("3 signers"), std::string::npos) << last_said_;
    must("./runcert verify run.tar.zst --roster roster --tsa-ca ca.pem");
}

TEST_F(Readme, TheLandYachtGoesFromCertifyToRecordBeaten) {
    must("ln -s " RUNCERT_PROGRAMS "/runcert runcert && ln -s " + examples.string() + " examples");
    const std::vector<std::string> commands = commands_of("pipeline/trust/ATTESTING.md");
    ASSERT_GT(commands.size(), 10U);
    // What page one says after each command that makes pages: its headline, and who closed it.
    std::string beaten = "Record beaten, by the roster";
    const std::string exceeds = "Measured speed exceeds the record; ",
                      due = " still to be attested", open = "Not closed: board closes it",
                      closed = "Closed by board (board), 20",
                      later = "lies here, but the close does not list it";
    const std::vector<std::pair<std::string, std::string>> pages{
        {exceeds + "14 requirements" + due,
         "Neither answered nor closed when this report was made."},
        {exceeds + "9 requirements" + due, ": measurer measurer. " + open},
        {exceeds + "2 requirements" + due, ": judge judge-a, measurer measurer. " + open},
        {exceeds + "2 requirements" + due + " and 1 requirement answered no",
         ": judge judge-a and judge-b, measurer measurer. " + open},
        {exceeds + "1 requirement answered no",
         ": board board, judge judge-a and judge-b, measurer"},
        {exceeds + "answers not closed", open},
        {exceeds + "answers not closed", open},
        {beaten, closed},
        {exceeds + "1 requirement" + due, later},
        {exceeds + "answers not closed", later},
        {beaten, closed}};
    std::size_t step = 0;
    bool complete = false;
    for (const std::string& command : commands) {
        SCOPED_TRACE(command);
        must(command);
        const bool elsewhere = command.find("sent.zip") != std::string::npos;
        if (command.find(" certify ") != std::string::npos ||
            command.find("--take") != std::string::npos ||
            (command.find("--key") != std::string::npos && !elsewhere)) {
            ASSERT_LT(step, pages.size());
            const std::string page = read_file(folder_.path() / "RUN" / "report.html");
            for (const std::string& words : {pages[step].first, pages[step].second})
                EXPECT_NE(page.find(words), std::string::npos) << words;
            EXPECT_EQ(page.find("Record beaten") != std::string::npos, pages[step].first == beaten);
            ++step;
        }
        if (command.find(" verify ") == std::string::npos) continue;
        complete = true;
        const std::string hash = sha256_hex(read_file(folder_.path() / "roster"));
        EXPECT_NE(
            last_said_.find("nalsa: " + beaten + " " + hash.substr(0, 4) + " " + hash.substr(4, 4) +
                            ": compare it with your body's. Standing: complete."),
            std::string::npos)
            << last_said_;
    }
    EXPECT_TRUE(complete);
    EXPECT_EQ(step, pages.size());
    // The first page of the finished certificate is whole: who answered, who signed, how to check.
    const std::string first = shell("pdftotext -l 1 RUN/report.pdf -").output;
    for (const char* words : {"Record beaten", "✓ judge", "✓ board", "Closed by board", "Signed as",
                              "SHA-256 of report.json"})
        EXPECT_NE(first.find(words), std::string::npos) << words << "\n" << first;
    EXPECT_NE(last_said_.find("Signature Verified Successfully"), std::string::npos) << last_said_;
    // Without the officials' keys nothing gets there: none, their public halves, those of others.
    must("./runcert keygen --no-password --out other --role other > other.txt");
    must("sed -n 's/^roster *other/measurer,judge,board/p' other.txt > theirs");
    for (const char* keys :
         {"", "--pubkey measurer.pub --pubkey judge-a.pub --pubkey board.pub", "--roster theirs"}) {
        const ProcessResult found = shell(std::string("./runcert verify RUN ") + keys);
        EXPECT_EQ(found.output.find("Record beaten"), std::string::npos) << keys << found.output;
        EXPECT_NE(found.output.find("Standing: "), std::string::npos) << keys << found.output;
    }
}

TEST_F(Readme, CommandsOfEveryPageWork) {
    must("ln -s " RUNCERT_PROGRAMS "/runcert runcert && ln -s " + examples.string() + " examples");
    for (const char* page :
         {"README.md", "examples/README.md", "stages/check/profiles/README.md",
          "pipeline/outer/days/README.md", "pipeline/trust/KEEPING.md", "schemas/README.md"}) {
        const std::vector<std::string> commands = commands_of(page);
        EXPECT_FALSE(commands.empty()) << page;
        for (const std::string& command : commands) {
            if (command == "./runcert test") continue;
            const ProcessResult result = shell(command);
            // 1 is an answer: a record not beaten, runs that differ.
            EXPECT_LT(result.exit_status, 2) << page << ": " << command << result.errors;
        }
    }
}

TEST(ReadmePage, IsOneScreenAndItsLinksLeadSomewhere) {
    const std::string readme = read_file(source / "README.md");
    std::istringstream words(readme);
    EXPECT_LE(std::distance(std::istream_iterator<std::string>(words), {}), 500);
    static const std::regex link("\\]\\(([^)#]+)\\)");
    for (const char* page :
         {"README.md", "examples/README.md", "stages/check/profiles/README.md",
          "pipeline/outer/days/README.md", "pipeline/trust/README.md",
          "pipeline/trust/ATTESTING.md", "pipeline/trust/CHECKING.md", "pipeline/trust/KEEPING.md",
          "reports/WORDS.md", "examples/PREPARING.md", "CONTRIBUTING.md", "schemas/README.md",
          "reports/METHOD.md", "stages/README.md", "tests/README.md"}) {
        const std::string text = read_file(source / page);
        for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at)
            EXPECT_TRUE(fs::exists((source / page).parent_path() / (*at)[1].str()))
                << page << ": " << (*at)[1];
    }
}

// Each speed with its uncertainty on the page of an example is one that its report has.
TEST(ReadmePage, FiguresOfTheExamplesAreTheirReports) {
    static const std::regex figure(
        "([0-9]+\\.[0-9]+)( (?:km/h|kn))? ± ([0-9]+\\.[0-9]+) (km/h|kn)");
    const TemporaryFolder folder;
    std::size_t looked_at = 0;
    for (const char* name : {"course", "land_yacht", "mast", "oval", "rejected", "salt_lake"}) {
        std::string reports;
        for (const auto& entry : fs::directory_iterator(examples / name))
            if (const std::string text = read_file(entry.path());
                entry.path().extension() == ".yaml" &&
                text.find("schema: attempt/") != std::string::npos) {
                const fs::path run = folder.path() / name / entry.path().stem();
                certify(entry.path(), run, {"--no-render"});
                reports += read_file(run / "report.json");
            }
        std::string page;  // without its tables, which may be of what the attempt would be
        for (const std::string& line : lines_of(read_file(examples / name / "README.md")))
            if (!line.starts_with("|")) page += line + "\n";
        for (std::sregex_iterator at(page.begin(), page.end(), figure), end; at != end; ++at) {
            const std::string unit = (*at)[4].str();
            const std::string said =
                (*at)[1].str() + " " + unit + " ± " + (*at)[3].str() + " " + unit;
            EXPECT_NE(reports.find(said), std::string::npos) << name << ": " << said;
            ++looked_at;
        }
    }
    EXPECT_GT(looked_at, 8U);
}

/// A call of a walk, "2. `windows_of` in `stages/window/window.cpp`: ...".
struct Call {
    std::string function;
    std::string file;
};

/// The walks of stages/README.md, each from a main.cpp on.
std::vector<std::vector<Call>> walks() {
    static const std::regex from("From `([^`]+)`:");
    static const std::regex call("[1-9]\\. `([^`]+)` in `([^`]+)`: .*");
    std::vector<std::vector<Call>> found;
    std::smatch match;
    for (const std::string& line : lines_of(read_file(source / "stages" / "README.md")))
        if (std::regex_match(line, match, from))
            found.push_back({{"main", match[1]}});
        else if (std::regex_match(line, match, call))
            found.back().push_back({match[1], match[2]});
    return found;
}

TEST(Walks, HaveAtMostFiveCallsEachFromTheOneBefore) {
    const auto all = walks();
    ASSERT_EQ(all.size(), 4U);
    for (const std::vector<Call>& walk : all) {
        EXPECT_GE(walk.size(), 2U);
        EXPECT_LE(walk.size(), 6U) << walk.back().function;
        for (std::size_t i = 1; i < walk.size(); ++i) {
            const std::regex named("\\b" + walk[i].function + "(<\\w+>)?\\(");
            for (const std::string& file : {walk[i].file, walk[i - 1].file})
                EXPECT_TRUE(std::regex_search(read_file(source / file), named))
                    << walk[i].function << " in " << file;
        }
    }
}

TEST(Walks, WhatTheTablesNameStandsWhereTheySay) {
    static const std::regex row("\\| `(\\w+)` in `([^`]+)` \\|.*");
    std::size_t rows = 0;
    std::smatch match;
    for (const std::string& line : lines_of(read_file(source / "stages" / "README.md")))
        if (std::regex_match(line, match, row)) {
            ++rows;
            const std::regex named("\\b" + match[1].str() + "\\(");
            EXPECT_TRUE(std::regex_search(read_file(source / match[2].str()), named)) << line;
        }
    EXPECT_GE(rows, 12U);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
