#include <fmt/format.h>

#include "schemas/common/role_signatures.h"
#include "store/atomic_file.h"
#include "store/pattern.h"
#include "store_test_support.h"
#include "trust/roster.h"
#include "trust/ssh_signature.h"

// Rosters, judged by ssh-keygen on the same lines.

namespace runcert::test::RUNCERT_FILE {
namespace {

const std::string key_text =
    "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAINdamAGCsQq31Uv+08lkBzoO4XLz2qYjJa8CGmj3B1Ea";

namespace fs = std::filesystem;

UtcSecond time_of(std::string_view iso) {
    return parse_iso_utc(iso).value();
}

/// Two keys of ssh-keygen's, and a signature of a file by the first.
class WithSshKeygen : public testing::Test {
  protected:
    void SetUp() override {
        for (const char* name : {"first", "second"}) {
            ASSERT_EQ(run_process({"ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", name, "-f",
                                   (folder.path() / name).string()})
                          .exit_status,
                      0);
            const std::string text = slurp(folder.path() / (std::string(name) + ".pub"));
            keys[name == std::string("second")] = text.substr(0, text.rfind(' '));
        }
        spill(file(), "{}\n");
        sign("measurer@runcert");
    }
    fs::path file() const { return folder.path() / "report.json"; }
    fs::path signature() const { return folder.path() / "report.json.sig"; }
    void sign(const std::string& name_space) const {
        fs::remove(signature());
        ASSERT_EQ(run_process({"ssh-keygen", "-q", "-Y", "sign", "-n", name_space, "-f",
                               (folder.path() / "first").string(), file().string()})
                      .exit_status,
                  0);
    }
    /// Whether ssh-keygen accepts the signature by that roster.
    bool accepted(const std::string& roster, const std::string& role, UtcSecond time) const {
        return check_ssh_signature(file(), signature(), roster, role, role + "@runcert", time)
            .valid;
    }

