#include "trust/ssh_signature.h"

#include <fmt/format.h>

#include <cstdint>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/external_program.h"
#include "trust/signature_text.h"

namespace runcert {
namespace {

constexpr std::string_view armor_begin = "-----BEGIN SSH SIGNATURE-----";
constexpr std::string_view last_line = "-----END SSH SIGNATURE-----";
constexpr std::string_view magic = "SSHSIG";
constexpr std::string_view version_one("\0\0\0\1", 4);

[[noreturn]] void refuse_signature(const std::string& where, const std::string& what) {
    throw Failure(where, what, "Name a file that ssh-keygen -Y sign wrote, whole and unchanged");
}

std::string blob_of(std::string_view text, const std::string& where) {
    const std::vector<std::string_view> lines = signature_text::lines_of(text);
    if (lines.size() < 3 || lines.front() != armor_begin || lines.back() != last_line)
        refuse_signature(
            where, fmt::format("this is not an ssh signature: it does not stand between \"{}\" "
                               "and \"{}\"",
                               armor_begin, last_line));
    std::string base64;
    for (std::size_t i = 1; i + 1 < lines.size(); ++i)
        base64.append(lines[i]);
    auto blob = decode_base64(base64);
    if (!blob) refuse_signature(where, "the lines of the ssh signature are not base64");
    return std::move(*blob);
}

std::string_view take(std::string_view& rest, const char* what, const std::string& where) {
    const auto taken = take_wire_string(rest);
    if (!taken) refuse_signature(where, fmt::format("the ssh signature ends before its {}", what));
    return *taken;
}

}  // namespace

SshSignature parse_ssh_signature(std::string_view text, const std::string& where) {
    const std::string blob = blob_of(text, where);
    std::string_view rest = blob;
    if (!rest.starts_with(magic))
        refuse_signature(where, "this is not an ssh signature: no \"SSHSIG\"");
    rest.remove_prefix(magic.size());
    if (!rest.starts_with(version_one))
        refuse_signature(where, "the ssh signature is of a version that is not known here");
    rest.remove_prefix(version_one.size());
    SshSignature signature;
    signature.key = ssh_key_of_blob(std::string(take(rest, "public key", where)), where);
    signature.name_space = take(rest, "namespace", where);
    if (!is_printable_ascii(signature.name_space))
        refuse_signature(where, "the namespace of the ssh signature is not printable text");
    (void)take(rest, "reserved field", where);
    signature.hash_algorithm = take(rest, "hash algorithm", where);
    if (signature.hash_algorithm != "sha256" && signature.hash_algorithm != "sha512")
        refuse_signature(
            where, fmt::format("the ssh signature is over a hash \"{}\" that is not known here",
                               escape_for_message(signature.hash_algorithm)));
    (void)take(rest, "signature", where);
    if (!rest.empty()) refuse_signature(where, "there are bytes behind the ssh signature");
    return signature;
}

SshCheck check_ssh_signature(const std::filesystem::path& signed_file,
                             const std::filesystem::path& signature_file,
                             std::string_view allowed_signers, const std::string& principal,
                             const std::string& name_space, UtcSecond time) {
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "allowed_signers", allowed_signers);
    write_file_atomically(folder.path() / "signature", read_handwritten(signature_file));
    ProcessResult result;
    try {
        result =
            run_external({.command = {"ssh-keygen", "-Y", "verify", "-f", "allowed_signers", "-I",
                                      principal, "-n", name_space,
                                      "-Overify-time=" + compact_text(time), "-s", "signature"},
                          .folder = folder.path(),
                          .standard_input = signed_file});
    } catch (const Failure& failure) {
        throw Failure(signature_file.string(),
                      "ssh signatures are checked by ssh-keygen, which cannot be started: " +
                          failure.problem(),
                      failure.remedy());
    }
    if (result.exit_status == 0) return {.valid = true};
    const std::string_view said = trim(result.errors.empty() ? result.output : result.errors);
    return {.valid = false, .said = escape_for_message(said, 200)};
}

}  // namespace runcert
