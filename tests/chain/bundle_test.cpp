#include "trust/bundle.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "handover_support.h"
#include "trust/roster.h"
#include "trust/signature.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

class BundleTest : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        signed_ = new SignedRun("salt_lake");
        ASSERT_EQ(bundle(signed_->run(), file()).exit_status, 0);
    }
    static void TearDownTestSuite() { delete signed_; }
    static fs::path file() { return signed_->path() / "salt-lake.tar.zst"; }
    static ProcessResult bundle(const fs::path& run, const fs::path& out,
                                std::vector<std::string> more = {}, const Environment& env = {}) {
        std::vector<std::string> arguments{"bundle", run.string(), "--out", out.string()};
        if (more.empty()) more = {"--pubkey", signed_->public_key()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments, env);
    }
    /// A copy of the run folder to spoil.
    static void copy_run(const fs::path& to) { fs::copy(signed_->run(), to); }

    static SignedRun* signed_;
};
SignedRun* BundleTest::signed_ = nullptr;

/// The commands that VERIFY.txt tells a stranger to type.
std::vector<std::string> commands_of(const std::string& text) {
    std::vector<std::string> commands;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("    ")) commands.push_back(line.substr(4));
    return commands;
}

TEST_F(BundleTest, TarUnpacksItAndSha256sumAcceptsIt) {
    const TemporaryFolder there;
    const ProcessResult result =
        shell(there.path(), "tar --zstd -xf '" + file().string() +
                                "'; cd salt-lake; sha256sum --strict -c SHA256SUMS");
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    const auto packed = contents_of(there.path() / "salt-lake");
    for (const auto& [name, bytes] : contents_of(signed_->run()))
        if (name == "run.yaml")
            EXPECT_FALSE(packed.contains(name));
        else
            EXPECT_TRUE(packed.at(name) == bytes) << name;
    EXPECT_EQ(std::count(result.output.begin(), result.output.end(), '\n') + 1,
              static_cast<std::ptrdiff_t>(packed.size()));
    EXPECT_TRUE(fs::exists(there.path() / "salt-lake" / "keys"));
    EXPECT_TRUE(check_sums(there.path() / "salt-lake").empty());
}

TEST_F(BundleTest, AStrangerCanDoWhatVerifyTxtSays) {
    if (!has_program("minisign")) GTEST_SKIP() << "minisign is not installed";
    const TemporaryFolder there;
    fs::copy_file(file(), there.path() / "salt-lake.tar.zst");
    const ProcessResult text =
        shell(there.path(), "tar --zstd -xOf salt-lake.tar.zst salt-lake/VERIFY.txt");
    const nlohmann::json report = nlohmann::json::parse(read_file(signed_->run() / "report.json"));
    EXPECT_TRUE(holds(text.output, report["predicate"]["report_id"].get<std::string>()));
    std::string line = "export PATH='" RUNCERT_PROGRAMS "':$PATH";
    const std::vector<std::string> commands = commands_of(text.output);
    for (const std::string& command : commands)
        line += "; " + command;
    EXPECT_GE(commands.size(), 6u) << text.output;
    const ProcessResult result = shell(there.path(), line);
    EXPECT_EQ(result.exit_status, 0) << line << result.output << result.errors;
    EXPECT_TRUE(holds(result.output, "Signature and comment signature verified"));
    EXPECT_TRUE(holds(result.output, "VERIFIED")) << result.output;
}

TEST_F(BundleTest, TheSameBytesWhateverOrderTimesModesAndLocale) {
    const TemporaryFolder there;
    const fs::path copy = there.path() / "another-name";
    fs::create_directory(copy);
    const auto contents = contents_of(signed_->run());
    for (auto entry = contents.rbegin(); entry != contents.rend(); ++entry)
        write_quickly(copy / entry->first, entry->second);
    write_quickly(copy / "run.yaml", "another clock");
    fs::create_directory(copy / ".runcert-12-3");
    write_quickly(copy / ".runcert-4-5.tmp", "half");
    ASSERT_EQ(shell(copy, "touch -d 2001-02-03 *; chmod 640 *; chmod 755 report.json").exit_status,
              0);
    const ProcessResult made =
        bundle(copy, there.path() / "b.tar.zst", {},
               {{"LC_ALL", "C.UTF-8"}, {"TZ", "Asia/Tokyo"}, {"SOURCE_DATE_EPOCH", "1"}});
    EXPECT_EQ(made.exit_status, 0) << made.errors;
    EXPECT_TRUE(read_file(there.path() / "b.tar.zst") == read_file(file()));
    EXPECT_TRUE(holds(made.output, "left out  run.yaml"));
    EXPECT_TRUE(holds(made.output, "left out  .runcert-4-5.tmp"));
}

