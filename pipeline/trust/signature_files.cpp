#include "trust/signature_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "run/attempt_files.h"
#include "run/run_lock.h"
#include "schemas/common/product_files.h"
#include "schemas/products/products.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "trust/attestation.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view signed_file = "report.json";
constexpr std::string_view minisign_end = ".minisig";
constexpr std::string_view ssh_end = ".sig";
constexpr std::string_view time_stamp_end = ".tsr";
constexpr std::string_view query_end = ".tsq";
constexpr const char* sealed_file = "report.pdf";

bool is_file(const Folder& folder, const std::string& name) {
    return folder.kind_of(name) == EntryKind::file;
}

/// Copies a file of a run to what `to` superseded, beside that run's report.
void supersede(const Folder& run, const std::string& name, const Folder& to) {
    keep_copy(run, name, superseded_of(run, to));
}

bool same_in_both(const Folder& one, const Folder& other, const std::string& name) {
    return is_file(one, name) && is_file(other, name) && one.read(name) == other.read(name);
}

/// The name of the signature that a file belongs to: a time stamp, a query or itself.
std::string signature_of(const std::string& name) {
    for (const std::string_view end : {time_stamp_end, query_end})
        if (name.ends_with(end)) return name.substr(0, name.size() - end.size());
    return name;
}

void carry_signatures(const Folder& run, const Folder& made) {
    const bool unchanged = same_in_both(run, made, std::string(signed_file));
    for (const std::string& name : run.names()) {
        if (!belongs_to_signatures(name) || !is_file(run, name)) continue;
        const std::string signature = signature_of(name);
        const bool replaced = made.kind_of(signature) != EntryKind::none &&
                              is_file(run, signature) && !same_in_both(run, made, signature);
        if (!unchanged || replaced)
            supersede(run, name, made);
        else if (made.kind_of(name) == EntryKind::none)
            run.place(name, made);
        else if (!same_in_both(run, made, name))
            supersede(run, name, made);
    }
}

bool is_sealed(const fs::path& pdf) {
    const FileView view(pdf);
    return view.bytes().find("/ByteRange") != std::string_view::npos;
}

/// The files that a run's report names, with their SHA-256; none where it cannot be read.
std::map<std::string, std::string> named_by_report(const Folder& run) {
    try {
        return read_report_facts(run.path()).subjects;
    } catch (const Failure&) {
        return {};
    }
}

/// Brings what a folder of a run holds, at any depth, to `made`, where that has nothing of the
/// name.
void carry_folder(const Folder& run, const Folder& made, const std::string& name) {
    if (run.kind_of(name) == EntryKind::none) return;
    const Folder from = run.open(name);
    const Folder to = made.make(name);
    for (const std::string& each : from.names())
        if (from.kind_of(each) == EntryKind::folder)
            carry_folder(from, to, each);
        else if (to.kind_of(each) == EntryKind::none)
            from.place(each, to);
}

/// Whether every run makes a file of that name anew.
bool is_made_anew(const std::string& name) {
    return name == "report.json" || name == "run.yaml" || is_page_name(name);
}

/// Brings along the user's own files, and those of the run that are not as its report names them.
void carry_own_files(const Folder& run, const Folder& made) {
    const auto named = named_by_report(run);
    for (const std::string& name : run.names()) {
        const EntryKind kind = run.kind_of(name);
        if (is_made_anew(name) || kind == EntryKind::folder || belongs_to_signatures(name))
            continue;
        const auto of_run = named.find(name);
        const bool is_new = made.kind_of(name) == EntryKind::none;
        // What is neither named nor replaced may be long, and need not be read.
        const std::string sha256 = kind == EntryKind::file && (of_run != named.end() || !is_new)
                                       ? digest_file(run.path() / name).sha256
                                       : "";
        const bool is_of_run =
            of_run != named.end() && sha256 == of_run->second && is_file_of_a_run(name);
        if (is_of_run && is_product_name(name)) continue;
        if (is_of_run && (is_new || digest_file(made.path() / name).sha256 != sha256)) {
            const Folder kept = superseded_of(run, made);
            if (kept.kind_of(name) == EntryKind::none) run.place(name, kept);
        } else if (is_new)
            run.place(name, made);
        else if (kind == EntryKind::file && digest_file(made.path() / name).sha256 != sha256)
            supersede(run, name, made);
    }
}

}  // namespace

std::string superseded_name(const Folder& run) {
    constexpr std::size_t digits = 16;
    const std::string report(signed_file);
    return fmt::format(
        "{}/{}", superseded_folder,
        is_file(run, report) ? sha256_hex(run.read(report)).substr(0, digits) : "no-report");
}

Folder superseded_of(const Folder& run, const Folder& to) {
    const std::string report(signed_file);
    Folder kept =
        to.make(superseded_folder).make(fs::path(superseded_name(run)).filename().string());
    if (is_file(run, report) && kept.kind_of(report) == EntryKind::none)
        keep_copy(run, report, kept);
    return kept;
}

