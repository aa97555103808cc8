#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "files/utc_second.h"
#include "trust/report_facts.h"
#include "trust/roster.h"

// What `runcert verify` looks at, in layers. Each says yes or no and why, and rests on nothing but
// the run folder and what is given to it.

namespace runcert {

/// One thing that verification looked at, and what it found.
struct VerificationStep {
    bool passed = false;
    std::string what;                  ///< "files", "chain", "signatures"
    std::string finding;               ///< one sentence
    std::vector<std::string> details;  ///< one line for each file concerned
    bool checked =
        true;  ///< false where there was nothing to check, or no means: then not `passed`
};

/// Whether the folder's SHA256SUMS, which a bundle brings, names every file in it and in the
/// folders inside with its hash. Nothing where there is no such file.
std::optional<VerificationStep> verify_bundle(const std::filesystem::path& run_dir);

/// Whether every subject of the report is there with the bytes the report names, and nothing else
/// but its companions: pages, signatures, time stamps, run.yaml, and what a bundle adds. A symbolic
/// link is no file of a run folder, nor is what a killed program left (`.runcert-...`).
VerificationStep verify_files(const std::filesystem::path& run_dir, const ReportFacts& report);

/// Whether every stage file was made from the very files that the report names: the inputs in its
/// header against the report's subjects, and against what its stage reads.
VerificationStep verify_chain(const std::filesystem::path& run_dir, const ReportFacts& report);

/// Whether each claimed rule is the published text of its id, or openly the attempt's own, and the
/// verdict was decided by it: a rule with a body's name and other figures is none of that body's.
VerificationStep verify_rules(const std::filesystem::path& run_dir);

/// Whether report.json says what the files say that it vouches for: all the files that the attempt
/// makes and no others, the id that is made of them, the outcome, speeds, limits and requirements
/// of 6-verdict.yaml, and no fewer signatures than attempt and rules ask for. Who signs vouches for
/// it all; this finds what nobody need vouch for.
VerificationStep verify_report(const std::filesystem::path& run_dir, const ReportFacts& report);

/// Whether attempt, rules, stage files and report follow schemas that this program knows, in every
/// field and row, and none says that it is of an earlier version than the program that made it
/// wrote.
VerificationStep verify_schemas(const std::filesystem::path& run_dir, const ReportFacts& report);

/// Clocks of signers, authorities and of who verifies may differ by that much.
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
    std::string role{};           ///< "" where the signature states none
    std::string key{};            ///< one line: base64 as `minisign -P` takes it, or "TYPE BASE64"
    std::string who{};            ///< as the roster calls the key's holder
    bool not_recomputed = false;  ///< its signer says that nothing was computed again before
    std::string stated_time{};    ///< when the signer says it was made; nobody else vouches for it
    std::string time{};           ///< the time that the key's validity is judged by
    std::string time_source{};    ///< "time stamp", "present" or "given"
    bool valid = false;           ///< it holds, and counts
    bool broken = false;   ///< it is not a signature of this report: tampered with, or replayed
    std::string reason{};  ///< why it does not count
    /// What a reader should know of it beside: a weak key, a time before the recording ended.
    std::vector<std::string> notes{};
};

struct SignatureLayers {
    VerificationStep time_stamps;
    VerificationStep signatures;
    std::vector<Signer> signers{};
};

/// Judges every signature and time stamp of the folder, and whether they are all that the report
/// needs: by the rules and the attempt, as it states, and by the roster; of each role the most that
/// one of them asks for. Yes where each role has its signatures by different keys (a key counts for
/// one role) and no signature is broken; one that merely does not count is said.
SignatureLayers verify_signatures(const std::filesystem::path& run_dir, const ReportFacts& report,
                                  const SignatureRules& rules);

/// Whether report.html and report.pdf, where they are there, are what this report.json, the
/// signatures that the page names and all attestations render to. They are rendered again, which
/// takes a second or two; those of another program, by another roster than the one given, and where
/// they cannot be rendered, are not passed.
VerificationStep verify_pages(const std::filesystem::path& run_dir, const ReportFacts& report,
                              const SignatureRules& rules);

}  // namespace runcert