TEST_F(BundleTest, ABundleUnpackedAndBundledAgainIsTheSame) {
    const UnpackedBundle unpacked = unpack_bundle(file());
    EXPECT_EQ(unpacked.run_dir.filename(), "salt-lake");
    EXPECT_TRUE(unknown_files(unpacked.run_dir).empty());
    EXPECT_TRUE(make_bundle({.run_dir = unpacked.run_dir}).bytes == read_file(file()));
    write_quickly(unpacked.run_dir / "VERIFY.txt", "Believe me.");
    EXPECT_THROW(make_bundle({.run_dir = unpacked.run_dir}), Failure);
}

TEST_F(BundleTest, EveryReaderTakesABundleAsItTakesTheFolder) {
    const TemporaryFolder there;
    const std::string run = signed_->run().string(), packed = file().string();
    const auto out = [&](const char* name) { return (there.path() / name).string(); };
    for (const std::vector<std::string>& command :
         std::vector<std::vector<std::string>>{{"explain"},
                                               {"explain", "nalsa/accuracy"},
                                               {"audit"},
                                               {"audit", "--stage", "screen"},
                                               {"attest"},
                                               {"export", "--format", "csv", "--out", "-"},
                                               {"export", "--format", "kml", "--out", "-"}}) {
        const auto said_of = [&](const std::string& given) {
            std::vector<std::string> line{command.front(), given};
            line.insert(line.end(), command.begin() + 1, command.end());
            const ProcessResult result = runcert(line);
            EXPECT_EQ(result.exit_status, 0) << command.front() << result.errors;
            std::string said = result.output;
            replace_all(said, given, "RUN");
            return said;
        };
        std::string of_folder = said_of(run);
        // A bundle leaves out when the run was made.
        if (command.front() != "audit")
            EXPECT_EQ(said_of(packed), of_folder) << command.front();
        else
            EXPECT_TRUE(holds(said_of(packed), "3-screened.ecsv"));
    }
    EXPECT_EQ(runcert({"diff", run, packed}).exit_status, 0);
    const ProcessResult changed =
        runcert({"explain", packed, "--roster", (signed_->run() / "report.json").string()});
    EXPECT_EQ(changed.exit_status, 2) << changed.output;
    // What is no bundle is refused by its own name.
    write_quickly(out("note.txt"), "no bundle");
    const ProcessResult refused = runcert({"audit", out("note.txt")});
    EXPECT_EQ(refused.exit_status, 2);
    EXPECT_TRUE(holds(refused.errors, out("note.txt"))) << refused.errors;
}

TEST_F(BundleTest, APageSaysWhichReportItShowsAndWhatToAskFor) {
    const TemporaryFolder there;
    ASSERT_EQ(certify(examples / "salt_lake" / "attempt.yaml", there.path() / "run").exit_status,
              0);
    const nlohmann::json report =
        nlohmann::json::parse(read_file(there.path() / "run" / "report.json"));
    const std::string id = report["predicate"]["report_id"].get<std::string>();
    for (const char* name : {"report.html", "certificate.pdf", "report.pdf"})
        for (const char* command : {"verify", "explain", "sign"}) {
            const fs::path page = there.path() / "run" / name;
            std::vector<std::string> line{command, page.string()};
            if (line.front() == "sign") line.insert(line.end(), {"--key", "k", "--role", "judge"});
            const ProcessResult result = runcert(line);
            EXPECT_EQ(result.exit_status, 2);
            for (const std::string& words :
                 {"readable copy of report " + id, std::string("(attempt \"salt-lake\")"),
                  page.string(), std::string("runcert verify salt-lake.zip --roster ROSTER")})
                EXPECT_TRUE(holds(result.errors, words)) << command << result.errors;
        }
    // Another page is no bundle, and no report.
    write_quickly(there.path() / "other.pdf", "%PDF-1.7 Measurement report of a bridge");
    EXPECT_FALSE(
        holds(runcert({"verify", (there.path() / "other.pdf").string()}).errors, "readable copy"));
}

