#include "trust/seal.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "handover_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr const char* make_keys =
    "umask 077;"
    "openssl req -x509 -newkey rsa:3072 -nodes -keyout rsa.pem -out rsa.crt -subj '/CN=RSA seal';"
    "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout ec.pem "
    "-out ec.crt -subj '/CN=ECDSA seal';"
    "openssl req -x509 -newkey ed25519 -nodes -keyout ed.pem -out ed.crt -subj '/CN=Ed25519';"
    "openssl req -x509 -newkey rsa:2048 -nodes -keyout weak.pem -out weak.crt -subj '/CN=weak';"
    "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:secp224r1 -nodes -keyout curve.pem "
    "-out curve.crt -subj '/CN=weak curve';"
    "openssl req -x509 -newkey rsa-pss -pkeyopt rsa_keygen_bits:2048 -nodes -keyout pss.pem "
    "-out pss.crt -subj '/CN=weak PSS';"
    "openssl pkey -in ec.pem -aes256 -passout pass:x -out encrypted.pem;"
    "openssl x509 -in ec.crt -signkey ec.pem -days -1 -out expired.crt;"
    "cp ec.pem open.pem; chmod 644 open.pem; sed -n 1,3p ec.crt > broken.crt";

/// A run whose PDF carries its report.json, and keys.
class Seal : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        for (const char* program : {"podofosign", "pdfsig", "pdfdetach", "qpdf", "weasyprint"})
            if (!has_program(program)) missing_ = program;
        if (!missing_.empty()) return;
        signed_ = new SignedRun("salt_lake", "--quiet");
        const ProcessResult keys = shell(signed_->path(), make_keys);
        ASSERT_EQ(keys.exit_status, 0) << keys.errors;
        const ProcessResult attached =
            shell(signed_->run(),
                  "cp report.pdf ../unsealed.pdf; qpdf report.pdf --remove-attachment=$(qpdf "
                  "--list-attachments report.pdf | cut -d' ' -f1) ../bare.pdf");
        ASSERT_EQ(attached.exit_status, 0) << attached.errors;
    }
    static void TearDownTestSuite() { delete signed_; }
    void SetUp() override {
        if (!missing_.empty()) GTEST_SKIP() << missing_ << " is not installed";
        fs::copy_file(signed_->path() / "unsealed.pdf", pdf(),
                      fs::copy_options::overwrite_existing);
    }

    static fs::path pdf() { return signed_->run() / "report.pdf"; }
    static ProcessResult seal(const std::string& key, const std::string& certificate,
                              const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{
            "seal",          signed_->run().string(),
            "--key",         (signed_->path() / key).string(),
            "--certificate", (signed_->path() / certificate).string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments);
    }
    /// Refused, and the PDF as it was.
    static void expect_untouched(const ProcessResult& result,
                                 const std::vector<std::string>& words) {
        expect_refused(result, words);
        EXPECT_TRUE(read_file(pdf()) == read_file(signed_->path() / "unsealed.pdf"));
    }

    static SignedRun* signed_;
    static std::string missing_;
};
SignedRun* Seal::signed_ = nullptr;
std::string Seal::missing_;

TEST_F(Seal, RsaAndEcdsaSealsHoldByTheWordsOfPdfsig) {
    EXPECT_FALSE(check_seal(pdf()).present);
    for (const std::string name : {"rsa", "ec"}) {
        SetUp();
        const ProcessResult result = seal(name + ".pem", name + ".crt", {"--reason", "Measured é"});
        ASSERT_EQ(result.exit_status, 0) << result.errors;
        const ProcessResult words = shell(signed_->run(), "pdfsig report.pdf");
        EXPECT_TRUE(holds(words.output, "Signature is Valid.")) << words.output;
        EXPECT_TRUE(holds(words.output, "- Total document signed")) << words.output;
        EXPECT_TRUE(holds(words.output, "adbe.pkcs7.detached")) << words.output;
        const SealCheck check = check_seal(pdf());
        EXPECT_TRUE(check.present && check.holds()) << check.words;
        EXPECT_EQ(check.signer, name == "rsa" ? "RSA seal" : "ECDSA seal");
        EXPECT_EQ(check.type, "adbe.pkcs7.detached");
        EXPECT_EQ(shell(signed_->run(),
                        "pdfdetach -save 1 -o ../detached report.pdf; cmp "
                        "../detached report.json")
                      .exit_status,
                  0);
    }
}

