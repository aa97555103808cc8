#include "trust/bundle.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "run/staging_folder.h"
#include "schemas/common/product_files.h"
#include "store/archive.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "trust/attestation.h"
#include "trust/roster.h"
#include "trust/signature.h"
#include "trust/signature_files.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* bundle_text_file = "VERIFY.txt";
constexpr const char* timing_file = "run.yaml";

/// The facts of a run's report, whose attempt can name the folder in a bundle.
ReportFacts bundled_report(const fs::path& run_dir) {
    ReportFacts report = read_report_facts(run_dir);
    const std::string& attempt = report.attempt_id;
    if (!is_plain_name(attempt) || attempt.find('/') != std::string::npos)
        throw Failure((run_dir / "report.json").string(),
                      fmt::format("the attempt's id \"{}\" cannot be the name of a folder",
                                  escape_for_message(attempt)),
                      "Certify again under an id that begins with a letter or digit");
    return report;
}

bool is_written_beside_the_report(const std::string& name) {
    static const std::set<std::string> plain{"report.json", timing_file, bundle_sums_file,
                                             bundle_text_file};
    return plain.contains(name) || is_page_name(name) || belongs_to_signatures(name);
}

bool is_bundled_key(const std::string& name) {
    return name == bundle_roster_file || name == bundle_tsa_file ||
           (name.starts_with("keys/") && name.ends_with(".pub") &&
            name.find('/', 5) == std::string::npos);
}

/// The names of all that lies in a run folder.
struct FolderContents {
    std::vector<std::string> known = {};
    std::vector<std::string> unknown = {};
    std::vector<std::string> leftovers = {};
};

FolderContents contents_of(const fs::path& run_dir, const ReportFacts& report) {
    FolderContents contents;
    const std::set<std::string> attestations = attestation_names(run_dir);
    for (auto entry = fs::recursive_directory_iterator(run_dir);
         entry != fs::recursive_directory_iterator(); ++entry) {
        const std::string name = entry->path().lexically_relative(run_dir).generic_string();
        const fs::file_type type = entry->symlink_status().type();
        const bool superseded = type == fs::file_type::directory && name == superseded_folder;
        if (superseded || (entry.depth() == 0 && name.starts_with(program_leftover))) {
            contents.leftovers.push_back(name);
            entry.disable_recursion_pending();
        } else if (type == fs::file_type::directory &&
                   (name == bundle_keys_folder || name == attestations_folder)) {
            continue;
        } else if (type == fs::file_type::directory) {
            contents.unknown.push_back(name);
            entry.disable_recursion_pending();
        } else if (type == fs::file_type::regular &&
                   (report.subjects.contains(name) || is_written_beside_the_report(name) ||
                    is_bundled_key(name) || attestations.contains(name))) {
            contents.known.push_back(name);
        } else {
            contents.unknown.push_back(name);
        }
    }
    for (auto* names : {&contents.known, &contents.unknown, &contents.leftovers})
        std::sort(names->begin(), names->end());
    return contents;
}

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "\"" : ", \"") + escape_for_message(name, 100) + "\"";
    return text;
}

void require_whole(const fs::path& run_dir, const ReportFacts& report,
                   const FolderContents& contents) {
    if (!contents.unknown.empty())
        throw Failure(run_dir.string(),
                      fmt::format("the folder holds what is no part of the run: {}",
                                  listed(contents.unknown)),
                      "Move it out of the folder. What belongs to the attempt (a recording, wind) "
                      "is named in the attempt and certified again");
    VerificationStep files = verify_files(run_dir, report);
    // These stay behind.
    std::erase_if(files.details,
                  [](const std::string& detail) { return detail.starts_with(program_leftover); });
    if (!files.details.empty())
        throw Failure(run_dir.string(),
                      fmt::format("{}: {}", files.finding, fmt::join(files.details, "; ")),
                      "Bundle the folder as `runcert certify` left it, or certify again");
    if (!fs::exists(run_dir / bundle_sums_file)) return;
    const std::vector<SumProblem> problems = check_sums(run_dir);
    if (!problems.empty())
        throw Failure((run_dir / problems.front().file).string(),
                      fmt::format("{} {}", problems.front().file, problems.front().problem),
                      fmt::format("Unpack the bundle again; or, if the change is meant, remove {}",
                                  bundle_sums_file));
}