TEST_F(BundleTest, WhatWasAnsweredOnCopiesIsTakenIn) {
    const TemporaryFolder there;
    const auto in_it = [&](const std::string& line) {
        return shell(there.path(), "export PATH='" RUNCERT_PROGRAMS "':$PATH; " + line);
    };
    const fs::path run = there.path() / "run";
    fs::copy(signed_->run(), run);
    for (const char* who : {"a", "b"})
        ASSERT_EQ(in_it(std::string("runcert keygen --no-password --role judge --out ") + who)
                      .exit_status,
                  0);
    ASSERT_EQ(in_it("runcert bundle run --out a.zip --zip && mkdir a b && cp a.zip b").exit_status,
              0);
    for (const char* who : {"a", "b"}) {
        const ProcessResult answered =
            in_it(std::string("cd ") + who +
                  " && runcert attest ../a.zip flat-course --role judge --key ../" + who +
                  ".key --yes --no-render && runcert sign salt-lake --role judge --key ../" + who +
                  ".key --no-render --no-recompute");
        EXPECT_EQ(answered.exit_status, 0) << answered.output << answered.errors;
        EXPECT_TRUE(holds(answered.output, "unpacked to salt-lake")) << answered.output;
    }
    // Where such a folder is, nothing is unpacked over it.
    const ProcessResult again =
        in_it("cd a && runcert attest ../a.zip observers --role judge --key ../a.key --yes");
    EXPECT_EQ(again.exit_status, 2) << again.output;
    EXPECT_TRUE(holds(again.errors, "which is there")) << again.errors;
    const auto before = contents_of(run);
    const ProcessResult first = in_it("runcert attest run --take a/salt-lake --no-render");
    EXPECT_EQ(first.exit_status, 0) << first.errors;
    EXPECT_TRUE(holds(first.output, "attestations/answer-")) << first.output;
    EXPECT_EQ(contents_of(run).size(), before.size() + 2);
    EXPECT_TRUE(holds(in_it("runcert attest run --take a/salt-lake --no-render").output,
                      "all of it is there already"));
    // The other judge's signature has the same name, and gets another.
    const ProcessResult second = in_it("runcert attest run --take b/salt-lake --no-render");
    EXPECT_EQ(second.exit_status, 0) << second.errors;
    EXPECT_TRUE(fs::exists(run / "report.json.judge.minisig"));
    EXPECT_TRUE(fs::exists(run / "report.json.judge-2.minisig"));
    const ProcessResult verified =
        in_it("runcert verify run --pubkey judge=a.pub --pubkey judge=b.pub --pubkey '" +
              signed_->public_key() + "'");
    EXPECT_TRUE(holds(verified.output, "3 signers")) << verified.output;
    const auto both = contents_of(run);
    EXPECT_EQ(both.size(), before.size() + 4);
    // Of several copies all is taken, or nothing.
    ASSERT_EQ(in_it("rm run/attestations/* run/report.json.judge*").exit_status, 0);
    const auto bare = contents_of(run);
    const ProcessResult partly =
        in_it("runcert attest run --take a/salt-lake --take a.key --no-render");
    EXPECT_EQ(partly.exit_status, 2) << partly.output;
    EXPECT_EQ(contents_of(run), bare);
    ASSERT_EQ(
        in_it("runcert attest run --take a/salt-lake --take b/salt-lake --no-render").exit_status,
        0);
    EXPECT_EQ(contents_of(run).size(), both.size());
    // An answer to another report is none to this.
    write_quickly(there.path() / "b" / "salt-lake" / "report.json", "{}");
    EXPECT_TRUE(holds(in_it("runcert attest run --take b/salt-lake").errors, "another report"));
    EXPECT_EQ(contents_of(run), both);
}