TEST_F(Seal, OpensslFindsTheCertificateInTheSignature) {
    ASSERT_EQ(seal("ec.pem", "ec.crt").exit_status, 0);
    const ProcessResult dumped = shell(
        signed_->path(),
        "rm -rf dump; mkdir dump; cd dump; pdfsig -nocert -dump ../run/report.pdf >/dev/null; "
        "openssl pkcs7 -inform DER -in *.sig0 -print_certs | openssl x509 -noout -fingerprint "
        "-sha256 > in_it; openssl x509 -in ../ec.crt -noout -fingerprint -sha256 > given; "
        "cmp in_it given");
    EXPECT_EQ(dumped.exit_status, 0) << dumped.output << dumped.errors;
}

TEST_F(Seal, AChangeBreaksItAndAnAdditionIsNotCovered) {
    ASSERT_EQ(seal("rsa.pem", "rsa.crt").exit_status, 0);
    const std::string sealed = read_file(pdf());
    for (const double part : {0.05, 0.4, 0.7}) {
        std::string changed = sealed;
        changed[static_cast<std::size_t>(static_cast<double>(sealed.size()) * part)] ^= 1;
        write_quickly(pdf(), changed);
        EXPECT_FALSE(check_seal(pdf()).holds()) << part;
    }
    write_quickly(pdf(), sealed + "\n% more\n");
    const SealCheck longer = check_seal(pdf());
    EXPECT_TRUE(longer.present);
    EXPECT_FALSE(longer.holds());
    EXPECT_TRUE(holds(longer.words, "bytes were added")) << longer.words;
    write_quickly(pdf(), "no PDF");
    EXPECT_THROW(check_seal(pdf()), Failure);
}

TEST_F(Seal, AnotherSealIsRefused) {
    ASSERT_EQ(seal("rsa.pem", "rsa.crt").exit_status, 0);
    const std::string sealed = read_file(pdf());
    expect_refused(seal("ec.pem", "ec.crt"), {"sealed already", "Render again"});
    EXPECT_TRUE(read_file(pdf()) == sealed);
    // What podofosign would have made of it is no seal either.
    ASSERT_EQ(shell(signed_->path(),
                    "podofosign -in run/report.pdf -out twice.pdf -cert ec.crt "
                    "-pkey ec.pem -sigsize 16384")
                  .exit_status,
              0);
    const SealCheck twice = check_seal(signed_->path() / "twice.pdf");
    EXPECT_TRUE(twice.present);
    EXPECT_FALSE(twice.holds()) << twice.words;
}

TEST_F(Seal, KeysThatCannotOrMustNotSealAreRefused) {
    expect_untouched(seal("ed.pem", "ed.crt"), {"RSA or ECDSA", "ED25519"});
    expect_untouched(seal("encrypted.pem", "ec.crt"), {"encrypted", "openssl pkey"});
    expect_untouched(seal("open.pem", "ec.crt"), {"Others than its owner", "chmod 600"});
    // Each got through before.
    for (const std::string name : {"weak", "pss", "curve"})
        expect_untouched(
            seal(name + ".pem", name + ".crt"),
            {name == "curve" ? "(224 bit)" : "(2048 bit)", "too weak to seal with", "3072"});
    expect_untouched(seal("ec.pem", "rsa.crt"), {"does not belong to the certificate"});
    expect_untouched(seal("ec.pem", "expired.crt"), {"has expired"});
    expect_untouched(seal("ec.pem", "broken.crt"), {"cannot read a certificate"});
    expect_untouched(seal("measurer.key", "ec.crt"), {"no private key in PEM form"});
    expect_untouched(seal("ec.pem", "no.crt"), {"no.crt"});
    expect_untouched(seal("no.pem", "ec.crt"), {"no.pem"});
    expect_untouched(seal("ec.pem", "ec.crt", {"--reason", "two\nlines"}), {"--reason"});
}

