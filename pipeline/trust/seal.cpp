#include "trust/seal.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "trust/bundle.h"
#include "trust/ssh_signature.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* room_for_signature = "16384";  // PoDoFo's own guess is too small for ECDSA
constexpr std::size_t longest_reason = 200;
constexpr unsigned least_curve_bits = 256;
constexpr const char* render_pdf =
    "Render again: `runcert-report --render-only --run-dir RUN_DIR --attempt RUN_DIR/attempt.yaml`";

/// The first line of what a program said.
std::string first_words(const std::string& said) {
    const std::string_view text = trim(said);
    return escape_for_message(text.substr(0, text.find('\n')), 200);
}

/// Runs `openssl SUBCOMMAND -in FILE OPTIONS`.
std::string require_openssl(const std::string& subcommand, const fs::path& file,
                            const std::vector<std::string>& options, const std::string& what,
                            const std::string& remedy) {
    const fs::path input = external_input(file);
    ExternalCall call{.command = {"openssl", subcommand, "-in", input.string()}, .inputs = {input}};
    call.command.insert(call.command.end(), options.begin(), options.end());
    const ProcessResult result = run_external(call);
    if (result.exit_status != 0) throw Failure(file.string(), what, remedy);
    return result.output;
}

void require_plain_private(const fs::path& key) {
    struct stat status {};
    if (::stat(key.c_str(), &status) == 0 && (status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
        throw Failure(key.string(), "others than its owner may read or change this secret key",
                      fmt::format("Run `chmod 600 {}`; if others could have read it, make another",
                                  key.string()));
    const std::string text = read_handwritten(key);
    if (text.find("ENCRYPTED") != std::string::npos)
        throw Failure(key.string(),
                      "the key is encrypted, and podofosign would take its password only on the "
                      "command line, where every user of the computer sees it",
                      "Decrypt it into a file that only you can read, seal, and remove that: "
                      "`umask 077; openssl pkey -in KEY.pem -out PLAIN.pem`");
    if (text.find("PRIVATE KEY-----") == std::string::npos)
        throw Failure(key.string(), "this is no private key in PEM form",
                      "Give the file that begins with -----BEGIN PRIVATE KEY-----. A key of "
                      "`runcert keygen` signs report.json, not PDFs");
}

/// The public half of the key, which must be of a kind that PDFs can be signed with.
std::string public_half(const fs::path& key) {
    const std::string described = require_openssl(
        "pkey", key, {"-passin", "pass:", "-noout", "-text_pub"},
        "openssl cannot read this private key", "Give an RSA or ECDSA key in PEM form");
    if (described.find("Modulus:") == std::string::npos &&
        described.find("ASN1 OID:") == std::string::npos)
        throw Failure(key.string(),
                      fmt::format("PDFs are sealed with RSA or ECDSA keys; this one is {}",
                                  first_words(described)),
                      "Make one: `openssl ecparam -name prime256v1 -genkey -noout -out KEY.pem`, "
                      "and have it certified. (Ed25519 keys sign report.json.)");
    const bool rsa = described.find("Modulus:") != std::string::npos;
    const std::size_t at = described.find("Public-Key: (");
    const std::string bits = at == std::string::npos ? "" : described.substr(at + 13);
    const auto strength = parse_integer(bits.substr(0, bits.find(' ')));
    if (!strength || *strength < (rsa ? least_rsa_bits : least_curve_bits))
        throw Failure(
            key.string(),
            fmt::format("this key is {}, which is too weak to seal with", first_words(described)),
            fmt::format("Use RSA of at least {} bits, or ECDSA on a curve of at least {} "
                        "bits (P-256)",
                        least_rsa_bits, least_curve_bits));
    return require_openssl("pkey", key, {"-passin", "pass:", "-pubout"},
                           "openssl cannot read this private key",
                           "Give an RSA or ECDSA key in PEM form");
}

void require_pair(const fs::path& key, const fs::path& certificate) {
    const std::string give = "Give the certificate in PEM form";
    read_handwritten(certificate);
    const std::string certified =
        require_openssl("x509", certificate, {"-noout", "-pubkey"},
                        "openssl cannot read a certificate in this file", give);
    if (certified != public_half(key))
        throw Failure(
            key.string(),
            fmt::format("this key does not belong to the certificate {}", certificate.string()),
            "Give the key and the certificate that was made for it");
    require_openssl("x509", certificate, {"-noout", "-checkend", "0"},
                    "the certificate has expired", "Have it renewed");
}

void require_reason(const std::string& reason) {
    bool printable = !reason.empty() && reason.size() <= longest_reason;
    for (const char c : reason)
        printable = printable && static_cast<unsigned char>(c) >= ' ' && c != '\x7f';
    if (!printable)
        throw Failure("--reason", "this is not one line of 1 to 200 bytes",
                      "Say in a few words why the report is sealed");
}

void require_sealable(const fs::path& pdf, const std::string& report) {
    if (!fs::exists(pdf))
        throw Failure(pdf.string(), "the run folder has no report.pdf to seal", render_pdf);
    const SealCheck before = check_seal(pdf);
    if (before.present)
        throw Failure(
            pdf.string(),
            fmt::format("the PDF is sealed already, and takes one seal: {}", before.words),
            render_pdf);
    if (fault_of_attachment(pdf, report))
        throw Failure(pdf.string(),
                      "the PDF does not carry this folder's report.json as its one attachment",
                      render_pdf);
}

}  // namespace

SealCheck seal_report(const std::filesystem::path& run_dir, const std::filesystem::path& key,
                      const std::filesystem::path& certificate, const std::string& reason) {
    const fs::path pdf = run_dir / "report.pdf";
    const std::string report = read_file(run_dir / "report.json");
    require_reason(reason);
    require_plain_private(key);
    require_pair(key, certificate);
    require_sealable(pdf, report);
    const TemporaryFolder folder;
    const fs::path sealed = folder.path() / "report.pdf";
    const std::vector<fs::path> inputs{external_input(pdf), external_input(certificate),
                                       external_input(key)};
    const ProcessResult signing =
        run_external({.command = {"podofosign", "-in", inputs[0].string(), "-out", "report.pdf",
                                  "-cert", inputs[1].string(), "-pkey", inputs[2].string(),
                                  "-reason", reason, "-sigsize", room_for_signature},
                      .folder = folder.path(),
                      .inputs = inputs});
    if (signing.exit_status != 0 || !fs::exists(sealed))
        throw Failure(pdf.string(),
                      fmt::format("podofosign could not seal it: {}", first_words(signing.errors)),
                      "The PDF is as it was. Try another key, or render the report again");
    SealCheck check = check_seal(sealed);
    if (!check.holds() || fault_of_attachment(sealed, report) ||
        fault_under_seal(read_file(sealed), read_file(pdf)))
        throw Failure(pdf.string(),
                      fmt::format("the seal that podofosign made does not hold: {}", check.words),
                      "The PDF is as it was. Try another key, or render the report again");
    write_file_atomically(pdf, read_file(sealed));
    return check;
}

}  // namespace runcert