TEST_F(BundleTest, AsAZipItIsTheSameBundle) {
    const TemporaryFolder there;
    const fs::path zip = there.path() / "salt-lake.zip";
    const std::vector<std::string> how{"--zip", "--pubkey", signed_->public_key()};
    ASSERT_EQ(bundle(signed_->run(), zip, how).exit_status, 0);
    // The same bytes wherever it is made.
    const fs::path again = there.path() / "again.zip";
    ASSERT_EQ(bundle(signed_->run(), again, how, {{"TZ", "Asia/Tokyo"}}).exit_status, 0);
    EXPECT_TRUE(read_file(zip) == read_file(again));
    const UnpackedBundle unpacked = unpack_bundle(zip);
    auto in_zip = contents_of(unpacked.run_dir),
         in_tar = contents_of(unpack_bundle(file()).run_dir);
    EXPECT_TRUE(holds(in_zip.at("VERIFY.txt"), "    unzip -q salt-lake.zip\n"));
    for (auto* contents : {&in_zip, &in_tar})
        for (const char* own : {"VERIFY.txt", "SHA256SUMS"})
            contents->erase(own);
    EXPECT_EQ(in_zip, in_tar);
    EXPECT_TRUE(make_bundle({.run_dir = unpacked.run_dir, .form = ArchiveForm::zip}).bytes ==
                read_file(zip));
    const ProcessResult verified =
        runcert({"verify", zip.string(), "--pubkey", signed_->public_key(), "--recompute"});
    EXPECT_EQ(verified.exit_status, 0) << verified.output << verified.errors;
    EXPECT_TRUE(verified.output.ends_with("\nVERIFIED\n")) << verified.output;
    // By default it is called as the attempt is, and unzip, which reads it too, gives the same.
    ASSERT_EQ(shell(there.path(), fmt::format("mkdir a; cd a; {}/runcert bundle '{}' --zip; unzip "
                                              "-q salt-lake.zip; cd salt-lake; sha256sum --quiet "
                                              "-c SHA256SUMS",
                                              RUNCERT_PROGRAMS, signed_->run().string()))
                  .exit_status,
              0);
}

TEST_F(BundleTest, AZipOfAnotherFormIsSeenWhateverItHolds) {
    const TemporaryFolder there;
    const fs::path zip = there.path() / "salt-lake.zip";
    ASSERT_EQ(bundle(signed_->run(), zip, {"--zip", "--pubkey", signed_->public_key()}).exit_status,
              0);
    const std::string whole = read_file(zip);
    const auto says = [&](const std::string& bytes, const std::string& about) {
        const fs::path other = there.path() / "other.zip";
        write_file_atomically(other, bytes);
        const ProcessResult result =
            runcert({"verify", other.string(), "--pubkey", signed_->public_key()});
        EXPECT_NE(result.exit_status, 0) << about << result.output;
        EXPECT_TRUE(holds(result.output, "NO   bundle") || result.exit_status == 2)
            << about << result.output;
    };
    says(whole + "behind", "something behind it");
    std::string commented = whole;
    commented[commented.size() - 2] = 5;  // the length of its comment
    says(commented + "hello", "a comment");
    // Between two files, where no list points.
    const std::size_t listed = whole.find("PK\x01\x02");
    says(whole.substr(0, listed) + "hidden" + whole.substr(listed), "something between");
    // Another name in front of a file than in the list.
    std::string renamed = whole;
    renamed.replace(renamed.find("salt-lake/"), 10, "salt-lake-");
    says(renamed, "two names of one file");
    // By another program, of the same files.
    ASSERT_EQ(
        shell(there.path(), "unzip -q salt-lake.zip; zip -q -r by-zip.zip salt-lake").exit_status,
        0);
    says(read_file(there.path() / "by-zip.zip"), "made by zip");
}

