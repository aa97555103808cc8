#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "files/folder.h"
#include "trust/attestation.h"
#include "trust/signature.h"

/// Where a run's attestations lie: a folder of envelopes, each named after its statement, and of
/// the files that they name as evidence.
namespace runcert {

inline constexpr const char* attestations_folder = "attestations";

/// "answer-0123456789abcdef.json", by the id of the statement in it.
std::string envelope_name(std::string_view id);

/// "evidence-0123456789abcdef-NAME", by hash and name.
std::string evidence_name(const EvidenceFile& file);

/// An envelope as it lies there.
struct EnvelopeFile {
    std::string name{};  ///< in the folder
    std::string text{};
};

/// The id of the statement in it. Failure where it is no envelope.
std::string envelope_id(const EnvelopeFile& file);

/// All of a run, by name; none where there is no folder. Failure where there are more than can be
/// looked at, and where one is longer than any.
std::vector<EnvelopeFile> envelope_files(const std::filesystem::path& run_dir);

/// The files in the folder that belong there, from the run folder on: envelopes, and the evidence
/// that one of them names.
std::set<std::string> attestation_names(const std::filesystem::path& run_dir);

/// Signs an attestation and writes it with its evidence, whose files are given in the order in
/// which it names them, the sheet last. The name of the envelope, from the run folder on. For who
/// holds the run's lock. A kill leaves evidence that no envelope names, or all of it.
std::string write_attestation(const std::filesystem::path& run_dir, const Attestation& attestation,
                              const std::vector<std::string>& evidence, const SecretKey& key);

/// Brings the attestations of a run into the one that takes its place: they stand where its report
/// is the same, else they go to its superseded/.
void carry_attestations(const Folder& run, const Folder& made, bool report_unchanged);

}  // namespace runcert