void keep_copy(const Folder& from, const std::string& name, const Folder& kept) {
    const std::string bytes = from.read(name);
    std::string free = name;
    for (int number = 2; kept.kind_of(free) != EntryKind::none; ++number) {
        if (kept.kind_of(free) == EntryKind::file && kept.read(free) == bytes) return;
        free = fmt::format("{}.{}", name, number);
    }
    kept.write(free, bytes);
}

bool is_signature_name(std::string_view name) {
    return name.starts_with(std::string(signed_file) + ".") &&
           (name.ends_with(minisign_end) || name.ends_with(ssh_end));
}

std::string time_stamp_name(std::string_view signature) {
    return std::string(signature).append(time_stamp_end);
}

std::string time_stamp_query_name(std::string_view signature) {
    return std::string(signature).append(query_end);
}

bool belongs_to_signatures(std::string_view name) {
    for (const std::string_view end : {time_stamp_end, query_end})
        if (name.ends_with(end)) return is_signature_name(name.substr(0, name.size() - end.size()));
    return name == log_proof_file || is_signature_name(name);
}

bool is_file_of_a_run(const std::string& name) {
    if (fs::path(name).filename() != name) return false;
    if (is_product_name(name) || belongs_to_signatures(name)) return true;
    if (name == attempt_copy_name) return true;
    for (const FieldRule& rule : attempt_schema().fields())
        if (!rule.series.empty() && name == rule.path + ".csv") return true;
    constexpr std::array begins{"profile.",      "recording.", "base.",     "navigation.",
                                "phase.",        "imu.",       "surface.",  "triangles.",
                                "rtklib.",       "forward.",   "backward.", "receipt.",
                                "receipt_stamp."};
    return std::ranges::any_of(begins, [&](const char* part) {
        return name.starts_with(part) && name.size() > std::string_view(part).size();
    });
}

std::vector<SignatureFile> signature_files(const fs::path& run_dir) {
    std::vector<SignatureFile> files;
    for (const auto& entry : fs::directory_iterator(run_dir)) {
        const std::string name = entry.path().filename().string();
        if (!is_signature_name(name) || !fs::is_regular_file(entry.symlink_status())) continue;
        files.push_back(
            {.name = name,
             .kind = name.ends_with(minisign_end) ? SignatureKind::minisign : SignatureKind::ssh,
             .text = read_handwritten(entry.path())});
    }
    const auto order = [](const SignatureFile& file) {
        return std::pair(file.name != "report.json.minisig", std::string_view(file.name));
    };
    std::ranges::sort(files, {}, order);
    return files;
}

void keep_superseded(const fs::path& run_dir, const std::string& name) {
    const Folder run(run_dir);
    if (is_file(run, name)) supersede(run, name, run);
}

void keep_sealed_page(const fs::path& run_dir) {
    const Folder run(run_dir);
    if (is_file(run, sealed_file) && is_sealed(run_dir / sealed_file))
        supersede(run, sealed_file, run);
}

void supersede_signatures(const fs::path& run_dir) {
    const Folder run(run_dir);
    for (const std::string& name : run.names()) {
        if (!belongs_to_signatures(name)) continue;
        if (is_file(run, name)) supersede(run, name, run);
        run.remove(name);
    }
    carry_attestations(run, run, false);
    run.remove_tree(attestations_folder);
}

void require_a_run(const Folder& run, const std::vector<std::string>& made,
                   const std::vector<std::string>& known) {
    const auto named = named_by_report(run);
    const bool is_run = !named.empty() || !known.empty();
    std::string strangers;
    for (const std::string& name : run.names()) {
        const bool of_run = is_made_anew(name) || is_product_name(name) ||
                            belongs_to_signatures(name) ||
                            std::ranges::find(made, name) != made.end();
        const bool stands = named.contains(name) || std::ranges::find(known, name) != known.end() ||
                            (is_run && (is_made_anew(name) || belongs_to_signatures(name)));
        if (of_run && !stands) strangers += (strangers.empty() ? "" : ", ") + shown(name);
    }
    if (strangers.empty()) return;
    throw Failure(run.path().string(),
                  fmt::format("the folder holds files of a run's names that no report in it names: "
                              "{}; nothing was written",
                              strangers),
                  "Give another folder for the run, or move these out of this one");
}

void carry_over(const Folder& run, const Folder& made) {
    for (const std::string_view name : run_subfolders)
        if (name != attestations_folder) carry_folder(run, made, std::string(name));
    carry_signatures(run, made);
    carry_attestations(run, made, same_in_both(run, made, std::string(signed_file)));
    if (is_file(run, sealed_file) && is_sealed(run.path() / sealed_file) &&
        !same_in_both(run, made, sealed_file))
        supersede(run, sealed_file, made);
    if (is_file(run, std::string(signed_file)) &&
        !same_in_both(run, made, std::string(signed_file)))
        (void)superseded_of(run, made);
    carry_own_files(run, made);
}

}  // namespace runcert