// Verification knew none of these: it called a bundle's own folder not verified.
TEST_F(BundleTest, AStampOfNoSignatureIsRefused) {
    for (const char* name : {"report.json.tsr", "report.json.tsq"}) {
        const TemporaryFolder there;
        copy_run(there.path() / "run");
        write_quickly(there.path() / "run" / name, "stamp");
        expect_refused(bundle(there.path() / "run", there.path() / "o.tar.zst"),
                       {name, "no part of the run"});
    }
}

TEST_F(BundleTest, EveryKeyOfItsRosterGoesAlong) {
    const TemporaryFolder there;
    ASSERT_EQ(shell(there.path(), "ssh-keygen -q -t ed25519 -N '' -C judge -f judge").exit_status,
              0);
    const std::string judge = read_file(there.path() / "judge.pub");
    const ProcessResult line =
        runcert({"keygen", "--out", (there.path() / "other").string(), "--no-password"});
    ASSERT_EQ(line.exit_status, 0);
    // The measurer's key as it signed, one that signed nothing.
    const PublicKey measurer = parse_public_key(read_file(signed_->public_key()), "key");
    write_quickly(there.path() / "roster",
                  roster_line(measurer, "measurer", "m") + "\njudge " + judge);
    const fs::path out = there.path() / "salt-lake.tar.zst";
    ASSERT_EQ(
        bundle(signed_->run(), out, {"--roster", (there.path() / "roster").string()}).exit_status,
        0);
    const UnpackedBundle unpacked = unpack_bundle(out);
    auto keys = contents_of(unpacked.run_dir / "keys");
    ASSERT_EQ(keys.size(), 3U);
    EXPECT_EQ(keys.at(key_id_text(measurer) + ".pub"), public_key_file(measurer));
    keys.erase(key_id_text(measurer) + ".pub");
    keys.erase("roster");
    EXPECT_TRUE(keys.begin()->first.starts_with("ssh-"));
    EXPECT_EQ(keys.begin()->second, judge.substr(0, judge.rfind(' ')) + "\n");
    EXPECT_TRUE(make_bundle({.run_dir = unpacked.run_dir}).bytes == read_file(out));
    const std::string text = read_file(unpacked.run_dir / "VERIFY.txt");
    EXPECT_TRUE(holds(text, "-p keys/" + key_id_text(measurer) + ".pub"));
    EXPECT_FALSE(holds(text, "keys/ssh-")) << text;
    // One that was taken out is missed.
    fs::remove(unpacked.run_dir / "keys" / keys.begin()->first);
    ASSERT_EQ(shell(unpacked.run_dir,
                    "sed -i '/keys.ssh-/d' SHA256SUMS; cd ..; tar --format=ustar --owner=0 "
                    "--group=0 --numeric-owner --mtime=@0 -cf o.tar $(cd salt-lake; LC_ALL=C; for "
                    "f in $(find . -type f | sort); do echo salt-lake/${f#./}; done); zstd -q "
                    "o.tar -o o.tar.zst")
                  .exit_status,
              0);
    EXPECT_EQ(runcert({"verify", (unpacked.run_dir / ".." / "o.tar.zst").string(), "--pubkey",
                       signed_->public_key()})
                  .exit_status,
              1);
}

TEST_F(BundleTest, SaysWhichProgramMadeItAndWhereThatIs) {
    const auto of = [&](const std::string& home) {
        return bundle_text({.attempt = "a",
                            .report_id = "1",
                            .program_version = "1.2.3",
                            .source_revision = "abc",
                            .program_home = home});
    };
    EXPECT_TRUE(holds(of(""), "made by runcert 1.2.3, source abc\n\n"));
    EXPECT_TRUE(holds(of("https://example.org/runcert"),
                      "made by runcert 1.2.3, source abc,\nto be had at "
                      "https://example.org/runcert\n\n"));
    const nlohmann::json report = nlohmann::json::parse(read_file(signed_->run() / "report.json"));
    EXPECT_TRUE(holds(read_file(unpack_bundle(file()).run_dir / "VERIFY.txt"),
                      report["predicate"]["program"]["source_revision"].get<std::string>()));
}