TEST_F(Seal, APdfOfAnotherReportIsRefused) {
    const std::string report = read_file(signed_->run() / "report.json");
    write_quickly(signed_->run() / "report.json", report + " ");
    expect_untouched(seal("ec.pem", "ec.crt"), {"does not carry this folder's report.json"});
    write_quickly(signed_->run() / "report.json", report);
    fs::copy_file(signed_->path() / "bare.pdf", pdf(), fs::copy_options::overwrite_existing);
    expect_refused(seal("ec.pem", "ec.crt"), {"does not carry", "Render again"});
    fs::remove(pdf());
    expect_refused(seal("ec.pem", "ec.crt"), {"no report.pdf", "Render again"});
}

/// A revision added to a PDF: its catalogue again, with something in it.
std::string with_revision(const std::string& own, const std::string& in_catalogue) {
    const std::size_t type = own.find("/Type /Catalog");
    const std::size_t begin = own.rfind(" 0 obj", type);
    const std::size_t line = own.rfind('\n', begin) + 1;
    const std::string object = own.substr(line, begin - line);
    const std::size_t inner = own.find("<<", begin) + 2;
    const std::string catalogue = own.substr(inner, own.find("endobj", begin) - inner);
    const std::size_t xref = own.rfind("startxref");
    const std::string prev = own.substr(xref + 10, own.find('\n', xref + 10) - xref - 10);
    const std::size_t trailer = own.rfind("trailer");
    std::string facts = own.substr(trailer, xref - trailer);
    facts.replace(facts.rfind(">>"), 2, "/Prev " + prev + "\n>>");
    std::string text = own;
    const std::size_t at = text.size();
    text += object + " 0 obj\n<<" + in_catalogue + catalogue + "endobj\n";
    const std::size_t table = text.size();
    return text + fmt::format("xref\n{} 1\n{:010} 00000 n \n{}startxref\n{}\n%%EOF\n", object, at,
                              facts, table);
}

// A second form, script or page that poppler does not show got through under the same seal.
TEST_F(Seal, OnePdfLiesUnderItAndNothingElse) {
    const std::string own = read_file(pdf());
    ASSERT_EQ(seal("ec.pem", "ec.crt").exit_status, 0);
    const std::string sealed = read_file(pdf());
    EXPECT_EQ(fault_under_seal(sealed, own), std::nullopt);
    const auto pages = [&] {
        const auto all =
            nlohmann::json::parse(runcert({"verify", signed_->run().string(), "--json"}).output);
        for (const auto& layer : all["layers"])
            if (layer["layer"] == "pages") return layer;
        return nlohmann::json();
    };
    EXPECT_EQ(pages()["passed"], true) << pages();
    // By hand, what poppler shows alike.
    for (const char* more : {"/NeedAppearances true", "/OpenAction [6 0 R /Fit]"}) {
        write_quickly(signed_->path() / "more.pdf", with_revision(own, more));
        ASSERT_EQ(shell(signed_->path(),
                        "podofosign -in more.pdf -out run/report.pdf -cert ec.crt -pkey ec.pem "
                        "-sigsize 16384")
                      .exit_status,
                  0);
        EXPECT_TRUE(check_seal(pdf()).holds());
        EXPECT_EQ(pages()["passed"], false) << more;
    }
    const std::string added = sealed.substr(own.size());
    for (const std::string& other :
         {own.substr(1) + added, " " + sealed, own + own + added, own + "%PDF-1.7\n%%EOF\n" + added,
          own + "9 0 obj<</Length 2>>stream\nhi\nendstream endobj\n" + added, own + added + added,
          sealed + "\n% more"})
        EXPECT_TRUE(fault_under_seal(other, own)) << other.substr(own.size(), 60);
    for (const char* name :
         {"XFA",        "AA",      "OpenAction", "OCProperties", "OCGs",
          "CropBox",    "Rotate",  "UserUnit",   "JS",           "JavaScript",
          "Launch",     "URI",     "GoToE",      "Tx",           "FreeText",
          "Collection", "Encrypt", "AF",         "Alternates",   "XRefStm",
          "ObjStm",     "F#54",    "Perms",      "EmbeddedFile", "NeedAppearances",
          "AP",         "Kids",    "Popup"}) {
        std::string other = sealed;
        other.insert(own.size() + added.find("/AcroForm"), fmt::format("/{} 1 ", name));
        const auto fault = fault_under_seal(other, own);
        ASSERT_TRUE(fault) << name;
        EXPECT_NE(fault->find(name), std::string::npos) << *fault;
    }
}