/// A text that goes among the keys; one that holds a secret is refused.
std::string public_text(const fs::path& file, std::string_view what, std::string_view must_hold) {
    std::string text = read_handwritten(file);
    if (text.find("PRIVATE KEY") != std::string::npos ||
        text.find("secret key") != std::string::npos)
        throw Failure(file.string(), "this is or holds a secret key, which nobody else may have",
                      fmt::format("Give {}", what));
    if (text.find(must_hold) == std::string::npos)
        throw Failure(file.string(), fmt::format("this is not {}", what),
                      fmt::format("Give {}", what));
    return text;
}

/// The files of keys/ that were asked for. Public keys are written anew under their id, so that no
/// comment or file name of whoever bundles comes along.
std::map<std::string, std::string> given_keys(const BundleInput& input) {
    std::map<std::string, std::string> keys;
    for (const fs::path& file : input.public_keys) {
        const std::string text =
            public_text(file, "a public key, the file NAME.pub that `runcert keygen` wrote", "");
        const PublicKey key = parse_public_key(text, file.string());
        const std::string name = fmt::format("{}/{}.pub", bundle_keys_folder, key_id_text(key));
        const auto [place, fresh] = keys.emplace(name, public_key_file(key));
        if (!fresh && place->second != public_key_file(key))
            throw Failure(file.string(),
                          fmt::format("two different keys have the id {}", key_id_text(key)),
                          "Ask the two owners which of them is genuine");
    }
    if (input.roster) {
        const std::string text =
            public_text(*input.roster, "a roster in the form of OpenSSH's allowed signers", " ");
        // Anything else, such as a secret key whose comment was changed, is no roster.
        (void)parse_roster(text, input.roster->string());
        keys[bundle_roster_file] = text;
    }
    if (input.tsa_ca)
        keys[bundle_tsa_file] =
            public_text(*input.tsa_ca, "a certificate in PEM form", "-----BEGIN CERTIFICATE-----");
    return keys;
}

/// The keys that made the run's signatures in minisign's form, as these themselves say: a roster in
/// OpenSSH's form does not tell the ids that minisign knows keys by.
std::vector<PublicKey> keys_signed_with(const fs::path& run_dir) {
    std::vector<PublicKey> keys;
    for (const SignatureFile& file : signature_files(run_dir)) {
        if (file.kind != SignatureKind::minisign) continue;
        try {
            const SignatureClaims claims = read_signature_claims(file.text, file.name);
            const PublicKey key =
                parse_public_key(parse_trusted_comment(claims.trusted_comment).key, file.name);
            if (key.key_id == claims.key_id) keys.push_back(key);
        } catch (const Failure&) {
            // Whether it is a signature is for verification to say.
        }
    }
    return keys;
}

/// Adds a file for each key of a roster: whoever has another program than ssh-keygen needs one.
void add_keys_of(const Roster& roster, const fs::path& run_dir,
                 std::map<std::string, std::string>& keys) {
    constexpr std::size_t digits = 16;
    const std::vector<PublicKey> signed_with = keys_signed_with(run_dir);
    for (const RosterEntry& entry : roster.entries) {
        const std::string text = ssh_key_text(entry.key);
        const auto known = std::ranges::find_if(signed_with, [&](const PublicKey& key) {
            return ssh_key_text(ssh_key_of(key.key)) == text;
        });
        if (known != signed_with.end())
            keys[fmt::format("{}/{}.pub", bundle_keys_folder, key_id_text(*known))] =
                public_key_file(*known);
        else
            keys[fmt::format("{}/{}{}.pub", bundle_keys_folder, ssh_key_begin,
                             sha256_hex(text).substr(0, digits))] = text + "\n";
    }
}