TEST_F(BundleTest, OfAnotherFormIsSeenWhateverItHolds) {
    const auto says = [](const fs::path& bundle, const std::string& what) {
        const ProcessResult result =
            runcert({"verify", bundle.string(), "--pubkey", signed_->public_key()});
        EXPECT_EQ(result.exit_status, 1) << what;
        EXPECT_NE(result.output.find("NO   bundle"), std::string::npos) << result.output;
        EXPECT_NE(result.output.find(what), std::string::npos) << result.output;
    };
    const std::string whole = read_file(file());
    const TemporaryFolder there;
    const fs::path other = there.path() / "other.tar.zst";
    const std::string skippable("\x50\x2a\x4d\x18\x04\0\0\0text", 12);
    for (const std::string& changed : {skippable + whole, whole + skippable}) {
        write_file_atomically(other, changed);
        says(other, "does not end with the hash of its bytes");
    }
    // Made by other programs of the same files, with a last frame that fits.
    const auto repacked = [&](const std::string& edit, const std::string& options) {
        const ProcessResult made = shell(
            there.path(),
            "rm -rf salt-lake && tar --zstd -xf '" + file().string() + "' && cd salt-lake && " +
                edit + " && find . -type f ! -name SHA256SUMS | sed 's,^./,,' | LC_ALL=C sort | " +
                "xargs sha256sum > SHA256SUMS && cd .. && rm -f other.tar other.tar.zst && tar " +
                options + " -cf other.tar salt-lake/* && zstd -q other.tar && " +
                "printf '\\120\\052\\115\\030\\100\\000\\000\\000' > frame && "
                "sha256sum other.tar.zst | cut -c1-64 | tr -d '\\n' >> frame && "
                "cat frame >> other.tar.zst");
        EXPECT_EQ(made.exit_status, 0) << made.errors;
        return other;
    };
    const std::string as_here = "--format=ustar --owner=0 --group=0 --numeric-owner --mtime=@0";
    says(repacked("true", ""), "not the bundle that is made of what it holds");
    says(repacked("true", as_here + " --sort=name"), "not the bundle that is made");
    says(repacked("echo 'All of it was verified.' >> VERIFY.txt", as_here), "VERIFY.txt");
    // Without its list nobody looked at the form.
    ASSERT_EQ(shell(there.path(),
                    "rm salt-lake/SHA256SUMS; tar --zstd -cf none.tar.zst salt-lake; "
                    "mv none.tar.zst other.tar.zst; zip -q -r other.zip salt-lake")
                  .exit_status,
              0);
    for (const char* name : {"other.tar.zst", "other.zip"}) {
        const ProcessResult result =
            runcert({"verify", (there.path() / name).string(), "--pubkey", signed_->public_key()});
        EXPECT_EQ(result.exit_status, 1) << result.output;
        EXPECT_TRUE(holds(result.output, "SHA256SUMS is missing")) << result.output;
    }
}

TEST_F(BundleTest, SupersededSignaturesStayBehind) {
    const TemporaryFolder there;
    const fs::path run = there.path() / "run";
    copy_run(run);
    fs::create_directory(run / "superseded");
    write_file_atomically(run / "superseded" / "report.json.minisig", "old");
    const ProcessResult made = bundle(run, there.path() / "b.tar.zst");
    EXPECT_EQ(made.exit_status, 0) << made.errors;
    EXPECT_NE(made.output.find("left out  superseded"), std::string::npos) << made.output;
    EXPECT_TRUE(read_file(there.path() / "b.tar.zst") == read_file(file()));
}

