#include "trust/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "run/attempt_files.h"
#include "run/stage_run.h"
#include "run/steps.h"
#include "schemas/common/product_files.h"
#include "schemas/products/products.h"
#include "store/atomic_file.h"
#include "store/program.h"
#include "store/sha256.h"
#include "trust/attestation.h"
#include "trust/bundle.h"
#include "trust/signature_files.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

bool is_known_companion(const fs::directory_entry& entry) {
    const std::string name = entry.path().filename().string();
    const fs::file_status status = entry.symlink_status();
    // Keys are those of a bundle, whose SHA256SUMS names each.
    if (name == bundle_keys_folder)
        return fs::is_directory(status) && fs::exists(entry.path().parent_path() / "SHA256SUMS");
    if (name == superseded_folder || name == attestations_folder) return fs::is_directory(status);
    if (!fs::is_regular_file(status)) return false;
    for (const char* known : {"report.json", "run.yaml", "SHA256SUMS", "VERIFY.txt"})
        if (name == known) return true;
    return is_page_name(name) || belongs_to_signatures(name);
}

std::optional<std::string> fault_of_subject(const fs::path& file, const std::string& sha256) {
    const fs::file_status status = fs::symlink_status(file);
    if (!fs::exists(status)) return "missing";
    if (fs::is_symlink(status))
        return "a symbolic link, which may lead elsewhere tomorrow: put the file itself here";
    if (!fs::is_regular_file(status)) return "not a file";
    if (digest_file(file).sha256 != sha256)
        return "changed, its bytes are not those the report names";
    return std::nullopt;
}

/// What does not belong into the folder of keys that a bundle brings.
std::vector<std::string> extra_keys(const fs::path& keys) {
    std::vector<std::string> extras;
    if (!fs::is_directory(fs::symlink_status(keys))) return extras;
    for (const auto& entry : fs::directory_iterator(keys)) {
        const std::string name =
            std::string(bundle_keys_folder) + "/" + entry.path().filename().string();
        const bool known =
            name == bundle_roster_file || name == bundle_tsa_file || name.ends_with(".pub");
        if (!known || !fs::is_regular_file(entry.symlink_status()))
            extras.push_back(shown(name) +
                             ": neither a public key, a roster nor a certificate of "
                             "an authority: move it away");
    }
    return extras;
}

/// What does not belong among the attestations.
std::vector<std::string> extra_attestations(const fs::path& run_dir) {
    std::vector<std::string> extras;
    if (!fs::is_directory(fs::symlink_status(run_dir / attestations_folder))) return extras;
    const std::set<std::string> known = attestation_names(run_dir);
    for (const auto& entry : fs::directory_iterator(run_dir / attestations_folder)) {
        const std::string name =
            fmt::format("{}/{}", attestations_folder, entry.path().filename().string());
        if (!known.contains(name) || !fs::is_regular_file(entry.symlink_status()))
            extras.push_back(shown(name) +
                             ": neither an attestation nor evidence that one names: move it away");
    }
    return extras;
}

/// What does not belong into a run folder, in words; by name, so that the order is always the same.
std::vector<std::string> extra_files(const fs::path& run_dir, const ReportFacts& report) {
    std::vector<std::string> extras = extra_keys(run_dir / bundle_keys_folder);
    const std::vector<std::string> among_attestations = extra_attestations(run_dir);
    extras.insert(extras.end(), among_attestations.begin(), among_attestations.end());
    for (const auto& entry : fs::directory_iterator(run_dir)) {
        const std::string name = entry.path().filename().string();
        if (report.subjects.contains(name) || is_known_companion(entry)) continue;
        const bool link = fs::is_symlink(entry.symlink_status());
        extras.push_back(
            shown(name) +
            (name.starts_with(program_leftover)
                 ? ": left by a program that was killed, or put here by somebody: give the "
                   "command again, which clears away what is yours, or move it away"
             : link ? ": a symbolic link, not part of the report: remove it"
                    : ": not part of the report: move it away"));
    }
    std::ranges::sort(extras);
    return extras;
}

/// The hashes of the predicate's own list of files, which is what the pages show.
void compare_shown_files(const ReportFacts& report, VerificationStep& step) {
    const auto& predicate = report.json->at("predicate");
    if (predicate.at("files").size() != report.subjects.size())
        step.fail(fmt::format("report.json: shows {} files, it is signed for {}",
                              predicate.at("files").size(), report.subjects.size()));
    for (const auto& file : predicate.at("files")) {
        const std::string name = file.value("file", "");
        const auto subject = report.subjects.find(name);
        if (subject == report.subjects.end() || subject->second != file.value("sha256", ""))
            step.fail(
                fmt::format("report.json: shows another {} than it is signed for", shown(name)));
    }
}

