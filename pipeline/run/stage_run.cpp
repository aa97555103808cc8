#include "run/stage_run.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "run/attempt_files.h"
#include "run/reported_files.h"
#include "run/steps.h"
#include "store/atomic_file.h"
#include "store/program.h"
#include "store/sha256.h"

namespace runcert {
namespace {

InputFile input_file(const std::string& role, const std::string& file, const FileDigest& digest,
                     const std::string& original) {
    return {.role = role,
            .file = file,
            .sha256 = digest.sha256,
            .bytes = static_cast<std::int64_t>(digest.bytes),
            .original = original == file ? "" : original};
}

/// What a stage read of the attempt beside its own parameters.
OpaqueJson beside_parameters(nlohmann::ordered_json read, const std::string& stage) {
    if (const auto parameters = read.find("parameters"); parameters != read.end()) {
        parameters->erase(stage);
        if (parameters->empty()) read.erase("parameters");
    }
    return read;
}

}  // namespace

StageRun::StageRun(std::string stage, const std::filesystem::path& attempt_file,
                   std::filesystem::path run_dir)
    : stage_(std::move(stage)),
      attempt_path_(attempt_file),
      run_dir_(std::move(run_dir)),
      attempt_text_(read_handwritten(attempt_file)),
      attempt_(read_attempt(attempt_text_, attempt_file.string())) {
    make_directory(run_dir_);
    parameters_ = parameters_of(attempt_, stage_);
    if (!reads_part(stage_)) return;
    StagePart part = part_of_stage(attempt_, stage_);
    read_ = beside_parameters(*part.settings, stage_);
    attempt_ = std::move(part.attempt);
}

std::vector<Profile> StageRun::read_profiles() {
    std::vector<Profile> profiles;
    std::vector<YamlValue> texts;
    for (const std::string& claimed : attempt_.profiles) {
        profiles.push_back(read_claimed_profile(run_dir_, claimed, attempt_));
        texts.push_back(profiles.back().written);
    }
    read_["profiles"] = profiles_of_stage(texts, stage_);
    return with_evidence(std::move(profiles), (run_dir_ / attempt_copy_name).string());
}

void StageRun::note(const InputFile& input) {
    check_expected(input.file, input.sha256);
    for (const InputFile& known : inputs_)
        if (known.file == input.file) return;
    inputs_.push_back(input);
}

void StageRun::note_attempt() {
    note_input("attempt", std::string(attempt_copy_name), attempt_text_);
}

void StageRun::note_input(const std::string& role, const std::string& file, std::string_view bytes,
                          const std::string& original) {
    note(input_file(role, file, digest_of(bytes), original));
}

void StageRun::note_input(const std::string& role, const std::string& file, const FileView& view,
                          const std::string& original) {
    note(input_file(role, file, digest_of(view), original));
}

FileView StageRun::view_file(const std::string& role, const std::string& file) {
    FileView view(run_dir_ / file);
    note_input(role, file, view);
    return view;
}

void StageRun::note_file(const std::string& role, const std::string& file,
                         const std::string& original) {
    note(input_file(role, file, digest_file(run_dir_ / file), original));
}

std::string StageRun::read_text(const std::string& role, const std::string& file) {
    std::string text = read_file(run_dir_ / file);
    note_input(role, file, text);
    return text;
}

void StageRun::check_expected(const std::string& file, const std::string& sha256) const {
    const auto known_hash = expected_.find(file);
    if (known_hash == expected_.end() || known_hash->second.sha256 == sha256) return;
    throw Failure((run_dir_ / file).string(),
                  fmt::format("the file is not the one that {} was made from: its SHA-256 is {}, "
                              "expected {}",
                              known_hash->second.stated_in, sha256, known_hash->second.sha256),
                  "Run the stages again from the first that changed, or `runcert certify`");
}

void StageRun::note_expected(const std::string& file, const Header& header) {
    for (const InputFile& input : header.inputs) {
        expected_[input.file] = {input.sha256, file};
        for (const InputFile& known : inputs_)
            if (known.file == input.file) check_expected(known.file, known.sha256);
    }
}

std::string StageRun::file_of(const ProductFile& product, const Receiver& receiver) const {
    return product_file(attempt_, receiver, product);
}

Header StageRun::header() const {
    Header header;
    header.stage = stage_;
    header.program_version = program_version();
    header.source_revision = source_revision();
    header.inputs = inputs_;
    header.parameters = parameters_;
    header.attempt = read_;
    return header;
}

void StageRun::write(const std::string& file, std::string_view text) const {
    write_file_atomically(run_dir_ / file, text);
}

void StageRun::write(const std::string& file, const FileView& view) const {
    AtomicFile copy(run_dir_ / file);
    view.for_each_piece([&copy](std::string_view piece) { copy.write(piece); });
    copy.commit();
}

StageRun open_run(const std::string& program, const std::filesystem::path& run_dir) {
    if (!std::filesystem::is_directory(run_dir))
        throw Failure(run_dir.string(), "there is no such run folder",
                      "Name a folder that `runcert certify` wrote");
    StageRun run(program, run_dir / attempt_copy_name, run_dir);
    const std::filesystem::path report = run_dir / "report.json";
    if (std::filesystem::exists(report))
        run.note_expected("report.json", reported_files(read_file(report), report.string()));
    return run;
}

const Receiver& receiver_of(const Attempt& attempt, const std::string& id) {
    if (id.empty()) return attempt.receivers.front();
    std::string known;
    for (const Receiver& receiver : attempt.receivers) {
        if (receiver.id == id) return receiver;
        known += (known.empty() ? "" : ", ") + receiver.id;
    }
    throw Failure("--receiver",
                  fmt::format("the attempt has no receiver \"{}\"", escape_for_message(id)),
                  "Choose one of: " + known);
}

}  // namespace runcert
