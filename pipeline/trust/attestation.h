#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "store/folder.h"
#include "trust/signature.h"

// What an official signs for: answers to requirements of a report, that it was recomputed, or which
// answers and signatures there are (a closing statement). It is an in-toto statement
// (https://in-toto.io/Statement/v1) whose subject is report.json, signed in a DSSE envelope
// (https://github.com/secure-systems-lab/dsse/blob/master/protocol.md).

namespace runcert {

/// The type of an in-toto statement, as an attestation and a report are.
inline constexpr std::string_view statement_type = "https://in-toto.io/Statement/v1";

/// The type of the payload of every envelope here.
inline constexpr std::string_view statement_payload_type = "application/vnd.in-toto+json";

/// The bytes that an envelope's signature is of (PAE): "DSSEv1 LEN(type) type LEN(payload)
/// payload", lengths in bytes.
std::string dsse_bytes(std::string_view payload_type, std::string_view payload);

/// An envelope taken apart. Nothing of it is checked.
struct Envelope {
    std::string payload{};
    std::array<unsigned char, 64> signature{};  ///< Ed25519
    std::string key_id{};                       ///< a claim
};

/// The text of the envelope of a statement, signed: one line of JSON.
std::string sign_envelope(std::string_view payload, const SecretKey& key);

/// Reads an envelope. Failure where it is anything but what sign_envelope writes for its payload,
/// signature and key id, byte for byte: no change of it goes unseen.
Envelope read_envelope(std::string_view text, const std::string& where);

/// Whether the key signed the payload, as a statement.
bool envelope_holds(const Envelope& envelope, const PublicKey& key);

/// "withdrawn" takes back the signer's earlier answers to the clause, in the envelopes that lay
/// there.
inline constexpr std::string_view answer_yes = "yes";
inline constexpr std::string_view answer_no = "no";
inline constexpr std::string_view answer_withdrawn = "withdrawn";

struct Answer {
    std::string profile{};  ///< the rule
    std::string clause{};
    std::string text{};   ///< of the clause, as it was shown to whoever answers
    std::string shown{};  ///< its figures, as they were shown
    std::string answer{};

    bool operator==(const Answer&) const = default;
};

/// A file that lies beside the envelope.
struct EvidenceFile {
    std::string name{};    ///< as its owner called it
    std::string sha256{};  ///< 64 lower-case hexadecimal digits

    bool operator==(const EvidenceFile&) const = default;
};

struct Attestation {
    std::string report_sha256{};  ///< of the bytes of report.json
    std::string role{};
    std::string key{};   ///< the signer's, as `minisign -P` takes it
    std::string time{};  ///< by the signer's clock, "2026-11-21T20:41:50Z"
    std::string report_id{};
    std::string attempt_id{};
    std::vector<Answer> answers{};  ///< none of the other two kinds
    std::string statement{};        ///< in the signer's words; may be empty
    std::vector<EvidenceFile> evidence{};
    std::optional<EvidenceFile>
        on_paper{};                     ///< the sheet that was signed by hand, and is answered for
    std::vector<EvidenceFile> after{};  ///< envelopes that lay there: signers' keys, and ids
    std::vector<EvidenceFile> policies{};  ///< of "recomputed and agreed" alone: the rules
    std::vector<EvidenceFile> closes{};    ///< of a closing statement alone: all files that count

    bool is_closing() const { return !closes.empty(); }
    bool is_recomputed() const { return answers.empty() && !is_closing(); }
    bool operator==(const Attestation&) const = default;
};

/// The payload: JSON, the same bytes for the same attestation.
std::string statement_text(const Attestation& attestation);

/// Reads a payload. Failure where it is anything but what statement_text writes, byte for byte: so
/// it holds nothing that is not read, and an answer is one of the three.
Attestation read_statement(std::string_view payload, const std::string& where);

/// The id of a statement: the SHA-256 of its payload. That of the envelope would not do, since
/// anyone can wrap the same signed payload in other bytes.
std::string attestation_id(std::string_view payload);

/// The folder of a run's attestations: envelopes, each named after its statement, and the files
/// that they name as evidence.
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

/// All envelopes of a run, by name; none without the folder. Failure where one is far too long.
std::vector<EnvelopeFile> envelope_files(const std::filesystem::path& run_dir);

/// The files in the folder that belong there, from the run folder on: envelopes, and the evidence
/// that one of them names.
std::set<std::string> attestation_names(const std::filesystem::path& run_dir);

/// Signs an attestation and writes it with its evidence, whose bytes are given in the order in
/// which it names them, the sheet last. Returns the name of the envelope, from the run folder on.
/// The caller holds the run's lock. A kill leaves evidence that no envelope names, or everything.
std::string write_attestation(const std::filesystem::path& run_dir, const Attestation& attestation,
                              const std::vector<std::string>& evidence, const SecretKey& key);

/// Brings answers, with their evidence, signatures and time stamps that another copy of the same
/// run has into this one, and gives the names of what was not there. Failure, with nothing brought,
/// where that copy is of another report, or a file of one name has other bytes there. The caller
/// holds the run's lock, and judges what was brought.
std::vector<std::string> take_answers(const std::filesystem::path& run_dir,
                                      const std::filesystem::path& copy);

/// Brings the attestations of a run into the one that takes its place: into its attestations where
/// the report is the same, else into its superseded/.
void carry_attestations(const Folder& run, const Folder& made, bool report_unchanged);

}  // namespace runcert
