#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/failure.h"
#include "store/utc_second.h"
#include "trust/roster.h"
#include "trust/signature_files.h"

// What `runcert verify` looks at, in layers. Each has one of three answers and says why; it rests
// on nothing but the run folder, what is given to it, and what its answer says is missing here.

namespace runcert {

struct Verdict;

/// Signatures that a report needs: that many in the role, by different keys.
struct RequiredSignatures {
    std::string role{};
    std::size_t count = 1;
};

/// What is read of a run folder's report.json to check or sign it.
struct ReportFacts {
    std::string text{};                            ///< its bytes: what is signed
    std::shared_ptr<const nlohmann::json> json{};  ///< the same, read
    std::shared_ptr<const Verdict> verdict{};      ///< what it says of each rule; no header
    std::string report_id{};
    std::string attempt_id{};
    std::string program_version{};
    std::string source_revision{};
    std::string program_home{};  ///< where that is to be had, as it says; may be empty
    std::string arithmetic{};    ///< of the computer that made it, see store/program.h
    std::map<std::string, std::string> subjects{};  ///< file name to SHA-256
    std::vector<std::string> subject_names{};       ///< in the report's own order
    std::vector<RequiredSignatures> required{};     ///< empty: one signature, in any role
    std::optional<UtcSecond> recorded_until{};      ///< the last epoch, by the report
};

/// Reads RUN_DIR/report.json. Failure where it is missing, longer than any report, not JSON, holds
/// a key twice or begins with a byte order mark (programs differ in how they read these), names a
/// file that not every system can have in a run folder, is no measurement report, or follows
/// another version of the report's schema: what it asks for is unknown.
ReportFacts read_report_facts(const std::filesystem::path& run_dir);

struct RunStanding;

enum class LayerAnswer {
    verified,
    not_verified,
    not_checkable,  ///< here: a program is missing, or is another one than made it
};

/// One thing that verification looked at, and what it found.
struct VerificationStep {
    std::string what = {};                  ///< "files", "chain", "signatures"
    std::optional<LayerAnswer> answer{};    ///< none where there is nothing to check
    std::string finding = {};               ///< one sentence
    std::vector<std::string> details = {};  ///< one line for each file concerned

    bool is(LayerAnswer one) const { return answer == one; }
    /// Adds what is wrong; the step is not verified, whatever else is found.
    void fail(std::string detail);
    /// The same of a file that cannot be read, in the words of the failure.
    void fail(const Failure& failure);
    /// Adds what cannot be checked here, and why; what is wrong counts more.
    void leave(std::string detail);
};

/// Whether this very program made the report, as that says; and which made it otherwise, in words.
bool is_made_here(const ReportFacts& report);
std::string made_by_another(const ReportFacts& report);

/// Whether the SHA256SUMS that a bundle brings names every file in the folder, at any depth, with
/// its hash. Nothing where there is no such file, unless the folder is that of a bundle, which must
/// have one.
std::optional<VerificationStep> verify_bundle(const std::filesystem::path& run_dir, bool is_bundle);

/// Whether every subject of the report is there with the bytes the report names, and nothing else
/// but its companions: pages, signatures, time stamps, run.yaml, and what a bundle adds. Symbolic
/// links and what a killed program left (`.runcert-...`) do not belong in a run folder.
VerificationStep verify_files(const std::filesystem::path& run_dir, const ReportFacts& report);

/// Whether every stage file was made from the very files that the report names: the inputs in its
/// header against the report's subjects, and against what its stage reads.
VerificationStep verify_chain(const std::filesystem::path& run_dir, const ReportFacts& report);

/// Whether each claimed rule is the published text of its id, or openly the attempt's own, and the
/// verdict was decided by it: a rule with a body's name and other figures is none of that body's.
VerificationStep verify_rules(const std::filesystem::path& run_dir);

/// Whether report.json says what the files say that it vouches for: all the files that the attempt
/// makes and no others, the id that is made of them, the outcome, speeds, limits and requirements
/// of 6-verdict.yaml, and no fewer signatures than attempt and rules ask for. Whoever signs vouches
/// for all of this; what can be checked is checked here.
VerificationStep verify_report(const std::filesystem::path& run_dir, const ReportFacts& report);

/// Failure, naming the file, where something in a run folder is of another version than this
/// program reads: a product, the attempt, a rule or the report.
void require_known_versions(const std::filesystem::path& run_dir);

/// Whether attempt, rules, stage files and report follow schemas that this program knows, in every
/// field and row.
VerificationStep verify_schemas(const std::filesystem::path& run_dir, const ReportFacts& report);

/// How much the clocks of signers, authorities and verifiers may differ.
inline constexpr std::chrono::minutes clock_tolerance{5};

/// What signatures are judged by.
struct SignatureRules {
    /// Keys and their roles; nothing where no key is known, so that no signature can count.
    std::optional<Roster> roster{};
    bool by_public_keys = false;  ///< the roster was made of public keys given, not of a file: it
                                  ///< vouches for nobody
    bool roster_of_run = false;   ///< it lies in the run itself, and is the sender's word
    UtcSecond present{};          ///< the clock: nothing was signed after it
    UtcSecond at{};               ///< the time that counts where no time stamp does
    bool at_was_given = false;    ///< by --at; else it is the present
    std::vector<std::filesystem::path> time_stamp_cas{};

