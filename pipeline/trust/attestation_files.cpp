#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"
#include "trust/attestation.h"
#include "trust/signature_files.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view envelope_begin = "answer-";
constexpr std::string_view envelope_end = ".json";
constexpr std::size_t id_digits = 16;

bool is_envelope_name(std::string_view name) {
    return name.size() == envelope_begin.size() + id_digits + envelope_end.size() &&
           name.starts_with(envelope_begin) && name.ends_with(envelope_end);
}

std::string in_folder(const std::string& name) {
    return fmt::format("{}/{}", attestations_folder, name);
}

/// What an envelope names as evidence; nothing where it cannot be read, which others report.
std::vector<EvidenceFile> evidence_of(const EnvelopeFile& file) {
    try {
        const Attestation read =
            read_statement(read_envelope(file.text, file.name).payload, file.name);
        std::vector<EvidenceFile> evidence = read.evidence;
        if (read.on_paper) evidence.push_back(*read.on_paper);
        return evidence;
    } catch (const Failure&) {
        return {};
    }
}

/// The name of a signature in a run where another may have its own: "report.json.judge-2.minisig".
std::string free_signature_name(const fs::path& run_dir, const SignatureFile& signature) {
    const std::size_t end = signature.name.rfind('.');
    std::string name = signature.name;
    for (int number = 2; fs::exists(run_dir / name) && read_file(run_dir / name) != signature.text;
         ++number)
        name = fmt::format("{}{}{}{}", signature.name.substr(0, end),
                           signature.name == "report.json.minisig" ? "." : "-", number,
                           signature.name.substr(end));
    return name;
}

}  // namespace

std::string envelope_name(std::string_view id) {
    return fmt::format("{}{}{}", envelope_begin, id.substr(0, id_digits), envelope_end);
}

std::string evidence_name(const EvidenceFile& file) {
    return fmt::format("evidence-{}-{}", file.sha256.substr(0, id_digits), file.name);
}

std::vector<EnvelopeFile> envelope_files(const fs::path& run_dir) {
    std::vector<EnvelopeFile> files;
    const Folder run(run_dir);
    if (run.kind_of(attestations_folder) != EntryKind::folder) return files;
    const Folder folder = run.open(attestations_folder);
    for (const std::string& name : folder.names())
        if (is_envelope_name(name) && folder.kind_of(name) == EntryKind::file)
            files.push_back({.name = name, .text = read_handwritten(folder.path() / name)});
    return files;
}

std::set<std::string> attestation_names(const fs::path& run_dir) {
    std::set<std::string> names;
    for (const EnvelopeFile& file : envelope_files(run_dir)) {
        names.insert(in_folder(file.name));
        for (const EvidenceFile& evidence : evidence_of(file))
            names.insert(in_folder(evidence_name(evidence)));
    }
    return names;
}

std::string write_attestation(const fs::path& run_dir, const Attestation& attestation,
                              const std::vector<std::string>& evidence, const SecretKey& key) {
    const std::string payload = statement_text(attestation);
    std::vector<EvidenceFile> named = attestation.evidence;
    if (attestation.on_paper) named.push_back(*attestation.on_paper);
    const Folder folder = Folder(run_dir).make(attestations_folder);
    const std::string name = envelope_name(attestation_id(payload));
    std::vector<std::string> fresh;
    try {
        for (std::size_t i = 0; i < named.size(); ++i) {
            if (folder.kind_of(evidence_name(named[i])) == EntryKind::none)
                fresh.push_back(evidence_name(named[i]));
            folder.write(evidence_name(named[i]), evidence.at(i));
        }
        folder.write(name, sign_envelope(payload, key));
    } catch (const std::exception&) {
        // Evidence that no envelope names would stand in the way of the next answer.
        if (folder.kind_of(name) == EntryKind::none)
            for (const std::string& each : fresh)
                ::unlinkat(folder.number(), each.c_str(), 0);
        throw;
    }
    return in_folder(name);
}

std::vector<std::string> take_answers(const fs::path& run_dir, const fs::path& copy) {
    if (read_file(copy / "report.json") != read_file(run_dir / "report.json"))
        throw Failure(copy.string(),
                      "this is a run of another report, whose answers are not of this one",
                      "Ask for answers to this report, or take them into the run that they are of");
    // The name there, and its bytes.
    std::vector<std::pair<std::string, std::string>> brought;
    const auto bring = [&](const std::string& name, std::string text) {
        if (!fs::exists(run_dir / name))
            brought.emplace_back(name, std::move(text));
        else if (read_file(run_dir / name) != text)
            throw Failure((copy / name).string(),
                          "a file of that name with other bytes is in the run",
                          "Find out which of them is right, and move the other away");
    };
    for (const std::string& name : attestation_names(copy))
        bring(name, read_file(copy / name));
    for (const SignatureFile& signature : signature_files(copy)) {
        const std::string name = free_signature_name(run_dir, signature);
        bring(name, signature.text);
        for (const auto& name_of : {time_stamp_name, time_stamp_query_name})
            if (const fs::path stamp = copy / name_of(signature.name);
                fs::is_regular_file(fs::symlink_status(stamp)))
                bring(name_of(name), read_file(stamp));
    }
    std::vector<std::string> written;
    for (const auto& [name, text] : brought) {
        fs::create_directories((run_dir / name).parent_path());
        write_file_atomically(run_dir / name, text);
        written.push_back(name);
    }
    return written;
}

void carry_attestations(const Folder& run, const Folder& made, bool report_unchanged) {
    if (run.kind_of(attestations_folder) != EntryKind::folder) return;
    const Folder from = run.open(attestations_folder);
    for (const std::string& name : from.names()) {
        const EntryKind kind = from.kind_of(name);
        if (kind == EntryKind::folder)
            throw Failure((from.path() / name).string(),
                          "a folder among the attestations of this run is none of its own",
                          "Move it elsewhere, and certify again");
        if (!report_unchanged && kind == EntryKind::file) {
            keep_copy(from, name, superseded_of(run, made).make(attestations_folder));
            continue;
        }
        const Folder to = made.make(report_unchanged ? attestations_folder : superseded_folder);
        if (to.kind_of(name) == EntryKind::none) from.place(name, to);
    }
}

}  // namespace runcert