TEST_F(BundleTest, RosterAndAuthorityGoAlong) {
    const TemporaryFolder there;
    ASSERT_EQ(shell(there.path(),
                    "ssh-keygen -q -t ed25519 -N '' -C someone -f s; (printf 'measurer '; cat "
                    "s.pub) > r; openssl req -x509 -newkey "
                    "ed25519 -nodes -keyout k.pem -out ca.pem -subj /CN=authority")
                  .exit_status,
              0);
    const std::string roster = (there.path() / "r").string(),
                      ca = (there.path() / "ca.pem").string();
    const fs::path out = there.path() / "o.tar.zst";
    ASSERT_EQ(bundle(signed_->run(), out, {"--roster", roster, "--tsa-ca", ca}).exit_status, 0);
    const UnpackedBundle unpacked = unpack_bundle(out);
    EXPECT_EQ(read_file(unpacked.run_dir / "keys" / "roster"), read_file(roster));
    EXPECT_EQ(read_file(unpacked.run_dir / "keys" / "tsa-ca.pem"), read_file(ca));
    EXPECT_TRUE(holds(read_file(unpacked.run_dir / "VERIFY.txt"),
                      "--roster salt-lake/keys/roster --tsa-ca salt-lake/keys/tsa-ca.pem"));
    EXPECT_TRUE(holds(read_file(unpacked.run_dir / "VERIFY.txt"), "vouch for nobody"));
    for (const char* option : {"--roster", "--tsa-ca", "--pubkey"})
        expect_refused(bundle(signed_->run(), there.path() / "p.tar.zst",
                              {option, (there.path() / "k.pem").string()}),
                       {"secret key", "k.pem"});
    expect_refused(bundle(signed_->run(), there.path() / "p.tar.zst",
                          {"--pubkey", (signed_->path() / "measurer.key").string()}),
                   {"secret key", "measurer.key"});
    // A secret key whose comment was changed.
    std::string secret = read_file(signed_->path() / "measurer.key");
    write_quickly(there.path() / "list", "# roster of" + secret.substr(secret.find('\n')));
    expect_refused(bundle(signed_->run(), there.path() / "p.tar.zst",
                          {"--roster", (there.path() / "list").string()}),
                   {"list, line 2"});
    EXPECT_FALSE(fs::exists(there.path() / "p.tar.zst"));
    // verify takes keys or a roster.
    const fs::path with_both = there.path() / "both.tar.zst";
    ASSERT_EQ(
        bundle(signed_->run(), with_both, {"--roster", roster, "--pubkey", signed_->public_key()})
            .exit_status,
        0);
    EXPECT_FALSE(
        holds(read_file(unpack_bundle(with_both).run_dir / "VERIFY.txt"), "--pubkey salt-lake"));
}

constexpr const char* sign_and_stamp =
    "ssh-keygen -q -t ed25519 -N '' -C judge -f judge;"
    "ssh-keygen -q -Y sign -f judge -n judge@runcert run/report.json;"
    "printf 'judge %s\\n' \"$(cat judge.pub)\" > roster;"
    "printf '[tsa]\\nserial=serial\\nsigner_digest=sha256\\ndefault_policy=1.2.3\\n"
    "digests=sha512\\naccuracy=secs:1\\n' > tsa.cnf; echo 01 > serial;"
    "openssl req -x509 -newkey rsa:2048 -nodes -keyout tsa.pem -out tsa.crt -subj /CN=authority "
    "-addext extendedKeyUsage=critical,timeStamping;"
    "openssl ts -query -data run/report.json.minisig -sha512 -cert -out "
    "run/report.json.minisig.tsq;"
    "openssl ts -reply -config tsa.cnf -section tsa -signer tsa.crt -inkey tsa.pem -queryfile "
    "run/report.json.minisig.tsq -out run/report.json.minisig.tsr";

TEST_F(BundleTest, OtherSignaturesAndStampsAreCheckedByWhatVerifyTxtSays) {
    for (const char* program : {"ssh-keygen", "openssl"})
        if (!has_program(program)) GTEST_SKIP() << program << " is not installed";
    const TemporaryFolder there;
    copy_run(there.path() / "run");
    const ProcessResult made = shell(there.path(), sign_and_stamp);
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    ASSERT_EQ(bundle(there.path() / "run", there.path() / "salt-lake.tar.zst",
                     {"--roster", (there.path() / "roster").string(), "--tsa-ca",
                      (there.path() / "tsa.crt").string()})
                  .exit_status,
              0);
    const UnpackedBundle unpacked = unpack_bundle(there.path() / "salt-lake.tar.zst");
    std::string line = "true";
    for (std::string command : commands_of(read_file(unpacked.run_dir / "VERIFY.txt"))) {
        if (!command.starts_with("sed") && !command.starts_with("ssh-keygen") &&
            !command.starts_with("openssl"))
            continue;
        for (std::size_t at = 0; (at = command.find("ROLE")) != std::string::npos;)
            command.replace(at, 4, "judge");
        line += "; " + command;
    }
    const ProcessResult result = shell(unpacked.run_dir, line);
    EXPECT_EQ(result.exit_status, 0) << line << result.output << result.errors;
    for (const char* said : {"judge@runcert\n", "Good \"judge@runcert\" signature",
                             "Policy OID: ", "Verification: OK"})
        EXPECT_TRUE(holds(result.output + result.errors, said)) << said << result.output;
    // And not where the report is another.
    write_quickly(unpacked.run_dir / "report.json", "{}");
    EXPECT_NE(shell(unpacked.run_dir, line).exit_status, 0);
}