    /// Whether somebody vouches for keys and roles: the reader, by a roster of the reader's own.
    bool vouches() const { return roster && !by_public_keys && !roster_of_run; }
};

/// One signature file, as judged.
struct Signer {
    std::string file{};
    std::string sha256{};         ///< of the signature file
    std::string role{};           ///< "" where the signature states none
    std::string key{};            ///< one line: base64 as `minisign -P` takes it, or "TYPE BASE64"
    std::string who{};            ///< as the roster calls the key's holder
    bool not_recomputed = false;  ///< its signer says that nothing was computed again before
    std::string stated_time{};    ///< when the signer says it was made
    std::string time{};           ///< the time that the key's validity is judged by
    std::string time_source{};    ///< "time stamp", "present" or "given"
    bool known = false;           ///< the roster, if there is one, has its key, in whatever role
    bool valid = false;           ///< it holds, and counts
    bool broken = false;   ///< it is not a signature of this report: tampered with, or replayed
    std::string reason{};  ///< why it does not count
    /// What else a reader should know: a weak key, a time before the recording ended.
    std::vector<std::string> notes{};
};

struct SignatureLayers {
    VerificationStep time_stamps;
    VerificationStep signatures;
    std::vector<Signer> signers{};
};

/// "TYPE BASE64" of its key, in whichever form the signature is.
std::string key_identity(const Signer& signer);

/// Judges every signature and time stamp of the folder, and whether there are all that the report
/// states it needs by rules and attempt, and all that the roster asks for (for each role, the
/// larger number). Passed where each role has its signatures by different keys (a key counts for
/// one role) and no signature is broken; one that merely does not count is mentioned.
SignatureLayers verify_signatures(const std::filesystem::path& run_dir, const ReportFacts& report,
                                  const SignatureRules& rules);

/// Whether report.html, certificate.pdf and report.pdf, if there, are what this report.json, the
/// signatures that the page names and all attestations render to. They are rendered again, which
/// takes a second or two. Not checkable: pages of another program, and what WeasyPrint or poppler
/// are needed for where they are missing, or are others than made it. Of such a PDF, what it
/// carries is checked, and what its first page says. Not verified where the pages go by an unknown
/// roster, and where a rule's standing is another on them than was `found` by the roster given.
VerificationStep verify_pages(const std::filesystem::path& run_dir, const ReportFacts& report,
                              const SignatureRules& rules, const RunStanding& found);

/// Copies what pages are made of into another folder: report.json, its signatures (those `shown`,
/// or all) and its attestations.
void take_report(const std::filesystem::path& run_dir, const std::filesystem::path& folder,
                 const std::optional<std::vector<std::string>>& shown = std::nullopt);

/// Which of `page_names` a run folder holds, as files and no links.
std::vector<std::string> pages_in(const std::filesystem::path& run_dir);

/// Whether a file lies in a run folder, or is the run itself, and so is the sender's word.
bool lies_in(const std::filesystem::path& file, const std::filesystem::path& run_dir);

/// Failure where the roster named lies in the run: pages go by the reader's own. Empty is none.
/// Also, for what makes or packs pages, where they go by a roster already, and this is not it.
void require_own_roster(const std::string& roster, const std::filesystem::path& run_dir,
                        bool for_pages = false);

/// A signature to be judged; `stamped` is the time of its time stamp where that holds.
struct SignatureCase {
    std::filesystem::path run_dir{};
    SignatureFile file{};
    std::optional<UtcSecond> stamped{};
};

/// Judges whether a signature is one of this report, by a key whose signature counts at its time.
/// Failure where a program that is needed is missing.
Signer judge_signature(const SignatureCase& one, const ReportFacts& report,
                       const SignatureRules& rules);

/// Judges whether a valid signature by that key counts, by the roster and the time; `stamped` is
/// the time of its time stamp, where it has one.
Signer judge_by_roster(Signer signer, const SshPublicKey& key, std::optional<UtcSecond> stamped,
                       const SignatureRules& rules);

/// A role in which the report needs signatures, and how many there are.
struct RoleState {
    std::string role{};
    std::size_t needed = 0;
    std::size_t there = 0;  ///< valid ones by different keys that do not count for another role
};

/// Gives valid signatures to the roles that need them, each key to one role, so that as many as
/// possible are filled.
std::vector<RoleState> fill_roles(const std::vector<RequiredSignatures>& required,
                                  const std::vector<Signer>& signers);

}  // namespace runcert