/// What goes into a bundle, by name, without SHA256SUMS.
std::map<std::string, PackedFile> chosen_files(const BundleInput& input, const ReportFacts& report,
                                               const FolderContents& contents) {
    static const std::set<std::string> made_anew{timing_file, bundle_sums_file, bundle_text_file};
    std::map<std::string, PackedFile> files;
    for (const std::string& name : contents.known)
        if (!made_anew.contains(name)) files[name] = {.name = name, .source = input.run_dir / name};
    std::map<std::string, std::string> keys = given_keys(input);
    if (!keys.contains(bundle_roster_file) && files.contains(bundle_roster_file))
        keys[bundle_roster_file] = read_handwritten(input.run_dir / bundle_roster_file);
    if (const auto roster = keys.find(bundle_roster_file); roster != keys.end())
        add_keys_of(parse_roster(roster->second, bundle_roster_file), input.run_dir, keys);
    for (const auto& [name, text] : keys)
        files[name] = {.name = name, .text = text};
    std::vector<std::string> names;
    for (const auto& [name, file] : files)
        names.push_back(name);
    files[bundle_text_file] = {.name = bundle_text_file,
                               .text = bundle_text({.attempt = report.attempt_id,
                                                    .report_id = report.report_id,
                                                    .program_version = report.program_version,
                                                    .source_revision = report.source_revision,
                                                    .program_home = report.program_home,
                                                    .form = input.form,
                                                    .files = std::move(names)})};
    return files;
}

UnpackedBundle unpack_bytes(std::string_view bytes, const std::string& where) {
    UnpackedBundle bundle{.folder = std::make_unique<TemporaryFolder>(), .run_dir = {}};
    std::set<std::string> tops;
    for (const std::string& name :
         unpack_archive(bytes, where, bundle.folder->path(), bundle_limits(bytes.size())))
        tops.insert(name.substr(0, name.find('/')));
    if (tops.size() != 1 ||
        !fs::is_regular_file(bundle.folder->path() / *tops.begin() / "report.json"))
        throw Failure(where,
                      "this is no bundle of a run: one holds one folder, and that a report.json",
                      "Give the file that `runcert bundle` wrote");
    bundle.run_dir = bundle.folder->path() / *tops.begin();
    return bundle;
}

/// Failure for a page that shows a report: it cannot be checked alone.
void refuse_page(const std::string& file, std::string_view bytes) {
    constexpr std::string_view title = "Measurement report ";
    constexpr std::size_t digits = 16, longest_name = 100;
    const bool is_page = bytes.starts_with("%PDF") || bytes.starts_with("<!DOCTYPE html");
    const std::size_t at = is_page ? bytes.find(title) : std::string_view::npos;
    if (at == std::string_view::npos) return;
    const std::string_view rest = bytes.substr(at + title.size(), longest_name);
    const std::string_view id = rest.substr(0, digits);
    if (id.find_first_not_of("0123456789abcdef") != std::string_view::npos) return;
    std::string_view attempt = rest.substr(std::min(rest.size(), digits + 2));
    attempt = attempt.substr(0, attempt.find_first_of(")<"));
    throw Failure(
        file,
        fmt::format("this is the readable copy of report {} (attempt \"{}\"), and cannot be "
                    "checked alone",
                    id, escape_for_message(attempt)),
        fmt::format("Ask whoever sent it for the bundle or the run folder, and check that: runcert "
                    "verify {}.zip --roster ROSTER --recompute",
                    shell_word(plain_text(attempt))));
}

}  // namespace

GivenRun::GivenRun(const fs::path& given) : folder_(given) {
    if (!fs::is_regular_file(given)) return;
    bundle_ = unpack_bundle(given);
    folder_ = bundle_->run_dir;
}

fs::path GivenRun::run_folder_to_write() {
    if (!bundle_) return folder_;
    const fs::path kept = bundle_->run_dir.filename();
    if (fs::exists(fs::symlink_status(kept)))
        throw Failure(
            kept.string(), "the bundle is unpacked to a folder of that name, which is there",
            "Name that folder in place of the bundle if it is of the same run, or move it "
            "away");
    StagingFolder staging(kept);
    fs::copy(bundle_->run_dir, staging.path(), fs::copy_options::recursive);
    staging.publish();
    folder_ = kept;
    bundle_.reset();
    return kept;
}