TEST_F(BundleTest, SeveralKeysBeforeTheFolder) {
    const TemporaryFolder there;
    const std::string other = (there.path() / "judge").string();
    ASSERT_EQ(runcert({"keygen", "--out", other, "--no-password"}).exit_status, 0);
    const fs::path out = there.path() / "o.tar.zst";
    const ProcessResult made =
        runcert({"bundle", "--out", out.string(), "--pubkey", other + ".pub", "--pubkey",
                 signed_->public_key(), signed_->run().string()});
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    const auto keys = contents_of(unpack_bundle(out).run_dir / "keys");
    ASSERT_EQ(keys.size(), 2u);
    std::string all;
    for (const auto& [name, text] : keys)
        all += text;
    EXPECT_TRUE(holds(all, signed_->public_line())) << all;
}

TEST_F(BundleTest, NoFileIsReplacedWithoutForce) {
    const TemporaryFolder there;
    const fs::path out = there.path() / "o.tar.zst";
    write_quickly(out, "mine");
    expect_refused(bundle(signed_->run(), out), {"exists already", "--force"});
    EXPECT_EQ(read_file(out), "mine");
    EXPECT_EQ(bundle(signed_->run(), out, {"--force"}).exit_status, 0);
    EXPECT_NE(read_file(out), "mine");
}

struct Spoilt {
    std::string what;
    std::string line;  ///< that spoils the folder
    std::vector<std::string> said;
};

TEST_F(BundleTest, AFolderThatIsNotWholeIsRefused) {
    const std::vector<Spoilt> cases{
        {"missing", "rm 3-screened.ecsv", {"3-screened.ecsv", "missing"}},
        {"changed", "echo >> recording.primary.pos", {"recording.primary.pos", "changed"}},
        {"another file", "echo x > notes.txt", {"\"notes.txt\"", "no part of the run"}},
        {"hidden file", "echo x > .profile", {"\".profile\"", "no part of the run"}},
        {"control characters", "echo x > $'a\\e[31m\\nb'", {"a\\x1b[31m\\x0ab"}},
        {"folder", "mkdir more; echo x > more/y", {"\"more\"", "no part of the run"}},
        {"key of another kind", "mkdir keys; echo x > keys/id_rsa", {"\"keys/id_rsa\""}},
        {"link", "rm -f report.html; ln -s /etc/hostname report.html", {"\"report.html\""}},
        {"no report", "rm report.json", {"report.json"}},
        {"broken report", "echo '{' > report.json", {"report.json", "Not a report"}},
        {"id that is a path",
         "sed -i 's/\"id\": \"salt-lake\"/\"id\": \"..\\/x\"/' report.json",
         {"cannot be the name of a folder"}}};
    for (const Spoilt& one : cases) {
        SCOPED_TRACE(one.what);
        const TemporaryFolder there;
        copy_run(there.path() / "run");
        ASSERT_EQ(shell(there.path() / "run", one.line).exit_status, 0);
        expect_refused(bundle(there.path() / "run", there.path() / "o.tar.zst"), one.said);
        EXPECT_FALSE(fs::exists(there.path() / "o.tar.zst"));
    }
    expect_refused(bundle("/no/such/folder", signed_->path() / "x"), {"no such run folder"});
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