/// What stage files do not name of what their stages read, so that nothing ties them to it.
std::vector<std::string> missing_inputs(
    const fs::path& run_dir, const std::map<std::string, std::set<std::string>>& inputs_of,
    const std::map<std::string, nlohmann::ordered_json>& parameters_of) {
    const fs::path file = run_dir / attempt_copy_name;
    const Attempt attempt = read_attempt(read_handwritten(file), file.string());
    std::vector<std::string> missing;
    for (const Receiver& receiver : attempt.receivers) {
        const std::string name = product_file(attempt, receiver, products::observations);
        const auto read = parameters_of.find(name);
        if (read != parameters_of.end() &&
            read->second != *reading_of(attempt.written(receiver.id)))
            missing.push_back(
                fmt::format("{}: the recording was not read as attempt.yaml has it", name));
    }
    for (const auto& [name, needed] : inventory_of(attempt).made_from) {
        const auto stated = inputs_of.find(name);
        for (const std::string& input : needed)
            if (stated == inputs_of.end() || !stated->second.contains(input))
                missing.push_back(
                    fmt::format("{}: does not say from which {} it was made", name, input));
    }
    return missing;
}

}  // namespace

void VerificationStep::fail(std::string detail) {
    answer = LayerAnswer::not_verified;
    details.push_back(std::move(detail));
}

void VerificationStep::leave(std::string detail) {
    if (!is(LayerAnswer::not_verified)) answer = LayerAnswer::not_checkable;
    details.push_back(std::move(detail));
}

bool is_made_here(const ReportFacts& report) {
    return report.program_version == program_version() &&
           report.source_revision == source_revision();
}

void VerificationStep::fail(const Failure& failure) {
    fail(fmt::format("{}: {}", shown(fs::path(failure.where()).filename().string()),
                     failure.problem()));
}

std::string made_by_another(const ReportFacts& report) {
    return fmt::format("made by runcert {}, source {}, and this is {}, {}",
                       escape_for_message(report.program_version),
                       escape_for_message(report.source_revision), program_version(),
                       source_revision());
}

VerificationStep verify_files(const fs::path& run_dir, const ReportFacts& report) {
    VerificationStep step{.what = "files", .answer = LayerAnswer::verified};
    for (const auto& [name, sha256] : report.subjects)
        if (const auto fault = fault_of_subject(run_dir / name, sha256))
            step.fail(shown(name) + ": " + *fault);
    const bool whole = step.is(LayerAnswer::verified);
    for (std::string& extra : extra_files(run_dir, report))
        step.fail(std::move(extra));
    step.finding =
        step.is(LayerAnswer::verified)
            ? fmt::format("all {} files are those the report names", report.subjects.size())
        : whole ? "there are files that are not part of the report"
                : "not all files are those the report names";
    return step;
}

VerificationStep verify_chain(const fs::path& run_dir, const ReportFacts& report) {
    VerificationStep step{.what = "chain", .answer = LayerAnswer::verified};
    std::map<std::string, std::set<std::string>> inputs_of;
    std::map<std::string, nlohmann::ordered_json> parameters_of;
    for (const auto& [name, sha256] : report.subjects) {
        const fs::path file = run_dir / name;
        // verify_files reports those that are not there.
        if (!is_product_name(name) || !fs::is_regular_file(fs::symlink_status(file))) continue;
        try {
            const Header header = read_product_header(FileView(file).bytes(), name, file.string());
            parameters_of[name] = header.parameters;
            for (const CalledProgram& program : header.programs)
                if (!program.isolation.empty())
                    step.details.push_back(fmt::format(
                        "note: {}: {} ran without a sandbox where this was made ({})", shown(name),
                        escape_for_message(program.name), program.isolation));
            for (const InputFile& input : header.inputs) {
                inputs_of[name].insert(input.file);
                const auto subject = report.subjects.find(input.file);
                if (subject == report.subjects.end())
                    step.fail(fmt::format("{}: made from {}, which the report does not name",
                                          shown(name), shown(input.file)));
                else if (subject->second != input.sha256)
                    step.fail(fmt::format("{}: made from another {} than the report names",
                                          shown(name), shown(input.file)));
            }
        } catch (const Failure& failure) {
            step.fail(fmt::format("{}: cannot be read: {}", shown(name), failure.problem()));
        }
    }
    try {
        for (std::string& detail : missing_inputs(run_dir, inputs_of, parameters_of))
            step.fail(std::move(detail));
    } catch (const Failure& failure) {
        step.fail(fmt::format("attempt.yaml: cannot be read: {}", failure.problem()));
    }
    try {
        compare_shown_files(report, step);
    } catch (const nlohmann::json::exception&) {
        step.fail("report.json: its list of files cannot be read");
    }
    step.finding =
        step.is(LayerAnswer::verified)
            ? fmt::format("each of {} stage files was made from the files named", inputs_of.size())
            : "the stage files do not belong together";
    return step;
}

}  // namespace runcert