int read_given(const fs::path& given, const std::function<int(const fs::path& folder)>& read) {
    const GivenRun run(given);
    const auto by_its_name = [&](std::string said) {
        replace_all(said, run.folder().string(), given.string());
        return said;
    };
    try {
        require_known_versions(run.folder());
        return read(run.folder());
    } catch (const Failure& failure) {
        if (!run.is_bundle()) throw;
        throw Failure(by_its_name(failure.where()), by_its_name(failure.problem()),
                      by_its_name(failure.remedy()));
    }
}

std::vector<std::string> unknown_files(const std::filesystem::path& run_dir) {
    return contents_of(run_dir, bundled_report(run_dir)).unknown;
}

Bundle make_bundle(const BundleInput& input) {
    if (!fs::is_directory(input.run_dir))
        throw Failure(input.run_dir.string(), "there is no such run folder",
                      "Name a folder that `runcert certify` wrote");
    require_within_limits(input.run_dir);
    const ReportFacts report = bundled_report(input.run_dir);
    const FolderContents contents = contents_of(input.run_dir, report);
    require_whole(input.run_dir, report, contents);
    std::string sums;
    std::uint64_t unpacked = 0;
    std::vector<PackedFile> packed;
    for (auto& [name, file] : chosen_files(input, report, contents)) {
        sums += sums_line(
            file.source.empty() ? sha256_hex(file.text) : digest_file(file.source).sha256, name);
        unpacked += file.source.empty() ? file.text.size() : fs::file_size(file.source);
        packed.push_back(file);
        packed.back().name = report.attempt_id + "/" + name;
    }
    packed.push_back(
        {.name = fmt::format("{}/{}", report.attempt_id, bundle_sums_file), .text = sums});
    Bundle bundle{.attempt = report.attempt_id,
                  .bytes = pack_archive(packed, input.form),
                  .files = packed.size(),
                  .left_out = contents.leftovers};
    if (fs::exists(input.run_dir / timing_file)) bundle.left_out.emplace_back(timing_file);
    if (unpacked + sums.size() > bundle_limits(bundle.bytes.size()).bytes)
        throw Failure(input.run_dir.string(),
                      "its files repeat themselves so much that a bundle of them would be refused "
                      "as one made to fill a disk",
                      "Hand over the folder itself");
    // A file that changed between its hash and its packing is found here.
    const UnpackedBundle again = unpack_bytes(bundle.bytes, "the bundle just made");
    if (const auto problems = check_sums(again.run_dir); !problems.empty())
        throw Failure((input.run_dir / problems.front().file).string(),
                      "the file changed while it was bundled",
                      "Try again when nothing writes to it");
    return bundle;
}

UnpackedBundle unpack_bundle(const std::filesystem::path& file, const std::string& known_as) {
    const FileView view(file);
    const std::string name = known_as.empty() ? file.string() : known_as;
    refuse_page(name, view.bytes());
    return unpack_bytes(view.bytes(), name);
}

std::optional<std::string> deviation_of_bundle(const std::filesystem::path& file,
                                               const std::filesystem::path& unpacked_run_dir) {
    const FileView view(file);
    const std::string_view bytes = view.bytes();
    try {
        const ArchiveForm form = form_of(bytes);
        const bool tar = form == ArchiveForm::tar_zst;
        if (tar && !ends_with_its_hash(bytes)) return "it does not end with the hash of its bytes";
        const Bundle again = make_bundle({.run_dir = unpacked_run_dir, .form = form});
        if (again.bytes == bytes) return std::nullopt;
        const std::uint64_t most = bundle_limits(bytes.size()).bytes;
        if (!tar || unpacked_sha256(again.bytes, "the bundle made again", most) !=
                        unpacked_sha256(bytes, file.string(), most))
            return "it is not the bundle that is made of what it holds: names, order, owners, "
                   "times, VERIFY.txt";
        return std::nullopt;
    } catch (const Failure& failure) {
        return failure.problem();
    }
}

}  // namespace runcert