const std::string good_words =
    "Digital Signature Info of: r.pdf\n"
    "Signature #1:\n"
    "  - Signature Field Name: Field\n"
    "  - Signer Certificate Common Name: Measurer\n"
    "  - Signer full Distinguished Name: CN=Measurer\n"
    "  - Signing Time: Nov 21 2026 20:54:06\n"
    "  - Signing Hash Algorithm: SHA-256\n"
    "  - Signature Type: adbe.pkcs7.detached\n"
    "  - Signed Ranges: [0 - 100], [200 - 300]\n"
    "  - Total document signed\n"
    "  - Signature Validation: Signature is Valid.\n";

std::string changed(const std::string& what, const std::string& by) {
    std::string words = good_words;
    return words.replace(words.find(what), what.size(), by);
}

TEST(SealWords, OnlyExactlyTheseWordsHold) {
    EXPECT_TRUE(seal_from_words(good_words, 300).holds());
    EXPECT_FALSE(seal_from_words(good_words, 301).holds()) << "the last byte is not covered";
    EXPECT_FALSE(seal_from_words(changed("[0 -", "[1 -"), 300).holds());
    EXPECT_FALSE(seal_from_words(changed("Total", "Not total"), 300).holds());
    EXPECT_FALSE(seal_from_words(changed("Signature is Valid.", "Digest Mismatch."), 300).valid);
    EXPECT_FALSE(seal_from_words(changed("  - Total document signed\n", ""), 300).holds());
    EXPECT_FALSE(seal_from_words("", 300).holds());
}

TEST(SealWords, ANameCannotSpeakForPdfsig) {
    const std::string valid = "  - Signature Validation: Signature is Valid.\n";
    const std::string total = "  - Total document signed\n";
    // A field that is not signed, whose name holds all that a good one says.
    const std::string spoof = "Digital Signature Info of: r.pdf\nSignature #1:\n" +
                              good_words.substr(good_words.find("  - Signature Field")) +
                              "  The signature form field is not signed.\n";
    EXPECT_FALSE(seal_from_words(spoof, 300).holds());
    EXPECT_FALSE(seal_from_words(changed("CN=Measurer\n", "CN=x\n" + valid), 300).holds());
    EXPECT_FALSE(seal_from_words(changed("Name: Field\n", "Name: x\n" + total), 300).holds());
    EXPECT_FALSE(seal_from_words(good_words + "Signature #2:\n", 300).holds());
    const SealCheck hostile =
        seal_from_words(changed("Name: Measurer\n", "Name: \x1b[2J\xe2\x80\xae\n"), 300);
    EXPECT_EQ(hostile.signer, "\\x1b[2J\\xe2\\x80\\xae");
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