    TemporaryFolder folder;
    std::string keys[2];
};

/// Whether our reading of a roster lets the first of its keys sign in that role then.
bool allowed(const std::string& text, const std::string& role, UtcSecond time,
             const std::string& key) {
    for (const RosterEntry& entry : parse_roster(text, "roster").entries)
        if (ssh_key_text(entry.key) == key && entry.allows(role) && entry.is_valid_at(time))
            return true;
    return false;
}

TEST_F(WithSshKeygen, JudgesEveryLineAsWeDo) {
    const std::vector<std::string> fronts{
        "measurer",
        "judge",
        "judge,measurer",
        "\"measurer\"",
        "meas*",
        "m?asurer",
        "*,!measurer",
        "!measurer,*",
        "!judge,*",
        "!judge",
        "*",
        "measurer namespaces=\"measurer@runcert\"",
        "measurer namespaces=\"*@runcert\"",
        "measurer namespaces=\"file\"",
        "measurer namespaces=\"file,measurer@runcert\"",
        "measurer NAMESPACES=\"*,!measurer@runcert\"",
        "measurer valid-after=\"20260101Z\"",
        "measurer valid-before=\"20260101Z\"",
        "measurer valid-after=\"20251231Z\",valid-before=\"20260102Z\"",
        "measurer valid-before=\"20260701120000Z\"",
        "measurer valid-before=\"20260701115959Z\"",
        "measurer valid-after=\"20260701120000Z\"",
        "measurer valid-after=\"20260701120001Z\"",
        "measurer valid-after=\"202607011200Z\",namespaces=\"m*\"",
        "measurer valid-after=\"20260701\"",
        "   measurer   ",
        "\tmeasurer\t",
    };
    std::size_t yes = 0;
    for (const std::string& front : fronts) {
        const std::string roster = "# people\n\n" + front + " " + keys[0] + " A. Person\n";
        for (const char* iso : {"2026-07-01T12:00:00Z", "2026-01-01T00:00:00Z"}) {
            const UtcSecond time = time_of(iso);
            const bool theirs = accepted(roster, "measurer", time);
            yes += theirs ? 1U : 0U;
            EXPECT_EQ(allowed(roster, "measurer", time, keys[0]), theirs) << front << " " << iso;
        }
    }
    EXPECT_GT(yes, 15U);  // both answers occurred
    EXPECT_LT(yes, 2 * fronts.size() - 15);
}

TEST_F(WithSshKeygen, ALaterLineOfTheSameKeyCounts) {
    const std::string roster = "judge " + keys[0] + "\nmeasurer valid-before=\"20200101Z\" " +
                               keys[0] + "\nmeasurer " + keys[0] + "\n";
    const UtcSecond time = time_of("2026-07-01T12:00:00Z");
    EXPECT_TRUE(accepted(roster, "measurer", time));
    EXPECT_TRUE(allowed(roster, "measurer", time, keys[0]));
    EXPECT_FALSE(accepted("measurer " + keys[1] + "\n", "measurer", time));
}

TEST_F(WithSshKeygen, TheLineOfANewKeyIsOneOfItsPrincipals) {
    const KeyPair pair = generate_key_pair();
    spill(folder.path() / "roster",
          roster_line(pair.public_key, "measurer", "a person") + "\n" +
              roster_line(parse_public_key(public_key_line(pair.public_key), "k"), "judge", "b") +
              "\nmeasurer " + keys[0] + " c\n");
    const ProcessResult found =
        run_process({"ssh-keygen", "-Y", "find-principals", "-f",
                     (folder.path() / "roster").string(), "-s", signature().string()});
    EXPECT_EQ(found.exit_status, 0) << found.errors;
    EXPECT_EQ(found.output, "measurer\n");
    spill(folder.path() / "new.pub", ssh_key_text(ssh_key_of(pair.public_key.key)) + " new\n");
    const ProcessResult read =
        run_process({"ssh-keygen", "-l", "-f", (folder.path() / "new.pub").string()});
    EXPECT_EQ(read.output,
              "256 " + ssh_fingerprint(ssh_key_of(pair.public_key.key)) + " new (ED25519)\n")
        << read.errors;
    // The 32 bytes are the same key in both forms.
    const Roster roster = parse_roster(slurp(folder.path() / "roster"), "roster");
    EXPECT_EQ(ed25519_of(roster.entries[0].key), pair.public_key.key);
    EXPECT_EQ(roster.entries[0].who, "a person");
    EXPECT_TRUE(roster.entries[0].allows("measurer"));
    EXPECT_FALSE(roster.entries[0].allows("judge"));
}

TEST_F(WithSshKeygen, ReadsWhatASignatureClaims) {
    const SshSignature claims = parse_ssh_signature(slurp(signature()), "s");
    EXPECT_EQ(ssh_key_text(claims.key), keys[0]);
    EXPECT_EQ(claims.name_space, "measurer@runcert");
    EXPECT_EQ(claims.hash_algorithm, "sha512");
    const ProcessResult listed =
        run_process({"ssh-keygen", "-l", "-f", (folder.path() / "first.pub").string()});
    EXPECT_NE(listed.output.find(ssh_fingerprint(claims.key) + " "), std::string::npos);
}

TEST_F(WithSshKeygen, AChangedFileIsRefused) {
    spill(file(), "{} \n");
    EXPECT_FALSE(
        accepted("measurer " + keys[0] + "\n", "measurer", time_of("2026-07-01T12:00:00Z")));
}

// However cut or changed, the text is refused or still claims no other key or namespace unnoticed.
TEST_F(WithSshKeygen, DamagedSignaturesAreFailuresOrDoNotVerify) {
    const std::string text = slurp(signature());
    for (std::size_t end = 0; end + 1 < text.size(); end += 7)
        EXPECT_THROW((void)parse_ssh_signature(text.substr(0, end), "s"), Failure) << end;
    const SshSignature whole = parse_ssh_signature(text, "s");
    std::size_t refused = 0;
    for (std::size_t i = 0; i + 1 < text.size(); i += 11) {
        std::string damaged = text;
        damaged[i] = damaged[i] == 'x' ? 'y' : 'x';
        try {
            const SshSignature claims = parse_ssh_signature(damaged, "s");
            spill(signature(), damaged);
            EXPECT_FALSE(
                accepted("* " + keys[0] + "\n", "measurer", time_of("2026-07-01T12:00:00Z")))
                << i;
        } catch (const Failure&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 5U);
}

TEST(Roster, MalformedLinesAreNamed) {
    struct Case {
        std::string line;
        std::string said;
    };
    const std::vector<Case> cases{
        {"measurer", "ends before its key"},
        {"measurer " + key_text.substr(0, 11), "not a key"},
        {"measurer ssh-ed25519 AAAA!", "not a key"},
        {"measurer ssh-ed25519 AAAA", "not a public key"},
        {"measurer ssh-rsa " + key_text.substr(12), "the line says ssh-rsa"},
        {"measurer " + key_text.substr(0, key_text.size() - 8), "32 bytes"},
        {"measurer ssh-dss AAAA", "neither an option nor a type of key"},
        {"measurer cert-authority " + key_text, "cert-authority"},
        {"measurer namespaces=\"*\",cert-authority " + key_text, "cert-authority"},
        {"measurer namespaces=* " + key_text, "quotation marks"},
        {"measurer namespaces=\"* " + key_text, "never closed"},
        {"\"measurer " + key_text, "never closed"},
        {"measurer namespaces " + key_text, "has no value"},
        {"measurer namespaces=\"a\",namespaces=\"b\" " + key_text, "given twice"},
        {"measurer valid-after=\"2026-01-01\" " + key_text, "no time"},
        {"measurer valid-after=\"20260230Z\" " + key_text, "no time"},
        {"measurer valid-after=\"20270101Z\",valid-before=\"20260101Z\" " + key_text,
         "valid-before is not after"},
        {"measurer namespaces=\"a\"x " + key_text, "without a comma"},
        {"measurer unknown=\"a\" " + key_text, "\"unknown\""},
        {"measurer " + key_text + " \x1B[2J", "do not print"},
    };
    for (const Case& one : cases) {
        const Said said = failure_of([&] {
            (void)parse_roster("# first\nmeasurer " + key_text + "\n" + one.line + "\n", "people");
        });
        EXPECT_EQ(said.where, "people, line 3") << one.line;
        EXPECT_TRUE(said.contains(one.said)) << one.line << "\n" << said.problem;
    }
    EXPECT_TRUE(failure_of([] { (void)parse_roster("# none\n", "people"); }).contains("no key"));
}

TEST(Roster, ManyStarsDoNotTakeForEver) {
    const std::string text(2000, 'a');
    std::string pattern;
    for (int i = 0; i < 500; ++i)
        pattern += "a*";
    EXPECT_FALSE(matches_pattern(text, pattern + "b"));
    EXPECT_TRUE(matches_pattern(text, pattern));
}

TEST(Roster, RolesAreWords) {
    for (const char* role : {"measurer", "Chief-Judge_2", "x"})
        EXPECT_TRUE(is_role(role)) << role;
    for (const std::string& role :
         {std::string(), std::string("chief judge"), std::string("a@b"), std::string("Prüfer"),
          std::string("../x"), std::string("a\n"), std::string(65, 'a')})
        EXPECT_THROW(require_role(role, "--role"), Failure) << role;
}

TEST(Roster, APublicKeyAloneMaySignAsAnything) {
    const KeyPair pair = generate_key_pair();
    const Roster roster = roster_of_public_key(public_key_file(pair.public_key), "k", "k.pub");
    ASSERT_EQ(roster.entries.size(), 1U);
    EXPECT_TRUE(roster.entries[0].allows("anything"));
    EXPECT_EQ(roster.entries[0].key_id, pair.public_key.key_id);
    EXPECT_EQ(ed25519_of(roster.entries[0].key), pair.public_key.key);
    EXPECT_EQ(ssh_key_text(roster_of_public_key(key_text + " me\n", "k", "k.pub").entries[0].key),
              key_text);
    EXPECT_THROW((void)roster_of_public_key("hello", "k", "k.pub"), Failure);
}

TEST(OtherKey, IsCalledByItsName) {
    const KeyPair pair = generate_key_pair();
    EXPECT_EQ(other_key_in(secret_key_file(pair, std::nullopt)).kind, "");
    EXPECT_EQ(other_key_in(public_key_file(pair.public_key)).kind, "a public key");
    EXPECT_EQ(other_key_in(sign("m", pair.secret_key, "c")).kind, "a signature, not a key");
    EXPECT_EQ(other_key_in(key_text + " me\n").kind, "a public key of OpenSSH");
    EXPECT_EQ(other_key_in("-----BEGIN OPENSSH PRIVATE KEY-----\nb3\n").kind,
              "an OpenSSH private key");
    EXPECT_EQ(other_key_in("-----BEGIN PRIVATE KEY-----\nb3\n").kind, "a private key in PEM form");
    EXPECT_EQ(other_key_in("hello").kind, "");
}

TEST(Roster, ACommentThatLooksLikeALineForRuncertIsRefused) {  // was taken for a comment
    const std::string key = "judge " + key_text + "\n";
    for (const char* comment :
         {"# RunCert signatures judge=2", "#  runcert", "#Runcert close board", "# runcert: x",
          "## RUNCERT", "#\trunCERT signatures judge=2", "#-runcert", " # runcert", "#runcert",
          "#runcertsignatures judge=2", "#runcert signature judge=2", "# run\u200Bcert x",
          "#\u00A0runcert signatures judge=9"}) {
        try {
            (void)parse_roster(key + comment + "\n", "roster");
            ADD_FAILURE() << comment;
        } catch (const Failure& failure) {
            EXPECT_EQ(failure.where(), "roster, line 2") << comment;
        }
    }
    for (const char* comment : {"# keys of the club", "# for runcert", "# run certificates", "#"})
        EXPECT_EQ(parse_roster(key + comment + "\n", "roster").entries.size(), 1U) << comment;
}

TEST(SecretKey, IsSeenInAnyFile) {
    using namespace std::string_literals;
    const KeyPair pair = generate_key_pair();
    const std::string own = secret_key_file(pair, std::nullopt);
    for (const std::string& text :
         {own, "my notes\n" + own, "-----BEGIN OPENSSH PRIVATE KEY-----\nb3\n"s,
          "-----BEGIN PRIVATE KEY-----\nMC4\n"s,
          "-----BEGIN CERTIFICATE-----\n-----BEGIN RSA PRIVATE KEY-----\n"s,
          "-----BEGIN ENCRYPTED PRIVATE KEY-----\n"s, "-----BEGIN PGP PRIVATE KEY BLOCK-----\n"s,
          "untrusted comment: x\nRWRTY0IyAAAA\n"s, "AGE-SECRET-KEY-1QQ"s,
          "PuTTY-User-Key-File-3: ssh-ed25519"s, std::string(64, 'a') + "\n"})
        EXPECT_TRUE(holds_secret_key(text)) << text;
    for (const std::string& text :
         {public_key_file(pair.public_key), sign("m", pair.secret_key, "c"), key_text + " me\n",
          "0"s, ""s, "0123456789"s, "a private key is kept at home"s, std::string(64, 'a'),
          "-----BEGIN CERTIFICATE-----\nMII\n"s})
        EXPECT_FALSE(holds_secret_key(text)) << text;
}

}  // namespace
}  // namespace runcert::test::RUNCERT_FILE
